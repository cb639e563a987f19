// Typed values to registers and back, for both ends; the order of the fields is written once, in unit_registers.cpp.
#pragma once

#include <cstdint>
#include <span>

#include "base/result.hpp"
#include "protocol/registers/register_handler.hpp"
#include "protocol/registers/unit_data.hpp"

namespace ecs::protocol {

// Answer blocks, the echo first; as many registers as the block of register_map.hpp. Text longer than its field is cut.
[[nodiscard]] Registers registers_of(const Identity& identity, std::uint16_t echo);
[[nodiscard]] Registers registers_of(const UnitStatus& status, std::uint16_t echo);  ///< without the pointers
[[nodiscard]] Registers pointer_registers_of(const UnitStatus& status, std::uint16_t echo);
[[nodiscard]] Registers registers_of(const ActiveMap& map, std::uint16_t echo);
[[nodiscard]] Registers registers_of(const MonitorSample& sample, std::uint16_t echo);
[[nodiscard]] Registers registers_of(const CommandResult& result, std::uint16_t echo);
[[nodiscard]] Registers registers_of(const WindowAck& ack, std::uint16_t echo);
[[nodiscard]] Registers registers_of(const SessionState& state, std::uint16_t echo);
[[nodiscard]] Registers registers_of(const EventPage& page, std::uint16_t echo);

// Request blocks, the echo first; those with a check end with it.
[[nodiscard]] Registers registers_of(const Command& command, std::uint16_t echo);
[[nodiscard]] Registers registers_of(const WindowOpen& window, std::uint16_t echo);
[[nodiscard]] Registers registers_of(const CheckSelect& select, std::uint16_t echo);
[[nodiscard]] Registers registers_of(const ReadSelect& select, std::uint16_t echo);
[[nodiscard]] Registers registers_of(const ResultSelect& select, std::uint16_t echo);
[[nodiscard]] Registers registers_of(const SessionOpen& open, std::uint16_t echo);
[[nodiscard]] Registers registers_of(const EventSelect& select, std::uint16_t echo);

/// The CRC-32 over the registers between the echo and the last two (high byte first) is what these two hold.
[[nodiscard]] bool check_agrees(std::span<const std::uint16_t> block);

// Back, from a whole block. A number that its type does not know, a number that is not finite or a text that is not
// printable is a `link` problem that names the field.
[[nodiscard]] Result<Identity> identity_in(std::span<const std::uint16_t> block);
[[nodiscard]] Result<UnitStatus> status_in(std::span<const std::uint16_t> block);
[[nodiscard]] Result<void> take_pointers(std::span<const std::uint16_t> block, UnitStatus& status);
[[nodiscard]] Result<ActiveMap> active_map_in(std::span<const std::uint16_t> block);
[[nodiscard]] Result<MonitorSample> monitor_in(std::span<const std::uint16_t> block);
[[nodiscard]] Result<CommandResult> command_result_in(std::span<const std::uint16_t> block);
[[nodiscard]] Result<WindowAck> window_ack_in(std::span<const std::uint16_t> block);
[[nodiscard]] Result<Command> command_in(std::span<const std::uint16_t> block);
[[nodiscard]] Result<WindowOpen> window_open_in(std::span<const std::uint16_t> block);
[[nodiscard]] Result<CheckSelect> check_select_in(std::span<const std::uint16_t> block);
[[nodiscard]] Result<ReadSelect> read_select_in(std::span<const std::uint16_t> block);
[[nodiscard]] Result<ResultSelect> result_select_in(std::span<const std::uint16_t> block);
[[nodiscard]] Result<SessionOpen> session_open_in(std::span<const std::uint16_t> block);
[[nodiscard]] Result<SessionState> session_state_in(std::span<const std::uint16_t> block);
[[nodiscard]] Result<EventSelect> event_select_in(std::span<const std::uint16_t> block);
[[nodiscard]] Result<EventPage> event_page_in(std::span<const std::uint16_t> block);

/// Bytes two a register, the first in the high byte; an odd last byte leaves the low byte 0.
[[nodiscard]] Registers packed(std::span<const std::uint8_t> bytes);
/// @pre registers.size() * 2 >= bytes
[[nodiscard]] std::vector<std::uint8_t> unpacked(std::span<const std::uint16_t> registers, std::size_t bytes);

}  // namespace ecs::protocol
