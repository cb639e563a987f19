// The address space of the unit's 68000 (24 bits, big-endian), as host and unit see it. Sizes in bytes.
// Axis memory holds two banks of one map each; a commit record says which bank is the active one. Where a user's
// program finds the machine, and leaves its registers (docs/unit.md). The RAM test of power-up.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "core/parameters.hpp"
#include "core/thermal.hpp"
#include "core/tools.hpp"

namespace ecs {

using Address = std::uint32_t;

/// Room for one map of 32,000 two-byte values, and 9,728 bytes for prefix, parameters, directory and header.
inline constexpr std::uint32_t kModuleBankBytes = 0x12000;
inline constexpr std::uint32_t kBankBytes = static_cast<std::uint32_t>(kMostModules) * kModuleBankBytes;

struct Region {
  Address first = 0;
  std::uint32_t size = 0;
  bool writable = false;  ///< by MEMORY WRITE in integration mode
  std::string_view name;
  [[nodiscard]] constexpr bool contains(Address address) const { return address >= first && address - first < size; }
};

inline constexpr Region kEprom{0x000000, 0x10000, false, "EPROM"};
inline constexpr Region kSystemRam{0x040000, 0x10000, true, "system RAM"};
inline constexpr Region kCommitRecords{0x0F0000, 0x80, false, "commit records"};
inline constexpr Region kBankA{0x100000, kBankBytes, false, "axis memory bank A"};  ///< written by staging only
inline constexpr Region kBankB{0x200000, kBankBytes, false, "axis memory bank B"};
/// What the thermal rows have come to, two slots (thermal.hpp); the unit alone writes it.
inline constexpr Region kThermalRecord{0x0F1000, 2 * kStoredThermalBytes, false, "thermal record"};
/// The table of tools, two slots (tools.hpp); the unit writes it at a command.
inline constexpr Region kToolRecord{0x0F2000, 2 * kToolTableBytes, false, "tool table"};
inline constexpr std::array<Region, 7> kRegions{kEprom,      kSystemRam, kCommitRecords, kThermalRecord,
                                                kToolRecord, kBankA,     kBankB};

[[nodiscard]] constexpr bool in_axis_memory(Address address) {
  return kBankA.contains(address) || kBankB.contains(address);
}

/// Bytes of one bank that a unit with `modules` axis memory modules has.
[[nodiscard]] constexpr std::uint32_t bank_bytes(std::uint8_t modules) { return modules * kModuleBankBytes; }

inline constexpr Region kMachineInputs{0x0E0000, 0x1000, false, "machine inputs"};  ///< for user software alone
inline constexpr Address kUserRegisters = kSystemRam.first;  ///< D0 … D7, A0 … A7, PC, SR, 32 bits each
inline constexpr std::uint32_t kUserRegisterBytes = 72;
inline constexpr Address kUserPrograms = kSystemRam.first + 0x1000;  ///< programs begin here or above

/// First address that does not hold what is written to it; nothing if all do.
/// @param memory  has `uint8_t read(Address)` and `void write(Address, uint8_t)`, unprotected while the test runs
template <class Memory>
[[nodiscard]] std::optional<Address> failing_address(Memory& memory, Address first, std::uint32_t size) {
  for (Address address = first; address - first < size; ++address) {
    const std::uint8_t content = memory.read(address);
    bool holds = true;
    for (const std::uint8_t pattern : {std::uint8_t{0x55}, std::uint8_t{0xAA}}) {
      memory.write(address, pattern);
      holds = holds && memory.read(address) == pattern;
    }
    memory.write(address, content);
    if (!holds || memory.read(address) != content) return address;
  }
  return std::nullopt;
}

}  // namespace ecs
