// The unit's side of the register map: what a read or a write of registers means, and of a bulk write: numbered blocks
// of one stretch of memory, in any order, each checked on its own. The unit plugs in as a UnitPort. Does not live here:
// the link (server.hpp), the order of the fields (protocol/registers/unit_registers.hpp).
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "core/block_code.hpp"
#include "protocol/registers/register_map.hpp"
#include "protocol/registers/unit_data.hpp"
#include "protocol/server/host_sessions.hpp"

namespace ecs::protocol {

class UnitPort;

/// Assembles blocks into the memory of a unit. Blocks may come twice or out of order; one that is not intact, not of
/// this window or beyond its end is not taken. Memory is only written inside the stretch that the unit agreed to.
class MemoryWindow {
 public:
  explicit MemoryWindow(UnitPort& unit) : unit_(&unit) {}

  /// From now on axis memory is written only under this token; the window that is open ends, acknowledged as
  /// `token_expired`. 0: nothing is staged.
  void stage_under(std::uint32_t token);
  [[nodiscard]] std::uint32_t token() const { return token_; }
  [[nodiscard]] std::uint32_t session() const { return window_.asker.session; }
  [[nodiscard]] const WindowOpen& window() const { return window_; }
  [[nodiscard]] UnitError error() const { return error_; }

  /// Starts a window; the number that is already open changes nothing. A stretch that may not be written, or not under
  /// this token, leaves the window closed with the reason in ack().error.
  /// @return false: it was open, or refused, already
  bool open(const WindowOpen& window);
  /// The window that was opened last is closed for this reason.
  void refuse(UnitError why);

  /// One frame: tag, number, keyed check, payload. In a coded window it brings several blocks, taken all or not at all,
  /// and none before those below them. False: not taken. A block with the window's tag and another check than the key
  /// gives closes the window, acknowledged as `check_mismatch`; what it has brought stays in memory.
  [[nodiscard]] bool take(std::span<const std::uint16_t> registers, const std::optional<Secret>& key);

  [[nodiscard]] WindowAck ack() const;

 private:
  [[nodiscard]] bool take_coded(std::uint16_t number, std::span<const std::uint8_t> code);
  [[nodiscard]] bool put(std::size_t offset, std::span<const std::uint8_t> bytes);
  [[nodiscard]] std::uint64_t all_blocks() const;

  UnitPort* unit_;
  std::uint32_t token_ = 0;  ///< of the staging; 0: none
  WindowOpen window_;
  UnitError error_ = UnitError::none;
  std::uint64_t received_ = 0;
  std::array<std::uint8_t, block_code::kHistoryBytes + kCodedBlocksInFrame * kCodedBlockBytes> decoded_{};
};

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
  [[nodiscard]] virtual LiveInputs live_inputs() { return {}; }
  [[nodiscard]] virtual ControlLines control_lines() { return {}; }
  [[nodiscard]] virtual RotarySample rotary() { return {}; }
  [[nodiscard]] virtual UnitClock clock() = 0;
  /// A host has armed the unit.
  virtual void host_armed() {}
  /// After too many wrong codes: what the unit shows from now on.
  virtual void show_code(const std::string& /*code*/) {}
  /// SHA-256 of the active image as memory holds it; zeros: there is none.
  [[nodiscard]] virtual ImageDigest active_digest() = 0;
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
  /// @param code  that the unit shows
  explicit RegisterServer(UnitPort& unit, ArmCode code = {}) : unit_(&unit), window_(unit), arming_(std::move(code)) {}

  void arrives_on(std::uint64_t connection, const std::string& origin) override {
    connection_ = connection;
    origin_ = origin;
  }
  [[nodiscard]] Speaks speaks_on(std::uint64_t connection) override;
  [[nodiscard]] tl::expected<Registers, ModbusException> read(std::uint16_t first, std::uint16_t count) override;
  [[nodiscard]] tl::expected<void, ModbusException> write(std::uint16_t first,
                                                          std::span<const std::uint16_t> values) override;

 private:
  [[nodiscard]] Registers answer(const Block& block);
  [[nodiscard]] tl::expected<Registers, ModbusException> memory_answer(const Asker& asker);
  [[nodiscard]] tl::expected<Registers, ModbusException> checks_answer(const Asker& asker);
  void seal(Registers& answer, const Block& block, const Asker& asker);
  [[nodiscard]] std::optional<Secret> key_of(std::uint32_t session_id);
  void note_speaker(std::uint32_t session);
  void act_on(const Block& block, std::span<const std::uint16_t> whole);
  void forget_hosts_of_another_start();
  void open_session(const SessionOpen& host);
  [[nodiscard]] std::uint32_t at_zero_of_clock(std::uint32_t unix_time_s) const;
  void open_window(const WindowOpen& window, std::span<const std::uint16_t> whole);
  [[nodiscard]] UnitError refusal_of(const WindowOpen& window, const HostSession* session,
                                     std::span<const std::uint16_t> whole);
  [[nodiscard]] bool take_block(std::span<const std::uint16_t> block);
  void note_window(const HostSession& session, const WindowOpen& window, UnitError error);
  void take_command(const Command& command, std::span<const std::uint16_t> whole);
  [[nodiscard]] CommandResult outcome_of(const Command& command, const HostSession& session);
  [[nodiscard]] UnitError refusal_of(const Command& command, const HostSession& session);
  void begin_arming(const ArmShare& arm);
  void confirm_arming(const ArmConfirm& arm);
  void note_arming(const HostSession& session, UnitError error, std::uint32_t seconds);
  std::uint32_t note(const SessionOpen& host, std::uint64_t at_ms, HostEvent event, bool armed);
  void note_what_has_ended();
  [[nodiscard]] CommandResult begun(const Command& command);
  [[nodiscard]] CommandResult check_memory(const Command& command);
  void look_at_busy_command();
  [[nodiscard]] CommandResult result_selected();
  [[nodiscard]] SessionState session_asked();

  UnitPort* unit_;
  MemoryWindow window_;
  std::uint64_t connection_ = 0;  ///< of the request at hand
  std::string origin_;
  struct Speaker {
    std::uint64_t connection = 0;
    std::uint32_t session = 0;       ///< of its last command
    std::uint64_t commanded_ms = 0;  ///< when that came
  };
  std::deque<Speaker> speakers_;         ///< kSessions that gave a command, in the order of their last one
  std::uint64_t window_connection_ = 0;  ///< that has opened the window, or found it open: no other one fills it
  std::uint16_t echo_ = 0;
  Registers requests_ = Registers(kBlockWrite.end(), 0);  ///< as last written; of a session only the echo
  HostSessions sessions_;
  Arming arming_;
  EventList events_;
  std::uint32_t starts_ = 0;
  std::uint16_t stops_ = 0;
  Block asked_{};  ///< the whole block that was written last, until its answer is read
  Asker asker_;    ///< who wrote it
  CheckSelect check_select_;
  ArmAnswer arming_answer_;
  std::optional<CommandResult> free_result_;  ///< of a stop without a key in the session of an armed host
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
