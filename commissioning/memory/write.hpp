// Bytes of the unit changed by hand: what would be written, whether that is allowed, and the write itself, checked.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "commissioning/memory/bytes.hpp"
#include "protocol/client/client.hpp"

namespace ecs::commissioning {

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

/// "45 43 53 49", cut after so many bytes with how many there are.
[[nodiscard]] std::string short_hex(ByteView bytes, std::size_t most = 16);

}  // namespace ecs::commissioning
