// The unit's memory: the regions of core/address_map.hpp with bytes in them, what can be wrong with a memory chip, and
// what the unit checks before it compensates (thesis 5.3): axis memory, checksum, parameters, map; and the file that
// stands for the lithium battery, in which axis memory and commit records survive (5.2). One battery, one emulator: a
// lock lies beside the file, which is replaced whole at every change and cannot carry a lock itself. Does not live
// here: who may write when, and what follows from a test (unit.hpp).
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "base/process.hpp"
#include "base/result.hpp"
#include "core/address_map.hpp"
#include "core/bytes.hpp"
#include "core/fault.hpp"
#include "core/tick.hpp"
#include "ecs_emulator/unit/rack.hpp"

namespace ecs::emulator {

class UnitMemory {
 public:
  /// A rack with `modules` axis memory modules: that much of either bank exists.
  explicit UnitMemory(std::uint8_t modules);

  [[nodiscard]] std::uint8_t modules() const { return modules_; }
  /// Every byte of the stretch exists, and all of it lies in one region.
  [[nodiscard]] bool exists(Address first, std::uint32_t size) const;
  /// The same, and the host may write it (in integration mode).
  [[nodiscard]] bool writable(Address first, std::uint32_t size) const;

  /// @pre exists(first, size)
  [[nodiscard]] ByteView view(Address first, std::uint32_t size) const;
  [[nodiscard]] std::uint8_t read(Address address) const { return *at(address); }
  /// Stuck bits keep their state; after power has failed nothing changes any more. @pre exists(address, 1)
  void write(Address address, std::uint8_t value);
  void write(Address first, ByteView bytes);
  /// EPROM and system RAM as after power-up; axis memory and commit records stay.
  void power_up();

  // what can be wrong
  /// One bit of a location is stuck at `level` (0 or 1).
  void stick(Address address, int bit, int level);
  /// Flips bits of one location, whatever the region.
  void corrupt(Address address, std::uint8_t bits) {
    ++version_;
    *at(address) = static_cast<std::uint8_t>(read(address) ^ bits);
  }
  void repair() { stuck_.clear(); }
  /// Power fails after this many further writes to battery-backed memory.
  void power_fails_after(std::uint64_t writes) { writes_left_ = writes; }
  void power_back() {
    writes_left_.reset();
    power_failed_ = false;
  }
  /// A write has met the power failure.
  [[nodiscard]] bool power_failed() const { return power_failed_; }

  /// Changed since the battery's file was last written.
  [[nodiscard]] bool changed() const { return changed_; }
  void kept() { changed_ = false; }
  /// Another number whenever battery-backed memory may have changed.
  [[nodiscard]] std::uint64_t version() const { return version_; }

 private:
  struct Stuck {
    Address address = 0;
    std::uint8_t mask = 0;
    std::uint8_t value = 0;
  };
  [[nodiscard]] std::uint8_t* at(Address address);
  [[nodiscard]] const std::uint8_t* at(Address address) const;
  [[nodiscard]] std::optional<std::size_t> region_of(Address first, std::uint32_t size) const;

  std::uint8_t modules_;
  std::array<std::vector<std::uint8_t>, kRegions.size()> bytes_;
  std::vector<Stuck> stuck_;
  std::optional<std::uint64_t> writes_left_;
  bool power_failed_ = false;
  bool changed_ = false;
  std::uint64_t version_ = 0;
};

struct TestVerdict {
  Fault fault = Fault::none;
  Address address = 0;         ///< of the failing location, or of the image at fault
  std::optional<Axis> axis;    ///< an axis that the parameters name and the rack has no such module for
  std::uint32_t expected = 0;  ///< checksum stored with the active image
  std::uint32_t found = 0;     ///< checksum computed over it
};

/// First address of axis memory (both banks) that does not hold what is written; its content is restored. The commit
/// records are not written to: they carry their own check.
[[nodiscard]] std::optional<Address> test_axis_memory(UnitMemory& memory);

/// The image that the commit records name, from its first byte to the end of its bank.
struct ActiveImage {
  Commit commit{};
  Address first = 0;
};
[[nodiscard]] std::optional<ActiveImage> active_image(const UnitMemory& memory);
/// The first byte of a commit record that is neither erased nor sound.
[[nodiscard]] std::optional<Address> damaged_record(const UnitMemory& memory);
/// What the unit knows of itself and, by the active image if it is sound, of its machine.
[[nodiscard]] OwnIdentity own_identity_of(const UnitMemory& memory, std::string_view serial_number);
/// The bank that holds no active image.
[[nodiscard]] Address inactive_bank(const UnitMemory& memory);
/// The address lies in the bank of the active image, which nothing but the unit's own tests may write.
[[nodiscard]] bool in_active_bank(const UnitMemory& memory, Address address);

/// Checksum, parameters and map of the active image; `map` is built on success.
/// An axis that the parameters name needs a module in the rack, for the transducer that they name.
[[nodiscard]] TestVerdict test_map(const UnitMemory& memory, const AxisModules& axis_modules, CompiledMap& map);

/// The active image if its checksum holds; a view into memory.
[[nodiscard]] std::optional<ImageView> stored_image(const UnitMemory& memory);

/// Brings the content of the file into the memory. A file that does not exist leaves it empty (a new battery). A file
/// that is none of ours, or of a rack with another number of modules, is a `bad_input` problem.
[[nodiscard]] Result<void> restore(UnitMemory& memory, const std::filesystem::path& path);

/// Writes the file, whole or not at all.
[[nodiscard]] Result<void> keep(UnitMemory& memory, const std::filesystem::path& path);

class BatteryLock {
 public:
  /// Locks `<battery>.in-use`, whatever links lead to the battery. Waits a second for a process that is just ending;
  /// then an `output` problem that names the process.
  [[nodiscard]] static Result<BatteryLock> take(const std::filesystem::path& battery);
  BatteryLock(BatteryLock&& other) noexcept : file_(std::move(other.file_)), path_(std::move(other.path_)) {}
  BatteryLock& operator=(BatteryLock&&) = delete;
  ~BatteryLock();  ///< removes the file

 private:
  BatteryLock(Descriptor file, std::filesystem::path path) : file_(std::move(file)), path_(std::move(path)) {}
  Descriptor file_;
  std::filesystem::path path_;
};

}  // namespace ecs::emulator
