// The bytes of a memory as far as they are known: pages of a unit that arrive one after the other, or a dump at once.
// What the address space allows, what is typed to be found in it or written into it, and the write itself, checked.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "commissioning/memory/dump.hpp"
#include "core/address_map.hpp"
#include "core/bytes.hpp"
#include "protocol/client/client.hpp"
#include "protocol/registers/unit_data.hpp"

namespace ecs::commissioning {

/// A usage problem unless there is at least one byte and all of them lie in the 24 bits of the address space.
[[nodiscard]] Result<void> within_space(Address address, std::size_t bytes);

/// A refused problem unless one region of the address map holds all of these bytes.
/// @param modules  axis memory modules that the unit has
[[nodiscard]] Result<void> memory_there(Address address, std::size_t bytes, std::size_t modules = kMostModules);

/// Bytes of a region in a unit with this many modules.
[[nodiscard]] std::uint32_t size_of(const Region& region, std::size_t modules);

/// Nothing but digits.
[[nodiscard]] std::optional<std::uint32_t> hexadecimal(std::string_view digits);

/// "45 43 53 49". @param between  the bytes
[[nodiscard]] std::string hex_of(ByteView bytes, std::string_view between = " ");

/// Words apart or several in one argument: "4E75", "4E 75", "0x4E 0x75".
[[nodiscard]] Result<std::vector<std::uint8_t>> hex_bytes(const std::vector<std::string>& arguments);

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
  /// Nothing is known of a unit with this many axis memory modules.
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

/// `45 43 53` bytes, `"ECSI"` text, `16:-250` and `8:`, `32:`, `64:` whole numbers of this many bits, `f:0.01` a real
/// number of 8 bytes; all as the unit stores them, high byte first. A usage problem for anything else.
[[nodiscard]] Result<std::vector<std::uint8_t>> pattern_in(std::string_view typed);
inline constexpr std::string_view kPatternHint = "bytes 45 43, text \"ECSI\", or numbers 8:255 16:-250 32:70000 f:0.01";

/// How far a search is.
struct SearchStep {
  enum class Kind { found, unread, nowhere };
  Kind kind = Kind::nowhere;
  Address address = 0;  ///< of what was found, or of the first byte that must be read to go on
};
/// From `from` to the end of its region.
[[nodiscard]] SearchStep find_pattern(const MemoryBytes& memory, ByteView pattern, Address from);

// --- bytes of the unit changed by hand
struct ByteWrite {
  Address address = 0;
  std::vector<std::uint8_t> before;
  std::vector<std::uint8_t> after;
  std::string where;  ///< region and field
  std::string when;   ///< "14:05:09"
  bool taken_back = false;
};

/// Refused where the host may not write, with the reason.
[[nodiscard]] Result<void> may_write(const MemoryBytes& memory, Address address, std::size_t bytes);
/// Refused in every mode but integration.
[[nodiscard]] Result<void> may_write_in(UnitMode mode);

/// Writes, and says so in the records of the unit's machine.
[[nodiscard]] Result<void> write_logged(protocol::UnitClient& client, const std::string& serial_number, Address address,
                                        ByteView bytes, const protocol::ProgressCallback& progress = {});
/// Looks first: unit, mode and the bytes that are there must be those that were shown. Then writes and reads back.
/// @param serial_number  of the unit that was shown
[[nodiscard]] Result<void> write_checked(protocol::UnitClient& client, const std::string& serial_number,
                                         const ByteWrite& write);

/// "45 43 53 49", cut after this many bytes with how many there are.
[[nodiscard]] std::string short_hex(ByteView bytes, std::size_t most = 16);

}  // namespace ecs::commissioning
