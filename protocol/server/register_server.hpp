// The unit's side of the register map: what a read or a write of registers means. The unit plugs in as a UnitPort.
// Does not live here: the link (server.hpp), the order of the fields (protocol/registers/unit_registers.hpp).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "protocol/registers/register_map.hpp"
#include "protocol/registers/unit_data.hpp"
#include "protocol/server/host_sessions.hpp"
#include "protocol/server/memory_window.hpp"

namespace ecs::protocol {

struct UnitClock {
  std::uint32_t starts = 0;  ///< how often the unit has started; another number: it knows no host any more
  std::uint64_t ms = 0;      ///< since the last start
};

/// What the link needs of a unit. Called from the server, between ticks.
class UnitPort {
 public:
  virtual ~UnitPort() = default;
  [[nodiscard]] virtual Identity identity() = 0;
  [[nodiscard]] virtual UnitStatus status() = 0;
  [[nodiscard]] virtual MonitorSample monitor() = 0;
  [[nodiscard]] virtual UnitClock clock() = 0;
  /// A host has armed the unit.
  virtual void host_armed() {}
  /// When, by clock(), it has switched its outputs off because no command came any more; each time is reported once.
  [[nodiscard]] virtual std::optional<std::uint64_t> take_outputs_ended() { return std::nullopt; }

  /// Fills `out`, all of it or (any error but `none`) nothing.
  [[nodiscard]] virtual UnitError read_memory(Address address, std::span<std::uint8_t> out) = 0;
  /// Asked when a window opens: mode, region, write protection.
  [[nodiscard]] virtual UnitError may_write(Address address, std::uint32_t bytes) = 0;
  [[nodiscard]] virtual UnitError write_memory(Address address, std::span<const std::uint8_t> bytes) = 0;

  /// Called once for each command; while a command is busy only with `stop`. `check_memory` never comes here. Session
  /// and sequence of the answer are filled in by the caller.
  [[nodiscard]] virtual CommandResult begin(const Command& command) = 0;
  /// State of the command that `begin` left busy.
  [[nodiscard]] virtual CommandResult progress() = 0;
};

class RegisterServer : public RegisterHandler {
 public:
  /// @param arm_code  that the unit shows; empty: no host needs one
  explicit RegisterServer(UnitPort& unit, std::string arm_code = {})
      : unit_(&unit), window_(unit), arming_(std::move(arm_code)) {}

  void arrives_on(std::uint64_t connection) override { connection_ = connection; }
  [[nodiscard]] tl::expected<Registers, ModbusException> read(std::uint16_t first, std::uint16_t count) override;
  [[nodiscard]] tl::expected<void, ModbusException> write(std::uint16_t first,
                                                          std::span<const std::uint16_t> values) override;

 private:
  [[nodiscard]] Registers answer(const Block& block);
  [[nodiscard]] tl::expected<Registers, ModbusException> memory_answer();
  [[nodiscard]] tl::expected<Registers, ModbusException> checks_answer();
  void act_on(const Block& block, std::span<const std::uint16_t> whole);
  void forget_hosts_of_another_start();
  void open_session(const SessionOpen& host);
  void open_window(const WindowOpen& window);
  [[nodiscard]] bool take_block(std::span<const std::uint16_t> block);
  void note_window(const HostSession& session, const WindowOpen& window, UnitError error);
  void take_command(const Command& command);
  [[nodiscard]] CommandResult outcome_of(const Command& command, const HostSession& session);
  [[nodiscard]] UnitError refusal_of(const Command& command, const HostSession& session) const;
  [[nodiscard]] CommandResult armed(const Command& command, const HostSession& session);
  [[nodiscard]] bool may_write(std::uint32_t session_id);
  std::uint32_t note(const SessionOpen& host, std::uint64_t at_ms, HostEvent event);
  void note_what_has_ended();
  [[nodiscard]] CommandResult begun(const Command& command);
  [[nodiscard]] CommandResult check_memory(const Command& command);
  void look_at_busy_command();
  [[nodiscard]] CommandResult result_selected();
  [[nodiscard]] SessionState session_asked();

  UnitPort* unit_;
  MemoryWindow window_;
  std::uint64_t connection_ = 0;         ///< of the request at hand
  std::uint64_t window_connection_ = 0;  ///< that has opened the window, or found it open: no other one fills it
  std::uint16_t echo_ = 0;
  Registers requests_ = Registers(kBlockWrite.end(), 0);  ///< as last written; of a session only the echo
  HostSessions sessions_;
  Arming arming_;
  EventList events_;
  std::uint32_t starts_ = 0;
  std::uint16_t stops_ = 0;
  Block asked_{};  ///< the whole block that was written last, until its answer is read
  std::optional<WindowAck> refused_window_;
  SessionState opened_;     ///< the session that was asked for last
  ResultSelect selected_;   ///< the result that was asked for last
  ResultSelect busy_;       ///< the command that the unit works on …
  bool port_busy_ = false;  ///< … if it does
  std::uint32_t busy_event_ = 0;
  SessionOpen output_host_;  ///< who closed a relay last
  EventSelect event_select_;
};

}  // namespace ecs::protocol
