// The image's bytes, whom an image is addressed to, and the record that makes a bank the active one. Does not live
// here: parameters as bytes (parameter_block.cpp).
#include "core/memory_image.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include <zlib.h>

#include "base/words.hpp"

namespace ecs {
namespace {

std::uint32_t crc32_from(std::uint32_t crc, ByteView bytes) noexcept {
  return static_cast<std::uint32_t>(::crc32_z(crc, bytes.data(), bytes.size()));
}

/// CRC-32 of an image with the check's own bytes taken as zero.
std::uint32_t block_check(ByteView image) noexcept {
  static constexpr std::array<std::uint8_t, 4> kZero{};
  std::uint32_t crc = crc32_from(0, image.first(prefix_at::check));
  crc = crc32_from(crc, kZero);
  return crc32_from(crc, image.subspan(prefix_at::check + 4));
}

std::uint32_t prefix_word(ByteView image, std::uint32_t at) noexcept { return load_big<std::uint32_t>(image, at); }

/// Ranges in which the tick can neither overflow nor divide by zero.
bool sound_entry(const TableEntry& e, std::uint32_t value_count) noexcept {
  if (e.declared_zero) return e.count == 0;
  if (e.count == 0 || e.first_value > value_count || e.count > value_count - e.first_value) return false;
  const bool finite = std::isfinite(e.start_mm) && std::isfinite(e.increment_mm) && std::isfinite(e.resolution);
  return finite && std::abs(e.start_mm) <= kLargestStart_mm && e.increment_mm >= kLeastIncrement_mm &&
         e.increment_mm <= kLargestIncrement_mm && e.resolution > 0.0 && e.resolution <= kLargestResolution;
}

/// Raw codes of an entry that cannot be turned into the enums.
bool known_codes(ByteView image, std::uint32_t at) noexcept {
  const auto approach = static_cast<std::int8_t>(image[at + 1]);
  return image[at] < kCurves && approach >= -1 && approach <= 1 && image[at + 2] <= 1;
}

bool clash(const TableEntry& a, const TableEntry& b) noexcept {
  if (a.component != b.component) return false;
  return a.approach == b.approach || a.approach == Approach::unknown || b.approach == Approach::unknown;
}

ImageVerdict check_directory(ByteView image, ImageVerdict verdict) noexcept {
  const ImageView view(image);
  std::uint32_t values_left = view.value_count();
  for (std::uint32_t i = 0; i < view.table_count(); ++i) {
    verdict.table = i;
    const std::uint32_t at = directory_offset(view.format()) + i * kEntryBytes;
    if (!known_codes(image, at) || !sound_entry(view.entry(i), view.value_count())) {
      verdict.fault = ImageFault::bad_entry;
      return verdict;
    }
    if (view.entry(i).count > values_left) {
      verdict.fault = ImageFault::bad_directory;
      return verdict;
    }
    values_left -= view.entry(i).count;
    for (std::uint32_t j = 0; j < i; ++j)
      if (clash(view.entry(i), view.entry(j))) {
        verdict.fault = ImageFault::duplicate_table;
        return verdict;
      }
  }
  verdict.table = 0;
  return verdict;
}

/// The numbers of the settings in the order of their bytes.
template <class Settings>
auto numbers_of(Settings& s) noexcept {
  return std::array{&s.rate_um_per_s,      &s.hold_s,    &s.longest_age_s, &s.stuck_s,
                    &s.fastest_degC_per_s, &s.step_degC, &s.least_degC,    &s.greatest_degC};
}

/// Settings and rows; their codes are judged before they become enumerations.
ImageVerdict check_thermal(ByteView image, ImageVerdict verdict) noexcept {
  const ImageView view(image);
  const std::uint32_t rows_at = prefix_word(image, prefix_at::thermal) + kThermalSettingsBytes;
  if (!sound(view.thermal_settings())) verdict.fault = ImageFault::bad_thermal_row;
  for (std::uint32_t k = 0; k < view.thermal_count() && verdict.fault == ImageFault::none; ++k) {
    const std::uint32_t at = rows_at + k * kThermalRowBytes;
    verdict.table = k;
    if (image[at] >= kCurves || image[at + 1] >= kThermalLaws || !sound(view.thermal_row(k)))
      verdict.fault = ImageFault::bad_thermal_row;
  }
  if (verdict.fault == ImageFault::none) verdict.table = 0;
  return verdict;
}

/// Bytes of the section before the axes, and of an axis before its numbers.
constexpr std::uint32_t kConfigurationBytes = 16, kLetterBytes = 8;

/// The numbers of an axis and its curves in the order of their bytes.
template <class AxisOfSetup, class Curves>
auto numbers_of(AxisOfSetup& a, Curves& c) noexcept {
  return std::array{&a.deg_per_count, &a.deadband_deg,  &a.zero_deg,      &a.direction[0],  &a.direction[1],
                    &a.direction[2],  &a.pivot_mm[0],   &a.pivot_mm[1],   &a.pivot_mm[2],   &a.location[0],
                    &a.location[1],   &a.location[2],   &a.location[3],   &a.location[4],   &a.location[5],
                    &c.start_deg,     &c.increment_deg, &c.resolution[0], &c.resolution[1], &c.resolution[2],
                    &c.resolution[3], &c.resolution[4], &c.resolution[5]};
}

/// The numbers of bending in the order of their bytes.
template <class Bending>
auto bending_numbers(Bending& bending) noexcept {
  std::array<decltype(bending.of_machine.data()), kBendingBytes / 8> numbers{};
  for (std::size_t i = 0; i < numbers.size() / 2; ++i) {
    numbers[i] = &bending.of_machine[i];
    numbers[numbers.size() / 2 + i] = &bending.of_tool[i];
  }
  return numbers;
}

/// Axes and curves by themselves; what the parameters ask of them is left to compile().
ImageVerdict check_rotary(ByteView image, ImageVerdict verdict) noexcept {
  const RotarySetup setup = *ImageView(image).rotary();
  const auto known = [](char letter) { return std::string_view("ABCXYZT").find(letter) != std::string_view::npos; };
  const auto end = std::find(setup.configuration.begin(), setup.configuration.end(), '\0');
  bool sound = end != setup.configuration.end() && std::all_of(setup.configuration.begin(), end, known) &&
               std::all_of(end, setup.configuration.end(), [](char letter) { return letter == '\0'; });
  for (std::size_t i = 0; i < kRotaryInputs; ++i)
    sound = sound && (setup.axes[i].letter != '\0' || setup.tables[i].count == 0);
  if (!sound || own_fault_of(setup) != RotaryFault::none) verdict.fault = ImageFault::bad_rotary_axis;
  return verdict;
}

}  // namespace

void begin_image(Bytes image, const ImagePlan& plan) noexcept {
  std::fill(image.begin(), image.end(), std::uint8_t{0});
  store_big(image, prefix_at::magic, kImageMagic);
  store_big(image, prefix_at::format, plan.format);
  store_big(image, prefix_at::total_bytes, image_bytes(plan));
  store_big(image, prefix_at::parameters, kPrefixBytes);
  store_big(image, prefix_at::directory, directory_offset(plan.format));
  store_big(image, prefix_at::table_count, plan.table_count);
  store_big(image, prefix_at::values, values_offset(plan));
  store_big(image, prefix_at::value_count, plan.value_count);
  store_big(image, prefix_at::header, header_offset(plan));
  store_big(image, prefix_at::header_bytes, plan.header_bytes);
  if (plan.thermal_rows > 0) {
    store_big(image, prefix_at::thermal, thermal_offset(plan));
    store_big(image, prefix_at::thermal_count, plan.thermal_rows);
  }
  if (plan.format < kFormatWithRotary) return;
  store_big(image, prefix_at::rotary, rotary_offset(plan));
  for (std::uint32_t i = 0; i < kRotaryInputs; ++i)
    store_big(image, prefix_at::rotary_count + 4 * i, plan.rotary_values[i]);
}

void write_parameters(Bytes image, const UnitParameters& parameters) noexcept {
  encode_parameters(parameters, image.subspan(kPrefixBytes, kParameterBytes));
}

void write_entry(Bytes image, std::uint32_t index, const TableEntry& entry) noexcept {
  const std::uint32_t at = prefix_word(image, prefix_at::directory) + index * kEntryBytes;
  image[at] = static_cast<std::uint8_t>(entry.component);
  image[at + 1] = static_cast<std::uint8_t>(entry.approach);
  image[at + 2] = entry.declared_zero ? 1 : 0;
  store_big(image, at + 4, entry.first_value);
  store_big(image, at + 8, entry.count);
  store_double(image, at + 16, entry.start_mm);
  store_double(image, at + 24, entry.increment_mm);
  store_double(image, at + 32, entry.resolution);
}

void write_thermal(Bytes image, const ThermalSettings& settings, std::span<const ThermalRow> rows) noexcept {
  std::uint32_t at = prefix_word(image, prefix_at::thermal);
  const auto numbers = numbers_of(settings);
  for (std::size_t i = 0; i < numbers.size(); ++i) store_double(image, at + 8 * i, *numbers[i]);
  at += kThermalSettingsBytes;
  for (const ThermalRow& row : rows) {
    image[at] = static_cast<std::uint8_t>(row.component);
    image[at + 1] = static_cast<std::uint8_t>(row.law);
    image[at + 2] = row.source;
    image[at + 3] = row.minus;
    store_double(image, at + 8, row.coefficient);
    store_double(image, at + 16, row.reference);
    store_double(image, at + 24, row.lag_s);
    store_double(image, at + 32, row.origin_mm);
    at += kThermalRowBytes;
  }
}

void write_rotary(Bytes image, const RotarySetup& setup) noexcept {
  const std::uint32_t first = prefix_word(image, prefix_at::rotary);
  std::copy(setup.configuration.begin(), setup.configuration.end(), image.begin() + first);
  const auto format = load_big<std::uint16_t>(image, prefix_at::format);
  std::uint32_t curves_at = first + rotary_bytes(format);
  for (std::uint32_t i = 0; i < kRotaryInputs; ++i) {
    const std::uint32_t at = first + kConfigurationBytes + i * kRotaryAxisBytes;
    image[at] = static_cast<std::uint8_t>(setup.axes[i].letter);
    const auto numbers = numbers_of(setup.axes[i], setup.tables[i]);
    for (std::uint32_t n = 0; n < numbers.size(); ++n) store_double(image, at + kLetterBytes + 8 * n, *numbers[n]);
    for (const ByteView& side : setup.tables[i].values) {
      std::copy(side.begin(), side.end(), image.begin() + curves_at);
      curves_at += static_cast<std::uint32_t>(side.size());
    }
  }
  if (format < kFormatWithBending) return;
  const auto bending = bending_numbers(setup.bending);
  for (std::uint32_t n = 0; n < bending.size(); ++n) store_double(image, first + kRotaryBytes + 8 * n, *bending[n]);
}

void write_value(Bytes image, std::uint32_t index, std::int16_t counts) noexcept {
  store_big(image, prefix_word(image, prefix_at::values) + 2 * index, static_cast<std::uint16_t>(counts));
}

void write_header(Bytes image, std::string_view text) noexcept {
  std::memcpy(image.data() + prefix_word(image, prefix_at::header), text.data(), text.size());
}

void seal_image(Bytes image) noexcept { store_big(image, prefix_at::check, block_check(image)); }

std::string_view text_of(ImageFault fault) noexcept {
  return WordTable<ImageFault, 12>{
      {"sound", "contains no image", "has a format unknown to this program",
       "is truncated, or its lengths are inconsistent", "is corrupt: the checksum (CRC-32) does not agree",
       "contains impossible parameters", "has a table directory of impossible numbers",
       "has a table of impossible numbers", "contains a table twice",
       "contains more values than the axis memory modules can store",
       "has thermal settings or a thermal row of impossible numbers", "has a rotary axis of impossible numbers"}}
      .of(fault);
}

namespace {

/// What the prefix states.
ImagePlan plan_of(ByteView image) noexcept {
  ImagePlan plan{prefix_word(image, prefix_at::table_count), prefix_word(image, prefix_at::value_count),
                 prefix_word(image, prefix_at::header_bytes), load_big<std::uint16_t>(image, prefix_at::format)};
  if (plan.format >= kFormatWithThermal) plan.thermal_rows = prefix_word(image, prefix_at::thermal_count);
  if (plan.format >= kFormatWithRotary)
    for (std::uint32_t i = 0; i < kRotaryInputs; ++i)
      plan.rotary_values[i] = prefix_word(image, prefix_at::rotary_count + 4 * i);
  return plan;
}

}  // namespace

ImageVerdict check_image(ByteView bank) noexcept {
  ImageVerdict verdict;
  const auto with = [&](ImageFault fault) {
    verdict.fault = fault;
    return verdict;
  };
  if (bank.size() < kPrefixBytes || prefix_word(bank, prefix_at::magic) != kImageMagic)
    return with(ImageFault::no_image);
  const auto format = load_big<std::uint16_t>(bank, prefix_at::format);
  if (format < kFormatWithoutIdentity || format > kFormatWithBending) return with(ImageFault::wrong_format);
  verdict.total_bytes = prefix_word(bank, prefix_at::total_bytes);
  verdict.check_expected = prefix_word(bank, prefix_at::check);
  if (verdict.total_bytes > bank.size() || verdict.total_bytes < directory_offset(format))
    return with(ImageFault::wrong_length);
  const ByteView image = bank.first(verdict.total_bytes);
  verdict.check_found = block_check(image);
  if (verdict.check_found != verdict.check_expected) return with(ImageFault::block_check);

  const ImagePlan plan = plan_of(image);
  const bool thermal = format == kFormatWithThermal || plan.thermal_rows > 0, rotary = format >= kFormatWithRotary;
  if (plan.table_count > kMostTables) return with(ImageFault::bad_directory);
  if (plan.thermal_rows > kMostThermalRows || (thermal && plan.thermal_rows == 0))
    return with(ImageFault::bad_thermal_row);
  if (std::any_of(plan.rotary_values.begin(), plan.rotary_values.end(),
                  [](std::uint32_t count) { return count > RotaryAxisWorking::kMostCells; }))
    return with(ImageFault::bad_rotary_axis);
  if (plan.value_count > kMostValues) return with(ImageFault::over_capacity);
  if (plan.header_bytes > verdict.total_bytes || image_bytes(plan) != verdict.total_bytes)
    return with(ImageFault::wrong_length);
  if (prefix_word(image, prefix_at::parameters) != kPrefixBytes ||
      prefix_word(image, prefix_at::directory) != directory_offset(format) ||
      (thermal && prefix_word(image, prefix_at::thermal) != thermal_offset(plan)) ||
      (rotary && prefix_word(image, prefix_at::rotary) != rotary_offset(plan)) ||
      prefix_word(image, prefix_at::values) != values_offset(plan) ||
      prefix_word(image, prefix_at::header) != header_offset(plan))
    return with(ImageFault::wrong_length);
  const auto parameters = ImageView(image).parameters();
  if (!parameters) return with(ImageFault::bad_parameters);
  if (plan.value_count > parameters->memory_modules * kValuesPerModule) return with(ImageFault::over_capacity);
  verdict = check_directory(image, verdict);
  if (thermal && verdict.fault == ImageFault::none) verdict = check_thermal(image, verdict);
  if (rotary && verdict.fault == ImageFault::none) verdict = check_rotary(image, verdict);
  return verdict;
}

std::uint32_t ImageView::total_bytes() const noexcept { return prefix_word(image_, prefix_at::total_bytes); }
std::uint32_t ImageView::check() const noexcept { return prefix_word(image_, prefix_at::check); }
std::uint16_t ImageView::format() const noexcept { return load_big<std::uint16_t>(image_, prefix_at::format); }
std::uint32_t ImageView::table_count() const noexcept { return prefix_word(image_, prefix_at::table_count); }
std::uint32_t ImageView::value_count() const noexcept { return prefix_word(image_, prefix_at::value_count); }

TableEntry ImageView::entry(std::uint32_t index) const noexcept {
  const std::uint32_t at = directory_offset(format()) + index * kEntryBytes;
  return {static_cast<Component>(image_[at]),
          static_cast<Approach>(static_cast<std::int8_t>(image_[at + 1])),
          image_[at + 2] != 0,
          load_big<std::uint32_t>(image_, at + 4),
          load_big<std::uint32_t>(image_, at + 8),
          load_double(image_, at + 16),
          load_double(image_, at + 24),
          load_double(image_, at + 32)};
}

std::uint32_t ImageView::thermal_count() const noexcept {
  return format() >= kFormatWithThermal ? prefix_word(image_, prefix_at::thermal_count) : 0;
}

ThermalRow ImageView::thermal_row(std::uint32_t index) const noexcept {
  const std::uint32_t at = prefix_word(image_, prefix_at::thermal) + kThermalSettingsBytes + index * kThermalRowBytes;
  return {static_cast<Component>(image_[at]),
          static_cast<ThermalLaw>(image_[at + 1]),
          image_[at + 2],
          image_[at + 3],
          load_double(image_, at + 8),
          load_double(image_, at + 16),
          load_double(image_, at + 24),
          load_double(image_, at + 32)};
}

ThermalSettings ImageView::thermal_settings() const noexcept {
  ThermalSettings settings;
  const auto numbers = numbers_of(settings);
  for (std::size_t i = 0; i < numbers.size(); ++i)
    *numbers[i] = load_double(image_, prefix_word(image_, prefix_at::thermal) + 8 * i);
  return settings;
}

std::optional<RotarySetup> ImageView::rotary() const noexcept {
  if (format() < kFormatWithRotary) return std::nullopt;
  RotarySetup setup;
  const std::uint32_t first = prefix_word(image_, prefix_at::rotary);
  std::copy_n(image_.begin() + first, setup.configuration.size(), setup.configuration.begin());
  std::uint32_t curves_at = first + rotary_bytes(format());
  for (std::uint32_t i = 0; i < kRotaryInputs; ++i) {
    const std::uint32_t at = first + kConfigurationBytes + i * kRotaryAxisBytes;
    RotaryCurves& table = setup.tables[i];
    setup.axes[i].letter = static_cast<char>(image_[at]);
    const auto numbers = numbers_of(setup.axes[i], table);
    for (std::uint32_t n = 0; n < numbers.size(); ++n) *numbers[n] = load_double(image_, at + kLetterBytes + 8 * n);
    table.count = prefix_word(image_, prefix_at::rotary_count + 4 * i);
    for (ByteView& side : table.values) {
      side = image_.subspan(curves_at, table.count * kRotaryValueBytes / 2);
      curves_at += table.count * kRotaryValueBytes / 2;
    }
  }
  if (format() < kFormatWithBending) return setup;
  const auto bending = bending_numbers(setup.bending);
  for (std::uint32_t n = 0; n < bending.size(); ++n) *bending[n] = load_double(image_, first + kRotaryBytes + 8 * n);
  return setup;
}

std::uint32_t ImageView::value_offset(std::uint32_t index) const noexcept {
  return prefix_word(image_, prefix_at::values) + 2 * index;
}
std::int16_t ImageView::value_counts(std::uint32_t index) const noexcept {
  return static_cast<std::int16_t>(load_big<std::uint16_t>(image_, value_offset(index)));
}
std::optional<UnitParameters> ImageView::parameters() const noexcept {
  return decode_parameters(image_.subspan(kPrefixBytes, kParameterBytes));
}
std::string_view ImageView::header() const noexcept {
  const ByteView text =
      image_.subspan(prefix_word(image_, prefix_at::header), prefix_word(image_, prefix_at::header_bytes));
  return {reinterpret_cast<const char*>(text.data()), text.size()};
}

namespace {

std::string_view text_in(ByteView image, std::uint32_t at, std::size_t most) noexcept {
  const auto* const first = reinterpret_cast<const char*>(image.data() + kIdentityOffset + at);
  return {first, static_cast<std::size_t>(std::find(first, first + most, '\0') - first)};
}

void put_text(Bytes identity, std::uint32_t at, std::string_view text, std::size_t most) noexcept {
  std::memcpy(identity.data() + at, text.data(), std::min(text.size(), most));
}

bool printable(std::string_view text) noexcept {
  return std::none_of(text.begin(), text.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte < 0x20 || byte == 0x7F;
  });
}

}  // namespace

std::uint32_t configuration_hash(const UnitParameters& parameters) noexcept {
  std::array<std::uint8_t, 5 + kAxes + 1> bytes{};
  std::copy(parameters.configuration.begin(), parameters.configuration.end(), bytes.begin());
  for (std::size_t a = 0; a < kAxes; ++a) bytes[5 + a] = parameters.axis_present[a] ? 1 : 0;
  bytes.back() = static_cast<std::uint8_t>(parameters.convention);
  return static_cast<std::uint32_t>(::crc32_z(0, bytes.data(), bytes.size()));
}

std::string_view machine_in_identity(std::string_view name) noexcept {
  if (name.size() <= kMostMachineBytes) return name;
  std::size_t end = kMostMachineBytes;
  while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xC0u) == 0x80u) --end;
  return name.substr(0, end);
}

void write_identity(Bytes image, const ImageIdentity& identity) noexcept {
  const Bytes block = image.subspan(kIdentityOffset, kIdentityBytes);
  std::fill(block.begin(), block.end(), std::uint8_t{0});
  put_text(block, identity_at::serial_number, identity.serial_number, kMostSerialNumberBytes);
  put_text(block, identity_at::machine, machine_in_identity(identity.machine), kMostMachineBytes);
  store_big(block, identity_at::configuration, identity.configuration);
}

std::optional<ImageIdentity> ImageView::identity() const noexcept {
  if (format() == kFormatWithoutIdentity) return std::nullopt;
  return ImageIdentity{text_in(image_, identity_at::serial_number, kMostSerialNumberBytes),
                       text_in(image_, identity_at::machine, kMostMachineBytes),
                       load_big<std::uint32_t>(image_, kIdentityOffset + identity_at::configuration)};
}

std::string_view text_of(IdentityFault fault) noexcept {
  switch (fault) {
    case IdentityFault::none:
      return "is for this unit";
    case IdentityFault::not_stated:
      return "does not state its unit";
    case IdentityFault::other_serial_number:
      return "is for the unit with another serial number";
    case IdentityFault::other_machine:
      return "is for another machine than the active map";
    case IdentityFault::other_configuration:
      return "is for another configuration than the active map";
  }
  return "unknown";
}

OwnIdentity own_identity(std::string_view serial_number, ByteView active) noexcept {
  OwnIdentity own{{serial_number, {}, 0}, false};
  if (active.empty()) return own;
  const ImageView view(active);
  const auto parameters = view.parameters();
  if (view.table_count() == 0 || !parameters) return own;
  own.has_map = true;
  own.identity.configuration = configuration_hash(*parameters);
  if (const auto stated = view.identity()) own.identity.machine = stated->machine;
  return own;
}

IdentityFault identity_fault(ByteView image, const OwnIdentity& own) noexcept {
  const ImageView view(image);
  const auto stated = view.identity();
  const auto parameters = view.parameters();
  if (!stated || !parameters || stated->serial_number.empty()) return IdentityFault::not_stated;
  if (!printable(stated->serial_number) || !printable(stated->machine)) return IdentityFault::not_stated;
  if (stated->serial_number != own.identity.serial_number.substr(0, kMostSerialNumberBytes))
    return IdentityFault::other_serial_number;
  const bool other_name = !own.identity.machine.empty() && stated->machine != own.identity.machine;
  if (own.has_map && other_name) return IdentityFault::other_machine;
  const std::uint32_t expected = own.has_map ? own.identity.configuration : configuration_hash(*parameters);
  return stated->configuration == expected ? IdentityFault::none : IdentityFault::other_configuration;
}

namespace {

constexpr std::uint32_t kCommitMagic = 0x434D4954;  // "CMIT"
constexpr std::uint32_t kCheckAt = 20;

std::uint32_t record_check(ByteView slot) noexcept {
  return static_cast<std::uint32_t>(::crc32_z(0, slot.data(), kCheckAt));
}

std::optional<Commit> commit_in(ByteView slot) noexcept {
  if (load_big<std::uint32_t>(slot, 0) != kCommitMagic) return std::nullopt;
  if (load_big<std::uint32_t>(slot, kCheckAt) != record_check(slot)) return std::nullopt;
  const Commit commit{load_big<std::uint32_t>(slot, 4), load_big<std::uint32_t>(slot, 8),
                      load_big<std::uint32_t>(slot, 12), load_big<std::uint32_t>(slot, 16)};
  if (commit.bank > 1) return std::nullopt;
  return commit;
}

std::optional<Commit> commit_in(ByteView records, std::uint32_t slot) noexcept {
  return commit_in(records.subspan(slot * kCommitSlotBytes, kCommitSlotBytes));
}

}  // namespace

std::optional<Commit> active_commit(ByteView records) noexcept {
  return newest_record(records, [](ByteView slot) { return commit_in(slot); });
}

SlotState state_of_slot(ByteView records, std::uint32_t slot) noexcept {
  if (commit_in(records, slot)) return SlotState::sound;
  const ByteView bytes = records.subspan(slot * kCommitSlotBytes, kCommitSlotBytes);
  const bool erased = (bytes[0] == 0x00 || bytes[0] == 0xFF) &&
                      std::all_of(bytes.begin(), bytes.end(), [&](std::uint8_t byte) { return byte == bytes[0]; });
  return erased ? SlotState::blank : SlotState::damaged;
}

std::optional<std::uint32_t> damaged_slot(ByteView records) noexcept {
  for (std::uint32_t slot = 0; slot < kCommitSlots; ++slot)
    if (state_of_slot(records, slot) == SlotState::damaged) return slot;
  return std::nullopt;
}

std::uint32_t next_commit_slot(ByteView records) noexcept {
  return next_slot(records, [](ByteView slot) { return commit_in(slot); });
}

void encode_commit(const Commit& commit, Bytes slot) noexcept {
  std::fill(slot.begin(), slot.end(), std::uint8_t{0});
  store_big(slot, 0, kCommitMagic);
  store_big(slot, 4, commit.sequence);
  store_big(slot, 8, commit.bank);
  store_big(slot, 12, commit.image_bytes);
  store_big(slot, 16, commit.image_check);
  store_big(slot, kCheckAt, record_check(slot));
}

}  // namespace ecs
