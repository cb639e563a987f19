// The bytes of a memory as far as they are known: pages of a unit that arrive one after the other, or a dump at once.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "commissioning/memory/dump.hpp"
#include "core/bytes.hpp"

namespace ecs::commissioning {

/// As much as one request over the link reads.
inline constexpr std::uint32_t kPageBytes = 240;

struct MemoryRegion {
  std::string name;
  Address first = 0;
  std::uint32_t size = 0;
  bool writable = false;
  [[nodiscard]] bool contains(Address address) const { return address >= first && address - first < size; }
  [[nodiscard]] Address last() const { return first + size - 1; }
};

struct Stretch {
  Address first = 0;
  std::uint32_t bytes = 0;  ///< 0: none
};

class MemoryBytes {
 public:
  /// Nothing is known of a unit with so many axis memory modules.
  [[nodiscard]] static MemoryBytes of_unit(std::size_t modules);
  /// All of a dump; what a damaged file has lost stays unknown.
  [[nodiscard]] static MemoryBytes of_dump(const MemoryDump& dump);

  [[nodiscard]] const std::vector<MemoryRegion>& regions() const { return regions_; }
  /// nullptr: no memory there.
  [[nodiscard]] const MemoryRegion* region_of(Address address) const;
  /// Nothing: unknown, or no memory there.
  [[nodiscard]] std::optional<std::uint8_t> at(Address address) const;
  /// Up to `bytes` from `first` on, as many as are known and lie in one region.
  [[nodiscard]] ByteView known(Address first, std::uint32_t bytes) const;
  void put(Address first, ByteView bytes);
  void forget();

  /// Pages without a known byte from `first` on: the first such stretch of at most `pages` pages that begins before
  /// `end`. Within one region.
  [[nodiscard]] Stretch unread(Address first, Address end, std::uint32_t pages) const;
  /// 0 … 1
  [[nodiscard]] double part_known(const MemoryRegion& region) const;
  /// Every region, unknown bytes as 0: for decoding what is there.
  [[nodiscard]] MemoryDump as_dump() const;

 private:
  struct Held {
    std::vector<std::uint8_t> bytes;
    std::vector<bool> known;  ///< by page
  };
  [[nodiscard]] std::optional<std::size_t> index_of(Address address) const;
  [[nodiscard]] bool knows(std::size_t region, std::uint32_t offset) const;
  std::vector<MemoryRegion> regions_;
  std::vector<Held> held_;
};

}  // namespace ecs::commissioning
