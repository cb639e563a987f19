#include "commissioning/memory/bytes.hpp"

#include <algorithm>
#include <charconv>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/json.hpp"
#include "base/text.hpp"
#include "commissioning/session/records.hpp"
#include "core/fault.hpp"
#include "core/mode_word.hpp"

namespace ecs::commissioning {
namespace {

constexpr std::uint32_t kAddressSpace = 0x1000000;  ///< 24 bits

/// "4E75" or "0x4E75"
Result<void> take_hex(std::string_view word, std::vector<std::uint8_t>& bytes) {
  const std::string_view whole = word;
  if (word.starts_with("0x") || word.starts_with("0X")) word.remove_prefix(2);
  if (word.size() % 2 != 0)
    return problem(ProblemKind::usage, "expected bytes as pairs of hexadecimal digits, got \"{}\"", whole);
  for (std::size_t i = 0; i < word.size(); i += 2) {
    const auto byte = hexadecimal(word.substr(i, 2));
    if (!byte) return problem(ProblemKind::usage, "expected hexadecimal digits, got \"{}\"", whole);
    bytes.push_back(static_cast<std::uint8_t>(*byte));
  }
  return {};
}

}  // namespace

std::optional<std::uint32_t> hexadecimal(std::string_view digits) {
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
  if (error != std::errc{} || end != digits.data() + digits.size()) return std::nullopt;
  return value;
}

std::string hex_of(ByteView bytes, std::string_view between) {
  return fmt::format("{:02X}", fmt::join(bytes, between));
}

std::uint32_t size_of(const Region& region, std::size_t modules) {
  const bool is_bank = region.first == kBankA.first || region.first == kBankB.first;
  return is_bank ? bank_bytes(static_cast<std::uint8_t>(std::min(modules, kMostModules))) : region.size;
}

Result<void> within_space(Address address, std::size_t bytes) {
  if (bytes == 0) return problem(ProblemKind::usage, "expected at least 1 byte, got 0");
  if (address < kAddressSpace && bytes <= kAddressSpace - address) return {};
  return problem(ProblemKind::usage, "{} bytes from {}: the unit's memory lies below 0x1000000", bytes,
                 hex_address(address));
}

Result<void> memory_there(Address address, std::size_t bytes, std::size_t modules) {
  std::string map;
  for (const Region& region : kRegions) {
    const std::uint32_t size = size_of(region, modules);
    if (address >= region.first && address - region.first + bytes <= size) return {};
    map += fmt::format("{}{} {} to {}", map.empty() ? "" : ", ", region.name, hex_address(region.first),
                       hex_address(region.first + size - 1));
  }
  return problem(ProblemKind::refused, "{} to {}: the unit does not have all of this memory; it has {}",
                 hex_address(address), hex_address(address + static_cast<Address>(bytes) - 1), map);
}

Result<std::vector<std::uint8_t>> hex_bytes(const std::vector<std::string>& arguments) {
  std::vector<std::uint8_t> bytes;
  for (const std::string& argument : arguments)
    for (const std::string_view word : split(argument, ' ')) ECS_DO(take_hex(trimmed(word), bytes));
  return bytes;
}

namespace {

std::size_t pages_of(std::uint32_t bytes) { return (bytes + kPageBytes - 1) / kPageBytes; }

bool writable(const DumpRegion& region) {
  return std::any_of(kRegions.begin(), kRegions.end(),
                     [&](const Region& known) { return known.first == region.address && known.writable; });
}

}  // namespace

MemoryBytes MemoryBytes::of_unit(std::size_t modules) {
  MemoryBytes memory;
  for (const Region& region : kRegions) {
    const std::uint32_t size = size_of(region, modules);
    memory.regions_.push_back({std::string(region.name), region.first, size, region.writable});
    memory.held_.push_back({std::vector<std::uint8_t>(size), std::vector<bool>(pages_of(size))});
  }
  return memory;
}

MemoryBytes MemoryBytes::of_dump(const MemoryDump& dump) {
  MemoryBytes memory;
  for (const DumpRegion& region : dump.regions) {
    const auto size = static_cast<std::uint32_t>(region.bytes.size());
    if (size == 0) continue;
    memory.regions_.push_back({region.name, region.address, size, writable(region)});
    memory.held_.push_back({region.bytes, std::vector<bool>(pages_of(size), true)});
  }
  return memory;
}

std::optional<std::size_t> MemoryBytes::index_of(Address address) const {
  for (std::size_t r = 0; r < regions_.size(); ++r)
    if (regions_[r].contains(address)) return r;
  return std::nullopt;
}

const MemoryRegion* MemoryBytes::region_of(Address address) const {
  const auto index = index_of(address);
  return index ? &regions_[*index] : nullptr;
}

bool MemoryBytes::knows(std::size_t region, std::uint32_t offset) const {
  return held_[region].known[offset / kPageBytes];
}

std::optional<std::uint8_t> MemoryBytes::at(Address address) const {
  const auto r = index_of(address);
  if (!r || !knows(*r, address - regions_[*r].first)) return std::nullopt;
  return held_[*r].bytes[address - regions_[*r].first];
}

ByteView MemoryBytes::known(Address first, std::uint32_t bytes) const {
  const auto r = index_of(first);
  if (!r) return {};
  const std::uint32_t from = first - regions_[*r].first;
  const std::uint32_t end = std::min(regions_[*r].size, from + bytes);
  std::uint32_t to = from;
  while (to < end && knows(*r, to)) to = std::min(end, (to / kPageBytes + 1) * kPageBytes);
  return ByteView(held_[*r].bytes).subspan(from, to - from);
}

void MemoryBytes::put(Address first, ByteView bytes) {
  const auto r = index_of(first);
  if (!r) return;
  Held& held = held_[*r];
  const std::uint32_t from = first - regions_[*r].first;
  const auto count = static_cast<std::uint32_t>(std::min<std::size_t>(bytes.size(), regions_[*r].size - from));
  std::copy_n(bytes.begin(), count, held.bytes.begin() + from);
  // a page counts as known when it came whole
  for (std::uint32_t page = (from + kPageBytes - 1) / kPageBytes; page < held.known.size(); ++page) {
    const std::uint32_t end = std::min(regions_[*r].size, (page + 1) * kPageBytes);
    if (end > from + count) break;
    held.known[page] = true;
  }
}

void MemoryBytes::forget() {
  for (Held& held : held_) held.known.assign(held.known.size(), false);
}

Stretch MemoryBytes::unread(Address first, Address end, std::uint32_t pages) const {
  const auto r = index_of(first);
  if (!r) return {};
  const MemoryRegion& region = regions_[*r];
  std::uint32_t page = (first - region.first) / kPageBytes;
  const std::uint32_t last = (std::min(end - region.first, region.size) + kPageBytes - 1) / kPageBytes;
  while (page < last && held_[*r].known[page]) ++page;
  std::uint32_t to = page;
  while (to < last && to - page < pages && !held_[*r].known[to]) ++to;
  return {region.first + page * kPageBytes,
          std::min(region.size, to * kPageBytes) - std::min(region.size, page * kPageBytes)};
}

double MemoryBytes::part_known(const MemoryRegion& region) const {
  const auto r = index_of(region.first);
  if (!r || held_[*r].known.empty()) return 1.0;
  const auto known = std::count(held_[*r].known.begin(), held_[*r].known.end(), true);
  return static_cast<double>(known) / static_cast<double>(held_[*r].known.size());
}

MemoryDump MemoryBytes::as_dump() const {
  MemoryDump dump;
  for (std::size_t r = 0; r < regions_.size(); ++r) {
    std::vector<std::uint8_t> bytes = held_[r].bytes;
    for (std::uint32_t page = 0; page < held_[r].known.size(); ++page)
      if (!held_[r].known[page])
        std::fill_n(bytes.begin() + page * kPageBytes, std::min(kPageBytes, regions_[r].size - page * kPageBytes),
                    std::uint8_t{0});
    dump.regions.push_back({regions_[r].name, regions_[r].first, std::move(bytes), regions_[r].size, true});
  }
  return dump;
}

namespace {

using Pattern = std::vector<std::uint8_t>;

Result<Pattern> whole_pattern(std::string_view digits, std::size_t bytes) {
  const auto value = integer_in(digits);
  const auto bits = static_cast<int>(8 * bytes);
  const bool fits = value && (bytes == 8 || (*value >= -(1ll << (bits - 1)) && *value < (1ll << bits)));
  if (!fits)
    return problem(ProblemKind::usage, "expected a whole number of {} bits after {}:, got \"{}\"", bits, bits, digits);
  Pattern pattern(8);
  store_big(Bytes(pattern), 0, static_cast<std::uint64_t>(*value));
  return Pattern(pattern.end() - static_cast<std::ptrdiff_t>(bytes), pattern.end());
}

Result<Pattern> real_pattern(std::string_view digits) {
  const auto value = number_in(digits);
  if (!value) return problem(ProblemKind::usage, "expected a number after f:, got \"{}\"", digits);
  Pattern pattern(8);
  store_double(Bytes(pattern), 0, *value);
  return pattern;
}

}  // namespace

Result<std::vector<std::uint8_t>> pattern_in(std::string_view typed) {
  const std::string_view text = trimmed(typed);
  if (text.starts_with('"')) {
    const std::string_view inner = text.substr(1, text.ends_with('"') && text.size() > 1 ? text.size() - 2 : text.npos);
    if (inner.empty()) return problem(ProblemKind::usage, "expected text between the quotes, got none");
    return Pattern(inner.begin(), inner.end());
  }
  if (text.starts_with("f:")) return real_pattern(text.substr(2));
  for (const auto& [sign, bytes] : {std::pair{"8:", 1u}, {"16:", 2u}, {"32:", 4u}, {"64:", 8u}})
    if (text.starts_with(sign)) return whole_pattern(text.substr(text.find(':') + 1), bytes);
  auto bytes = hex_bytes({std::string(text)});
  if (!bytes) return problem(ProblemKind::usage, "{}; give {}", bytes.error().message, kPatternHint);
  if (bytes->empty()) return problem(ProblemKind::usage, "expected bytes, got none; give {}", kPatternHint);
  return bytes;
}

SearchStep find_pattern(const MemoryBytes& memory, ByteView pattern, Address from) {
  const MemoryRegion* region = memory.region_of(from);
  if (region == nullptr || pattern.empty()) return {};
  const std::uint32_t left = region->size - (from - region->first);
  const ByteView known = memory.known(from, left);
  const auto found = std::search(known.begin(), known.end(), pattern.begin(), pattern.end());
  if (found != known.end()) return {SearchStep::Kind::found, from + static_cast<Address>(found - known.begin())};
  if (known.size() < left) return {SearchStep::Kind::unread, from + static_cast<Address>(known.size())};
  return {};
}

// --- bytes of the unit changed by hand
namespace {

/// Why the host is not allowed to write there, and what does instead.
std::string_view reason_of(const MemoryRegion& region) {
  if (region.first == kEprom.first) return "it contains the unit's program and cannot be changed over the link";
  if (region.first == kCommitRecords.first)
    return "only the unit writes there, when it accepts a map; use `map send` or `memory load`";
  if (in_axis_memory(region.first))
    return "parameters and maps are written only as a whole, to the inactive bank, by `params send`, `map send` or "
           "`memory load`. Single bytes of either bank cannot be written";
  return "the host is not allowed to write there";
}

/// Of bytes in the unit's memory; where writing failed perhaps a part of them is there.
void record_write(const std::string& serial_number, Address address, ByteView bytes, const Result<void>& written) {
  const std::string place = hex_address(address);
  Json content{{"direction", "to the unit"}, {"address", place}, {"bytes", bytes.size()}};
  if (!written) content["problem"] = to_text(written.error());
  record({.kind = "memory write",
          .serial_number = serial_number,
          .summary = written ? fmt::format("{} bytes written from {}", bytes.size(), place)
                             : fmt::format("not confirmed: {} bytes from {} on: {}", bytes.size(), place,
                                           to_text(written.error())),
          .content = one_line(content),
          .files = {{"memory", place, std::make_shared<const std::string>(bytes.begin(), bytes.end())}}});
}

}  // namespace

std::string short_hex(ByteView bytes, std::size_t most) {
  if (bytes.size() <= most) return hex_of(bytes);
  return fmt::format("{} ... ({} bytes)", hex_of(bytes.first(most)), bytes.size());
}

Result<void> may_write(const MemoryBytes& memory, Address address, std::size_t bytes) {
  const MemoryRegion* region = memory.region_of(address);
  if (region == nullptr) return problem(ProblemKind::refused, "the unit has no memory at {}", hex_address(address));
  if (!region->writable) return problem(ProblemKind::refused, "{} is protected: {}", region->name, reason_of(*region));
  if (address - region->first + bytes > region->size)
    return problem(ProblemKind::refused, "{} bytes from {} go beyond {}, which ends at {}", bytes, hex_address(address),
                   region->name, hex_address(region->last()));
  return {};
}

Result<void> may_write_in(UnitMode mode) {
  if (mode == UnitMode::integration) return {};
  return problem(ProblemKind::refused,
                 "the unit is {}: memory can be written in integration mode only; "
                 "use ECS UTILITY or `ecs utility mode integrate` first",
                 word_of(mode));
}

Result<void> write_logged(protocol::UnitClient& client, const std::string& serial_number, Address address,
                          ByteView bytes, const protocol::ProgressCallback& progress) {
  auto written = client.write_memory(address, bytes, progress);
  const bool may_be_part = written || written.error().kind == ProblemKind::link;
  if (may_be_part) record_write(serial_number, address, bytes, written);
  return written;
}

Result<void> write_checked(protocol::UnitClient& client, const std::string& serial_number, const ByteWrite& write) {
  ECS_TRY(identity, client.identity());
  if (identity.serial_number != serial_number)
    return problem(ProblemKind::refused, "unit {} answers now, but the bytes were read from unit {}; not written",
                   identity.serial_number, serial_number);
  ECS_TRY(status, client.status());
  if (const auto may = may_write_in(status.mode); !may) return may;
  ECS_TRY(present, client.read_memory(write.address, write.after.size()));
  if (present != write.before)
    return problem(ProblemKind::refused, "{} now contains {}, not the bytes shown; not written. Check again",
                   hex_address(write.address), short_hex(present));
  if (auto written = write_logged(client, serial_number, write.address, write.after); !written) return written;
  ECS_TRY(back, client.read_memory(write.address, write.after.size()));
  if (back == write.after) return {};
  return problem(ProblemKind::link, "{} contains {} after writing {}: run the RAM test", hex_address(write.address),
                 short_hex(back), short_hex(write.after));
}

}  // namespace ecs::commissioning
