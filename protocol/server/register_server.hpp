// The unit's side of the register map: what a read or a write of registers means. The unit plugs in as a UnitPort.
// Does not live here: the link (server.hpp), the order of the fields (protocol/registers/unit_registers.hpp).
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "protocol/registers/register_handler.hpp"
#include "protocol/registers/unit_data.hpp"
#include "protocol/server/memory_window.hpp"

namespace ecs::protocol {

/// What the link needs of a unit. Called from the server, between ticks.
class UnitPort {
 public:
  virtual ~UnitPort() = default;
  [[nodiscard]] virtual Identity identity() = 0;
  [[nodiscard]] virtual UnitStatus status() = 0;
  [[nodiscard]] virtual MonitorSample monitor() = 0;

  /// Fills `out`, all of it or (any error but `none`) nothing.
  [[nodiscard]] virtual UnitError read_memory(Address address, std::span<std::uint8_t> out) = 0;
  /// Asked when a window opens: mode, region, write protection.
  [[nodiscard]] virtual UnitError may_write(Address address, std::uint32_t bytes) = 0;
  [[nodiscard]] virtual UnitError write_memory(Address address, std::span<const std::uint8_t> bytes) = 0;

  /// Called once for each new sequence number; while a command is busy only with `stop`. `check_memory` never comes
  /// here. The answer's `sequence` is filled in by the caller.
  [[nodiscard]] virtual CommandResult begin(const Command& command) = 0;
  /// State of the command that `begin` left busy.
  [[nodiscard]] virtual CommandResult progress() = 0;
};

/// Commands whose late repeat does nothing.
inline constexpr std::size_t kRemembered = 32;

class RegisterServer : public RegisterHandler {
 public:
  explicit RegisterServer(UnitPort& unit) : unit_(&unit), window_(unit) {}

  [[nodiscard]] tl::expected<Registers, ModbusException> read(std::uint16_t first, std::uint16_t count) override;
  [[nodiscard]] tl::expected<void, ModbusException> write(std::uint16_t first,
                                                          std::span<const std::uint16_t> values) override;

 private:
  [[nodiscard]] Registers answer(const Block& block);
  [[nodiscard]] tl::expected<Registers, ModbusException> memory_answer();
  [[nodiscard]] tl::expected<Registers, ModbusException> checks_answer();
  void act_on(const Block& block);
  [[nodiscard]] const CommandResult& result_now();
  void take_command(const Command& command);
  [[nodiscard]] CommandResult begun(const Command& command);
  [[nodiscard]] CommandResult check_memory(const Command& command);

  UnitPort* unit_;
  MemoryWindow window_;
  std::uint16_t echo_ = 0;
  Registers requests_ = Registers(kBlockWrite.end(), 0);  ///< as last written
  CommandResult result_;
  std::array<std::uint16_t, kRemembered> sequences_{};  ///< of the commands taken last, so that none is taken twice
  std::size_t next_sequence_ = 0;
  bool port_busy_ = false;           ///< the unit works on a command …
  std::uint16_t busy_sequence_ = 0;  ///< … of this number
};

}  // namespace ecs::protocol
