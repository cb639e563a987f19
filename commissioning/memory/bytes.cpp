#include "commissioning/memory/bytes.hpp"

#include <algorithm>

#include "commissioning/memory/space.hpp"

namespace ecs::commissioning {
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

}  // namespace ecs::commissioning
