#include "ecs_emulator/unit/memory.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <string>
#include <string_view>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.hpp"
#include "base/text.hpp"

namespace ecs::emulator {
namespace {

constexpr std::uint8_t kErasedEprom = 0xFF;
constexpr std::uint32_t kIdentificationAt = 0x400;
constexpr std::string_view kIdentification =
    "ECS UNIT FIRMWARE 1.2 VIRTUAL WORKSHOP\nEPROM 000000-00FFFF RAM 040000-04FFFF AXIS MEMORY 100000 AND 200000\n";

/// Reset vectors of the 68000 and the identification.
void burn(std::vector<std::uint8_t>& eprom) {
  std::fill(eprom.begin(), eprom.end(), kErasedEprom);
  store_big<std::uint32_t>(eprom, 0, kSystemRam.first + kSystemRam.size);
  store_big<std::uint32_t>(eprom, 4, kIdentificationAt);
  std::copy(kIdentification.begin(), kIdentification.end(), eprom.begin() + kIdentificationAt);
}

bool battery_backed(Address address) { return address >= kCommitRecords.first; }
/// What follows the active map is computed again when it may have changed; these records are none of it.
bool of_maps(Address address) {
  return battery_backed(address) && !kThermalRecord.contains(address) && !kToolRecord.contains(address);
}

}  // namespace

UnitMemory::UnitMemory(std::uint8_t modules) : modules_(modules) {
  for (std::size_t r = 0; r < kRegions.size(); ++r) {
    const bool bank = kRegions[r].first == kBankA.first || kRegions[r].first == kBankB.first;
    bytes_[r].assign(bank ? bank_bytes(modules) : kRegions[r].size, 0);
  }
  power_up();
}

void UnitMemory::power_up() {
  burn(bytes_[0]);
  std::fill(bytes_[1].begin(), bytes_[1].end(), std::uint8_t{0});
}

std::optional<std::size_t> UnitMemory::region_of(Address first, std::uint32_t size) const {
  for (std::size_t r = 0; r < kRegions.size(); ++r) {
    if (first < kRegions[r].first) continue;
    const std::uint64_t offset = first - kRegions[r].first;
    if (offset + size <= bytes_[r].size() && offset < bytes_[r].size()) return r;
  }
  return std::nullopt;
}

bool UnitMemory::exists(Address first, std::uint32_t size) const { return region_of(first, size).has_value(); }

bool UnitMemory::writable(Address first, std::uint32_t size) const {
  const auto region = region_of(first, size);
  return region && kRegions[*region].writable;
}

ByteView UnitMemory::view(Address first, std::uint32_t size) const { return {at(first), size}; }

const std::uint8_t* UnitMemory::at(Address address) const {
  const std::size_t region = *region_of(address, 1);
  return bytes_[region].data() + (address - kRegions[region].first);
}
std::uint8_t* UnitMemory::at(Address address) {
  const std::size_t region = *region_of(address, 1);
  return bytes_[region].data() + (address - kRegions[region].first);
}

void UnitMemory::write(Address address, std::uint8_t value) {
  if (battery_backed(address)) {
    power_failed_ = power_failed_ || (writes_left_ && *writes_left_ == 0);
    if (power_failed_) return;
    if (writes_left_) --*writes_left_;
    changed_ = true;
    if (of_maps(address)) ++version_;
  }
  for (const Stuck& stuck : stuck_)
    if (stuck.address == address) value = static_cast<std::uint8_t>((value & ~stuck.mask) | stuck.value);
  *at(address) = value;
}

void UnitMemory::write(Address first, ByteView bytes) {
  const auto region = region_of(first, static_cast<std::uint32_t>(bytes.size()));
  if (region && stuck_.empty() && !writes_left_ && !power_failed_) {
    changed_ = changed_ || battery_backed(first);
    if (of_maps(first)) ++version_;
    std::copy(bytes.begin(), bytes.end(), at(first));
    return;
  }
  for (std::size_t i = 0; i < bytes.size(); ++i) write(first + static_cast<Address>(i), bytes[i]);
}

void UnitMemory::stick(Address address, int bit, int level) {
  const auto mask = static_cast<std::uint8_t>(1u << bit);
  ++version_;
  stuck_.push_back({address, mask, level != 0 ? mask : std::uint8_t{0}});
  *at(address) = static_cast<std::uint8_t>((read(address) & ~mask) | stuck_.back().value);
}

namespace {

ByteView bank_from(const UnitMemory& memory, Address first) { return memory.view(first, bank_bytes(memory.modules())); }

Fault fault_of(ImageFault fault) {
  if (fault == ImageFault::none) return Fault::none;
  return fault == ImageFault::bad_parameters ? Fault::bad_parameters : Fault::block_check;
}

}  // namespace

std::optional<Address> test_axis_memory(UnitMemory& memory) {
  const bool changed = memory.changed();
  for (const Address bank : {kBankA.first, kBankB.first})
    if (const auto failing = failing_address(memory, bank, bank_bytes(memory.modules()))) return failing;
  if (!changed) memory.kept();
  return std::nullopt;
}

std::optional<ActiveImage> active_image(const UnitMemory& memory) {
  const auto commit = active_commit(memory.view(kCommitRecords.first, kCommitRecords.size));
  if (!commit || commit->image_bytes < kPrefixBytes || commit->image_bytes > bank_bytes(memory.modules()))
    return std::nullopt;
  return ActiveImage{*commit, commit->bank == 0 ? kBankA.first : kBankB.first};
}

std::optional<Address> damaged_record(const UnitMemory& memory) {
  const auto slot = damaged_slot(memory.view(kCommitRecords.first, kCommitRecords.size));
  if (!slot) return std::nullopt;
  return kCommitRecords.first + *slot * kCommitSlotBytes;
}

OwnIdentity own_identity_of(const UnitMemory& memory, std::string_view serial_number) {
  const auto active = active_image(memory);
  if (!active) return own_identity(serial_number, {});
  const ByteView image = memory.view(active->first, active->commit.image_bytes);
  return own_identity(serial_number, check_image(image).fault == ImageFault::none ? image : ByteView());
}

Address inactive_bank(const UnitMemory& memory) {
  const auto active = active_image(memory);
  return active && active->first == kBankA.first ? kBankB.first : kBankA.first;
}

bool in_active_bank(const UnitMemory& memory, Address address) {
  const auto active = active_image(memory);
  return active && in_axis_memory(address) && (address >= kBankB.first) == (active->first == kBankB.first);
}

TestVerdict test_map(const UnitMemory& memory, const AxisModules& axis_modules, CompiledMap& map) {
  const auto active = active_image(memory);
  const auto damaged = damaged_record(memory);
  if (!active && damaged) return {Fault::commit_record, *damaged, std::nullopt, 0, 0};
  if (!active) return {Fault::no_map, 0, std::nullopt, 0, 0};
  const ByteView bank = bank_from(memory, active->first);
  const ImageVerdict image = check_image(bank);
  TestVerdict verdict{fault_of(image.fault), active->first, std::nullopt, active->commit.image_check,
                      image.check_found};
  if (verdict.fault != Fault::none) return verdict;
  const ImageView view(bank.first(image.total_bytes));
  if (view.check() != active->commit.image_check) verdict.fault = Fault::block_check;
  if (verdict.fault != Fault::none) return verdict;
  const auto parameters = view.parameters();
  if (!parameters || parameters->memory_modules > memory.modules()) {
    verdict.fault = Fault::bad_parameters;
    return verdict;
  }
  for (const Axis a : kAllAxes) {
    const std::size_t i = index_of(a);
    if (!parameters->axis_present[i] || axis_modules[i] == parameters->axes[i].transducer) continue;
    verdict.fault = Fault::axis_module;
    verdict.axis = a;
    return verdict;
  }
  verdict.fault = compile(view, map).fault;
  return verdict;
}

std::optional<ImageView> stored_image(const UnitMemory& memory) {
  const auto active = active_image(memory);
  if (!active) return std::nullopt;
  const ByteView bank = bank_from(memory, active->first);
  const ImageVerdict image = check_image(bank);
  if (image.fault != ImageFault::none) return std::nullopt;
  return ImageView(bank.first(image.total_bytes));
}

namespace {

constexpr std::string_view kMagic = "ECS battery 1\n";

struct Part {
  Address first = 0;
  std::uint32_t size = 0;
};

constexpr std::size_t kPartsOfMaps = 3;
/// Records that a unit may be without follow the maps, the later ones last: files of before end earlier.
std::array<Part, 5> parts_of(const UnitMemory& memory) {
  const std::uint32_t bank = bank_bytes(memory.modules());
  return {{{kCommitRecords.first, kCommitRecords.size},
           {kBankA.first, bank},
           {kBankB.first, bank},
           {kThermalRecord.first, kThermalRecord.size},
           {kToolRecord.first, kToolRecord.size}}};
}

/// How many of the parts are written: without the records at the end that say nothing.
std::size_t parts_in_use(const UnitMemory& memory) {
  if (stored_tools(memory.view(kToolRecord.first, kToolRecord.size))) return kPartsOfMaps + 2;
  return kPartsOfMaps + (stored_thermal(memory.view(kThermalRecord.first, kThermalRecord.size)) ? 1 : 0);
}

}  // namespace

Result<void> restore(UnitMemory& memory, const std::filesystem::path& path) {
  if (!is_there(path)) return {};
  ECS_TRY(content, read_file(path));
  const auto parts = parts_of(memory);
  std::size_t whole = kMagic.size(), part_count = 0;
  while (part_count < parts.size() && whole < content.size()) whole += parts[part_count++].size;
  if (!content.starts_with(kMagic) || content.size() != whole || part_count < kPartsOfMaps) {
    std::size_t expected = kMagic.size();
    for (std::size_t i = 0; i < kPartsOfMaps; ++i) expected += parts[i].size;
    return problem_at(path.string(), 0, 0,
                      "expected the battery memory of a unit with {} memory module(s), {} bytes or those and its "
                      "records, got {} bytes; give another file, or delete it to begin with an empty memory",
                      memory.modules(), expected, content.size());
  }
  std::size_t at = kMagic.size();
  for (std::size_t i = 0; i < part_count; ++i) {
    const ByteView bytes(reinterpret_cast<const std::uint8_t*>(content.data()) + at, parts[i].size);
    memory.write(parts[i].first, bytes);
    at += parts[i].size;
  }
  memory.kept();
  return {};
}

Result<void> keep(UnitMemory& memory, const std::filesystem::path& path) {
  std::string content(kMagic);
  const auto parts = parts_of(memory);
  for (std::size_t i = 0; i < parts_in_use(memory); ++i) {
    const ByteView bytes = memory.view(parts[i].first, parts[i].size);
    content.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }
  ECS_DO(write_file(path, content));
  ECS_DO(keep_name(path));
  memory.kept();
  return {};
}

namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds kPatience{1};
constexpr std::chrono::milliseconds kBetweenTries{20};

/// The name still leads to the open file: nobody has removed it between opening and locking.
bool still_named(int file, const std::filesystem::path& path) {
  struct stat opened {};
  struct stat named {};
  return ::fstat(file, &opened) == 0 && ::stat(path.c_str(), &named) == 0 && opened.st_ino == named.st_ino &&
         opened.st_dev == named.st_dev;
}

std::string content_of(int file) {
  std::array<char, 64> text{};
  const ssize_t got = ::pread(file, text.data(), text.size(), 0);
  return std::string(trimmed(std::string_view(text.data(), got > 0 ? static_cast<std::size_t>(got) : 0)));
}

/// A plain file, empty or signed by an emulator.
bool is_ours(int file) {
  struct stat opened {};
  const std::string text = content_of(file);
  return ::fstat(file, &opened) == 0 && S_ISREG(opened.st_mode) && (text.empty() || text.starts_with("pid "));
}

void sign(int file) {
  const std::string text = fmt::format("pid {}\n", ::getpid());
  if (::ftruncate(file, 0) == 0) (void)!::pwrite(file, text.data(), text.size(), 0);
}

}  // namespace

Result<BatteryLock> BatteryLock::take(const std::filesystem::path& battery) {
  std::error_code error;
  std::filesystem::path path = std::filesystem::weakly_canonical(battery, error);
  if (error) path = battery;
  path += ".in-use";
  for (const auto end = Clock::now() + kPatience;;) {
    Descriptor file(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0644));
    if (file.get() < 0)
      return problem(ProblemKind::output, "{}: cannot make this file: {}", path.string(), std::strerror(errno));
    if (!is_ours(file.get()))
      return problem(ProblemKind::output,
                     "{}: expected the lock file of an ecs-emulator that uses the memory, found another file; remove "
                     "it, or give another file for the memory",
                     path.string());
    const bool locked = ::flock(file.get(), LOCK_EX | LOCK_NB) == 0;
    if (locked && still_named(file.get(), path)) {
      sign(file.get());
      return BatteryLock(std::move(file), std::move(path));
    }
    if (!locked && Clock::now() > end) {
      const std::string holder = content_of(file.get());
      return problem(ProblemKind::output,
                     "{}: another ecs-emulator ({}) uses this memory; end it, or give another file", battery.string(),
                     holder.empty() ? "unknown" : holder);
    }
    std::this_thread::sleep_for(kBetweenTries);
  }
}

BatteryLock::~BatteryLock() {
  if (file_.get() >= 0) ::unlink(path_.c_str());
}

}  // namespace ecs::emulator
