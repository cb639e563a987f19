// The unit as the host sees it: typed reads, commands with their completion, memory in bulk, a map sent whole or not at
// all. Does not live here: retries and time-outs (link.hpp), screens and files (app/).
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/result.hpp"
#include "protocol/client/block_frames.hpp"
#include "protocol/client/link.hpp"
#include "protocol/registers/unit_data.hpp"

namespace ecs::protocol {

/// Part of the message of a command that ended early where the unit may still carry it out: its stop was not answered.
inline constexpr std::string_view kStopNotReceived = "the request to stop did not reach the unit";

/// Of an answer to a host that is armed.
inline constexpr std::string_view kNotSealed =
    "the keyed check of the answer is missing or wrong: the time for which this host was armed has ended, the unit was "
    "restarted, or another program answers in place of the unit; arm the unit again";

struct Progress {
  std::size_t bytes_done = 0;
  std::size_t bytes_total = 0;
  double seconds_left = 0.0;  ///< from the mean speed so far
};
using ProgressCallback = std::function<void(const Progress&)>;
using CommandCallback = std::function<void(const CommandResult&)>;  ///< while a command is busy

/// Where the bank of a map begins. @pre the unit holds one
[[nodiscard]] Address address_of(Bank bank);

struct UploadReport {
  std::size_t bytes = 0;              ///< of the image
  std::size_t bytes_sent = 0;         ///< of these, what the unit did not hold yet
  std::uint32_t commit_sequence = 0;  ///< of the map that is active now
  bool already_held = false;  ///< by an answer with its keyed check the image was active before: nothing was sent
};

/// What of an image counts as held by the unit and is not sent.
enum class Held {
  by_checks,  ///< what has the same SHA-256 (the image) or keyed check (a piece of it)
  nothing,    ///< the whole image is sent
};

/// Where the programs of a user on a computer keep the secrets that they share with units.
class SecretStore {
 public:
  virtual ~SecretStore() = default;
  /// Shared with the unit of that serial number; nothing: none is kept.
  [[nodiscard]] virtual std::optional<Secret> secret_of(const std::string& serial_number) = 0;
  virtual void keep(const std::string& serial_number, const Secret& secret) = 0;
};

/// Who asks, for the unit's records.
struct Host {
  std::uint64_t key = 0;  ///< one number for all programs of a user on a computer; 0: one by chance
  std::string name;       ///< up to 16 characters
  std::string arm_code;   ///< that the unit shows: it is armed as soon as something needs it; empty: none is known
  std::shared_ptr<SecretStore> secrets{};  ///< null: what this program arms, it alone may use
};

/// Problems: kind `link` for the link, a failed command and a unit that sends nonsense; kind `refused` for what the
/// unit declines to do, with its reason. Every call can be cancelled between two frames by the link's flag.
class UnitClient {
 public:
  /// Opens the link and checks that a unit with this protocol version answers.
  [[nodiscard]] static Result<UnitClient> connect(const LinkAddress& address, const LinkOptions& options = {},
                                                  const Host& host = {});
  explicit UnitClient(Link link, const Host& host = {});

  [[nodiscard]] Link& link() { return link_; }
  [[nodiscard]] const Link& link() const { return link_; }

  [[nodiscard]] Result<Identity> identity();
  [[nodiscard]] Result<UnitStatus> status();  ///< two reads: state, then pointers
  /// Which map the unit that answered first holds; a problem where another one answers.
  [[nodiscard]] Result<ActiveMap> active_map();
  [[nodiscard]] Result<MonitorSample> monitor();
  [[nodiscard]] Result<LiveInputs> live_inputs();
  [[nodiscard]] Result<ControlLines> control_lines();
  /// @param identity  of the unit: one whose firmware does not show rotary axes is not asked, and has none
  [[nodiscard]] Result<RotarySample> rotary(const Identity& identity);
  struct ToolRecord {
    ToolTable table;
    std::size_t damaged_slots = 0;  ///< of the two that keep it: with one the table is the older one, with both empty
  };
  [[nodiscard]] Result<ToolRecord> tool_record();
  /// What hosts did to the unit, or tried: the newest `most` as the blocks they came in, the oldest first.
  [[nodiscard]] Result<std::vector<Registers>> event_blocks(std::size_t most);

  /// From now on this code is shown where something needs an armed host.
  void know_code(std::string code) { arm_code_ = std::move(code); }
  [[nodiscard]] bool knows_code() const { return !arm_code_.empty(); }
  /// Since this was last asked, the unit has refused something because this host is not armed.
  [[nodiscard]] bool take_wants_code() { return std::exchange(wants_code_, false); }
  /// How long this host is armed yet, s; 0: it is not.
  [[nodiscard]] Result<std::uint32_t> armed_s();
  /// Arms the unit for this host, all its programs included, by an exchange of keys: neither the code nor anything it
  /// could be found from travels. A wrong code is `refused`; a unit that does not know its code is a `link` problem.
  [[nodiscard]] Result<void> arm(const std::string& code, std::uint16_t minutes = kUsualArmed_min);
  [[nodiscard]] Result<void> disarm();

  /// Gives a command in the session of this client, which is opened where there is none, and waits until it is done.
  /// One that acts at once carries the unit's clock as it was just before; if it comes too late all the same, it is
  /// given again within kMostAge_ms of the host's clock, then it is a problem.
  /// @param limit  how long it may stay busy; `stop` is sent when it is reached, or when the flag cancels
  [[nodiscard]] Result<CommandResult> run(Command command, std::chrono::milliseconds limit,
                                          const CommandCallback& busy = {});

  [[nodiscard]] Result<void> enter_integration();
  [[nodiscard]] Result<void> enter_compensation();
  [[nodiscard]] Result<void> set_axis_position(Axis axis, double position_mm);
  [[nodiscard]] Result<void> output_compensation(Axis axis, double output_um, bool relay_on);
  /// @param input  0 … 15 a temperature [degC], 16 the load [kg]; one without a wire
  [[nodiscard]] Result<void> set_input(std::uint16_t input, double value);
  [[nodiscard]] Result<void> select_tool(std::uint16_t number);
  [[nodiscard]] Result<void> set_tool(const Tool& tool);
  [[nodiscard]] Result<void> remove_tool(std::uint16_t number);
  /// The table in force is whole at every moment: the old one, or this one. Refused by a unit that cannot do that.
  /// @param tools  at most kMostTools, each number once
  [[nodiscard]] Result<void> replace_tools(std::span<const Tool> tools);
  /// @param um_per_m  C0Y, B0Z, A0Z
  [[nodiscard]] Result<void> try_squareness(const Vector3& um_per_m);
  [[nodiscard]] Result<void> output_off();
  /// What is written to axis memory, committed and abandoned afterwards belongs to this staging; the unit refuses it
  /// as soon as another one has begun or ended.
  [[nodiscard]] Result<Address> begin_staging(StagingFrom from);
  [[nodiscard]] Result<void> abandon_staged();
  [[nodiscard]] Result<CommandResult> test_datum(Axis axis, std::chrono::milliseconds limit,
                                                 const CommandCallback& busy = {});
  [[nodiscard]] Result<CommandResult> record_datum(Axis axis, std::chrono::milliseconds limit,
                                                   const CommandCallback& busy = {});
  [[nodiscard]] Result<std::uint32_t> run_user_software(Address address, std::uint32_t argument,
                                                        std::chrono::milliseconds limit);
  [[nodiscard]] Result<CommandResult> run_ram_test(const CommandCallback& busy = {});
  [[nodiscard]] Result<void> clear_fault();
  [[nodiscard]] Result<void> reset_unit();
  /// CRC-32 that the unit computes over its memory.
  [[nodiscard]] Result<std::uint32_t> check_memory(Address address, std::uint32_t bytes);

  /// Every reply is checked against its CRC; all bytes or a problem.
  [[nodiscard]] Result<std::vector<std::uint8_t>> read_memory(Address address, std::size_t bytes,
                                                              const ProgressCallback& progress = {});

  /// In windows of up to 64 blocks; only missing blocks are sent again; at the end the unit's own CRC over the whole
  /// range must agree. After a problem the range may be partly written.
  [[nodiscard]] Result<void> write_memory(Address address, std::span<const std::uint8_t> bytes,
                                          const ProgressCallback& progress = {});

  /// A map: compare with what the unit holds, begin staging, write what differs, commit. A map that is active already
  /// ends at once; what an earlier transfer has brought, or the active map, is not sent again. The unit computes the
  /// check of every window and of the whole over its memory, not over what came in: nothing is read back. So success
  /// means that checks agree; whoever calls it verified compares the values (read_memory). Until the
  /// commit the old map stays active and whole; after a problem or a cancel what was staged is abandoned, as far as the
  /// link allows. A unit that names the active bank to write to, another unit on the link and another host's commit are
  /// found before the commit. From the commit on a cancel waits until the unit has said which map is active; every
  /// problem names that map, or says that it is not known.
  [[nodiscard]] Result<UploadReport> upload_image(std::span<const std::uint8_t> image,
                                                  const ProgressCallback& progress = {}, Held held = Held::by_checks);

 private:
  struct SentImage {
    std::span<const std::uint8_t> bytes;
    ImageDigest digest{};
  };
  /// An answer with whether it is this unit's, as far as this host can know: a host without a key believes everybody.
  struct Answer {
    Registers registers;
    bool believed = false;
  };
  /// What the staged bank begins as, and which pieces of the image it holds then.
  struct Beginning {
    StagingFrom from = StagingFrom::kept;
    std::vector<bool> held;
  };
  using FrameCallback = std::function<void(const BlockFrame&)>;
  [[nodiscard]] Asker asker();
  [[nodiscard]] bool is_sealed(const Registers& answer, const Block& block, std::uint32_t challenge) const;
  [[nodiscard]] Result<Answer> ask_sealed(const Block& request, const std::function<Registers(const Asker&)>& values,
                                          const Block& answer);
  [[nodiscard]] bool adopt_key(const SessionState& state, const Registers& answer);
  [[nodiscard]] Result<CommandResult> believed_result(const Answer& answer, CommandCode code) const;
  [[nodiscard]] Result<CommandResult> result_now();
  [[nodiscard]] Result<SessionState> session_now();
  [[nodiscard]] Result<void> make_ready(Command& command);
  [[nodiscard]] Result<SessionState> armed_session();
  [[nodiscard]] std::string reason_of(UnitError error) const;
  [[nodiscard]] Result<CommandResult> outcome_of(const Command& command, const CommandResult& result) const;
  [[nodiscard]] Result<CommandResult> exchange(const Command& command);
  [[nodiscard]] Result<CommandResult> wait_for(const Command& command, CommandResult first,
                                               std::chrono::milliseconds limit, const CommandCallback& busy);
  [[nodiscard]] Result<CommandResult> stopped(const Command& command, bool over);
  [[nodiscard]] Result<ActiveMap> active_map_when_idle();
  [[nodiscard]] Result<std::uint32_t> commit_staged(const ActiveMap& before, const SentImage& sent);
  [[nodiscard]] Result<std::uint32_t> confirmed(std::uint32_t commit, const SentImage& sent);
  [[nodiscard]] Result<std::uint32_t> settled(const ActiveMap& before, const SentImage& sent, Problem why,
                                              bool cancelled);
  [[nodiscard]] Result<void> run_acting(const Command& command, std::chrono::milliseconds limit,
                                        std::string_view if_unanswered);
  [[nodiscard]] Result<void> run_plain(const Command& command, std::chrono::milliseconds limit);
  [[nodiscard]] Result<std::vector<std::uint8_t>> read_piece(Address address, std::size_t bytes);
  [[nodiscard]] Result<WindowAck> ask_ack(const WindowOpen& window);
  [[nodiscard]] Result<void> write_window(const WindowFrames& frames, const FrameCallback& sent);
  [[nodiscard]] Result<void> fill_window(const WindowFrames& frames, const FrameCallback& sent);
  [[nodiscard]] Result<void> send_missing(const WindowOpen& window, const WindowFrames& frames, std::uint64_t received,
                                          const FrameCallback& sent);
  [[nodiscard]] Result<std::vector<bool>> held_at(Address bank, std::span<const std::uint8_t> image);
  [[nodiscard]] Result<Beginning> beginning_for(const ActiveMap& before, std::span<const std::uint8_t> image, Held by);
  [[nodiscard]] Result<void> stage(Address address, std::span<const std::uint8_t> image, const std::vector<bool>& held,
                                   const ProgressCallback& progress, UploadReport& report);
  [[nodiscard]] Problem given_up(Problem why, const ActiveMap& before);
  [[nodiscard]] Result<ActiveMap> abandoned();
  [[nodiscard]] Result<void> nothing_else_committed(const ActiveMap& before);

  Link link_;
  std::string serial_number_;  ///< of the unit that answered first: no other one is sent a map
  SessionOpen self_;
  std::string arm_code_;
  std::shared_ptr<SecretStore> secrets_;
  std::optional<Secret> secret_;  ///< that this host shares with the unit
  std::optional<Secret> key_;     ///< of the session; nothing: not armed, as far as this host knows
  std::uint32_t challenge_ = 0;   ///< the last one
  bool wants_code_ = false;
  bool sends_armed_ = false;                    ///< a map, to a unit at which it was armed
  std::uint32_t session_ = 0;                   ///< 0: none is open
  std::uint32_t armed_in_ = 0;                  ///< the session in which this host was seen armed last; 0: in none
  UnitError window_refusal_ = UnitError::none;  ///< of the window that was asked for last
  std::uint32_t sequence_ = 0;                  ///< of the last command
  std::uint32_t window_number_ = 0;             ///< of the last window
  std::uint32_t token_ = 0;                     ///< of the staging that was started last
};

}  // namespace ecs::protocol
