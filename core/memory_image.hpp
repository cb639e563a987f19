// The bytes of one bank of axis memory: the one contract between the host that builds them and the unit that reads
// them. prefix (64) | parameters (512) | identity (64) | table directory (40 each) | thermal settings (64) and rows (40
// each) | rotary axes (400, with bending 96 more, then 24 for each value of a curve) | values (int16 each) | header
// text (UTF-8). The checksum is the CRC-32 of the whole image with its own four bytes taken as zero. A map with
// bending is of format 5, another one with rotary axes of format 4, another one with thermal rows of format 3, every
// other of format 2. Format 1, which is read but no longer written, has no identity. Settings, rows and axes that a map
// does not have take no bytes.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "core/bytes.hpp"
#include "core/parameters.hpp"
#include "core/rotary.hpp"
#include "core/thermal.hpp"

namespace ecs {

inline constexpr std::uint32_t kImageMagic = 0x45435349;  // "ECSI"
inline constexpr std::uint16_t kImageFormat = 2;
inline constexpr std::uint16_t kFormatWithoutIdentity = 1;
inline constexpr std::uint16_t kFormatWithThermal = 3;
inline constexpr std::uint16_t kFormatWithRotary = 4;
inline constexpr std::uint16_t kFormatWithBending = 5;
inline constexpr std::uint32_t kPrefixBytes = 64;
inline constexpr std::uint32_t kParameterBytes = 512;
inline constexpr std::uint32_t kIdentityBytes = 64;
inline constexpr std::uint32_t kEntryBytes = 40;
inline constexpr std::uint32_t kThermalSettingsBytes = 64;
inline constexpr std::uint32_t kThermalRowBytes = 40;
inline constexpr std::uint32_t kRotaryAxisBytes = 192;
inline constexpr std::uint32_t kRotaryBytes = 16 + kRotaryInputs * kRotaryAxisBytes;  ///< before bending
inline constexpr std::uint32_t kBendingBytes = 96;
inline constexpr std::uint32_t kRotaryValueBytes = 24;  ///< six curves, reverse and forward
inline constexpr std::uint32_t kMostTables = 36;        ///< 18 curves, forward and reverse

/// Offsets inside the prefix.
namespace prefix_at {
inline constexpr std::uint32_t magic = 0, format = 4, total_bytes = 8, check = 12, parameters = 16, directory = 20,
                               table_count = 24, values = 28, value_count = 32, header = 36, header_bytes = 40,
                               thermal = 44, thermal_count = 48, rotary = 52, rotary_count = 56;
}

/// Offsets inside the identity. Texts are UTF-8, padded with zeros.
namespace identity_at {
inline constexpr std::uint32_t serial_number = 0, machine = 16, configuration = 56;
}
inline constexpr std::size_t kMostSerialNumberBytes = identity_at::machine - identity_at::serial_number;
inline constexpr std::size_t kMostMachineBytes = identity_at::configuration - identity_at::machine;

/// Whom an image is addressed to. A unit takes no image that is addressed to another one.
struct ImageIdentity {
  std::string_view serial_number;   ///< of the unit, up to 16 bytes
  std::string_view machine;         ///< its name, up to 40 bytes; empty: not stated
  std::uint32_t configuration = 0;  ///< configuration_hash() of the machine
  friend bool operator==(const ImageIdentity&, const ImageIdentity&) = default;
};

/// CRC-32 over the parameters that say how a map is read: configuration string, axes present, convention. A map built
/// for others would act on other axes or with other signs.
[[nodiscard]] std::uint32_t configuration_hash(const UnitParameters& parameters) noexcept;

/// As much of a machine's name as an identity holds, cut between two characters.
[[nodiscard]] std::string_view machine_in_identity(std::string_view name) noexcept;

/// One error table in the directory. Values are compensation = value × resolution, um or um/m.
struct TableEntry {
  Component component = Component::EXX;   ///< one of the 18 curves
  Approach approach = Approach::unknown;  ///< unknown: for both approaches
  bool declared_zero = false;     ///< no values: the engineer declared the component zero (reason in the header)
  std::uint32_t first_value = 0;  ///< index of the first value in the value area
  std::uint32_t count = 0;        ///< 0 only if declared zero
  double start_mm = 0.0;          ///< machine coordinate of the first value
  double increment_mm = 1.0;      ///< 0.0001 … 1e6
  double resolution = 0.01;       ///< um or um/m per count, above 0, at most 1000
  friend bool operator==(const TableEntry&, const TableEntry&) = default;
};

inline constexpr double kLargestStart_mm = 1e6;
inline constexpr double kLeastIncrement_mm = 1e-4;
inline constexpr double kLargestIncrement_mm = 1e6;
inline constexpr double kLargestResolution = 1000.0;

/// What an image holds, before its bytes exist. No two tables share values: their counts sum to at most value_count.
struct ImagePlan {
  std::uint32_t table_count = 0;
  std::uint32_t value_count = 0;
  std::uint32_t header_bytes = 0;
  std::uint16_t format = kImageFormat;
  std::uint32_t thermal_rows = 0;            ///< format 3: 1 … kMostThermalRows, above: also 0
  PerRotary<std::uint32_t> rotary_values{};  ///< format 4 and 5: of each curve, at most RotaryAxisWorking::kMostCells
};
/// The oldest format that can hold a map.
[[nodiscard]] constexpr std::uint16_t format_for(bool thermal_rows, bool rotary_axes, bool bending = false) noexcept {
  return bending        ? kFormatWithBending
         : rotary_axes  ? kFormatWithRotary
         : thermal_rows ? kFormatWithThermal
                        : kImageFormat;
}
inline constexpr std::uint32_t kIdentityOffset = kPrefixBytes + kParameterBytes;
[[nodiscard]] constexpr std::uint32_t directory_offset(std::uint16_t format = kImageFormat) noexcept {
  return format == kFormatWithoutIdentity ? kIdentityOffset : kIdentityOffset + kIdentityBytes;
}
[[nodiscard]] constexpr std::uint32_t thermal_offset(const ImagePlan& plan) noexcept {
  return directory_offset(plan.format) + plan.table_count * kEntryBytes;
}
[[nodiscard]] constexpr std::uint32_t rotary_offset(const ImagePlan& plan) noexcept {
  return thermal_offset(plan) +
         (plan.thermal_rows > 0 ? kThermalSettingsBytes + plan.thermal_rows * kThermalRowBytes : 0);
}
/// Of the rotary axes before their curves.
[[nodiscard]] constexpr std::uint32_t rotary_bytes(std::uint16_t format) noexcept {
  return kRotaryBytes + (format == kFormatWithBending ? kBendingBytes : 0);
}
[[nodiscard]] constexpr std::uint32_t values_offset(const ImagePlan& plan) noexcept {
  if (plan.format < kFormatWithRotary) return rotary_offset(plan);
  return rotary_offset(plan) + rotary_bytes(plan.format) +
         (plan.rotary_values[0] + plan.rotary_values[1]) * kRotaryValueBytes;
}
[[nodiscard]] constexpr std::uint32_t header_offset(const ImagePlan& plan) noexcept {
  return values_offset(plan) + plan.value_count * 2;
}
[[nodiscard]] constexpr std::uint32_t image_bytes(const ImagePlan& plan) noexcept {
  return header_offset(plan) + plan.header_bytes;
}

// --- writing; every function: @pre image.size() == image_bytes(plan), indices within the plan
void begin_image(Bytes image, const ImagePlan& plan) noexcept;
void write_parameters(Bytes image, const UnitParameters& parameters) noexcept;
/// Longer texts are cut.
void write_identity(Bytes image, const ImageIdentity& identity) noexcept;
void write_entry(Bytes image, std::uint32_t index, const TableEntry& entry) noexcept;
/// @pre the plan has as many rows, at least one
void write_thermal(Bytes image, const ThermalSettings& settings, std::span<const ThermalRow> rows) noexcept;
/// @pre the plan has format 4 or, with its bending, 5, and as many values of each curve as these axes
void write_rotary(Bytes image, const RotarySetup& setup) noexcept;
void write_value(Bytes image, std::uint32_t index, std::int16_t counts) noexcept;
void write_header(Bytes image, std::string_view text) noexcept;
/// Computes and stores the checksum; the last step.
void seal_image(Bytes image) noexcept;

/// The parameters as the fixed block of the image, and back; nothing if a word or number in it is impossible.
void encode_parameters(const UnitParameters& parameters, Bytes block) noexcept;
[[nodiscard]] std::optional<UnitParameters> decode_parameters(ByteView block) noexcept;

// --- reading
enum class ImageFault : std::uint8_t {
  none,
  no_image,
  wrong_format,
  wrong_length,
  block_check,
  bad_parameters,
  bad_directory,
  bad_entry,
  duplicate_table,
  over_capacity,
  bad_thermal_row,
  bad_rotary_axis
};
[[nodiscard]] std::string_view text_of(ImageFault fault) noexcept;

struct ImageVerdict {
  ImageFault fault = ImageFault::none;
  std::uint32_t total_bytes = 0;
  std::uint32_t check_expected = 0;  ///< stored in the image
  std::uint32_t check_found = 0;     ///< computed over the bytes
  std::uint32_t table = 0;           ///< at fault, for bad_entry and duplicate_table; the row, for bad_thermal_row
};

/// Every offset, count and number of the image, then its checksum. Total: any bytes are accepted as input.
/// @param bank  the bank from its first byte; may be longer than the image
[[nodiscard]] ImageVerdict check_image(ByteView bank) noexcept;

/// Reads an image that check_image() found sound.
class ImageView {
 public:
  explicit ImageView(ByteView image) noexcept : image_(image) {}
  [[nodiscard]] std::uint32_t total_bytes() const noexcept;
  [[nodiscard]] std::uint32_t check() const noexcept;
  [[nodiscard]] std::uint16_t format() const noexcept;
  /// Views into the image; nothing in an image of format 1.
  [[nodiscard]] std::optional<ImageIdentity> identity() const noexcept;
  [[nodiscard]] std::uint32_t table_count() const noexcept;
  [[nodiscard]] std::uint32_t value_count() const noexcept;
  [[nodiscard]] TableEntry entry(std::uint32_t index) const noexcept;
  /// 0 but from format 3 on.
  [[nodiscard]] std::uint32_t thermal_count() const noexcept;
  [[nodiscard]] ThermalRow thermal_row(std::uint32_t index) const noexcept;
  /// @pre thermal_count() > 0
  [[nodiscard]] ThermalSettings thermal_settings() const noexcept;
  /// Its curves are views into the image; nothing but in formats 4 and 5.
  [[nodiscard]] std::optional<RotarySetup> rotary() const noexcept;
  /// Offset of a value from the start of the image.
  [[nodiscard]] std::uint32_t value_offset(std::uint32_t index) const noexcept;
  [[nodiscard]] std::int16_t value_counts(std::uint32_t index) const noexcept;
  [[nodiscard]] std::optional<UnitParameters> parameters() const noexcept;
  [[nodiscard]] std::string_view header() const noexcept;

 private:
  ByteView image_;
};

// --- whose image
/// What a unit knows of itself and of its machine. It takes the name and the configuration of the machine from the map
/// it holds; without a map it takes those of the next one.
struct OwnIdentity {
  ImageIdentity identity;
  bool has_map = false;  ///< otherwise machine and configuration are not known
};
enum class IdentityFault : std::uint8_t { none, not_stated, other_serial_number, other_machine, other_configuration };
[[nodiscard]] std::string_view text_of(IdentityFault fault) noexcept;
/// Why this unit does not take the image. @pre check_image() found the image sound
[[nodiscard]] IdentityFault identity_fault(ByteView image, const OwnIdentity& own) noexcept;
/// The identity of a unit with this serial number. @param active  its active image, sound; empty: it has none
[[nodiscard]] OwnIdentity own_identity(std::string_view serial_number, ByteView active) noexcept;

// --- which bank is active
/// The record that switches a new image active. Two slots: a commit is written into the one that is not in force, then
/// the other is erased, and only then the commit is answered. So a damaged record never brings an older map back.
struct Commit {
  std::uint32_t sequence = 0;  ///< 1, 2, …
  std::uint32_t bank = 0;      ///< 0 = A, 1 = B
  std::uint32_t image_bytes = 0;
  std::uint32_t image_check = 0;  ///< checksum of the image committed
  friend bool operator==(const Commit&, const Commit&) = default;
};
inline constexpr std::uint32_t kCommitSlotBytes = 64;
inline constexpr std::uint32_t kCommitSlots = 2;
/// @param records  the region of commit records (two slots)
[[nodiscard]] std::optional<Commit> active_commit(ByteView records) noexcept;
enum class SlotState : std::uint8_t {
  blank,   ///< erased: every byte 0x00, or every byte 0xFF
  sound,   ///< holds a commit
  damaged  ///< neither: what it held is lost, or it was never finished
};
/// @param slot  0 or 1
[[nodiscard]] SlotState state_of_slot(ByteView records, std::uint32_t slot) noexcept;
/// The first slot that is damaged.
[[nodiscard]] std::optional<std::uint32_t> damaged_slot(ByteView records) noexcept;
/// The bytes of one slot, and the slot that must be overwritten next (never the active one).
void encode_commit(const Commit& commit, Bytes slot) noexcept;
[[nodiscard]] std::uint32_t next_commit_slot(ByteView records) noexcept;

}  // namespace ecs
