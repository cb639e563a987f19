// The unit as the host sees it: typed reads, commands with their completion, memory in bulk, a map sent whole or not at
// all. Does not live here: retries and time-outs (link.hpp), screens and files (app/).
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "protocol/client/link.hpp"
#include "protocol/registers/unit_data.hpp"

namespace ecs::protocol {

/// Part of the message of a command that ended early where the unit may still carry it out: its stop was not answered.
inline constexpr std::string_view kStopNotReceived = "the request to stop did not reach the unit";

struct Progress {
  std::size_t bytes_done = 0;
  std::size_t bytes_total = 0;
  double seconds_left = 0.0;  ///< from the mean speed so far
};
using ProgressCallback = std::function<void(const Progress&)>;
using CommandCallback = std::function<void(const CommandResult&)>;  ///< while a command is busy

/// Where the bank of a map begins. @pre the unit holds one
[[nodiscard]] Address address_of(Bank bank);

struct UploadOptions {
  bool copy_active = false;  ///< the bank to write starts as a copy of the active one, not cleared
  bool read_back = false;    ///< besides the CRC that the unit computes over its memory, read every byte back
  /// With copy_active: only so many bytes travel, the rest is as in the active bank; the CRC is over all. 0: all
  /// travel.
  std::size_t changed_bytes = 0;
};

/// Problems: kind `link` for the link, a failed command and a unit that sends nonsense; kind `refused` for what the
/// unit declines to do, with its reason. Every call can be cancelled between two frames by the link's flag.
class UnitClient {
 public:
  /// Opens the link and checks that a unit with this protocol version answers.
  [[nodiscard]] static Result<UnitClient> connect(const LinkAddress& address, const LinkOptions& options = {});
  explicit UnitClient(Link link) : link_(std::move(link)) {}

  [[nodiscard]] Link& link() { return link_; }
  [[nodiscard]] const Link& link() const { return link_; }

  [[nodiscard]] Result<Identity> identity();
  [[nodiscard]] Result<UnitStatus> status();  ///< two reads: state, then pointers
  [[nodiscard]] Result<MonitorSample> monitor();

  /// Gives a command (its sequence number is chosen here) and waits until it is done.
  /// @param limit  how long it may stay busy; `stop` is sent when it is reached, or when the flag cancels
  [[nodiscard]] Result<CommandResult> run(Command command, std::chrono::milliseconds limit,
                                          const CommandCallback& busy = {});

  [[nodiscard]] Result<void> enter_integration();
  [[nodiscard]] Result<void> enter_compensation();
  [[nodiscard]] Result<void> set_axis_position(Axis axis, double position_mm);
  [[nodiscard]] Result<void> output_compensation(Axis axis, double output_um, bool relay_on);
  [[nodiscard]] Result<void> output_off();
  /// What is written to axis memory, committed and abandoned afterwards belongs to this staging; the unit refuses it
  /// as soon as another one has begun or ended.
  [[nodiscard]] Result<Address> begin_staging(bool copy_active);
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

  /// A map: begin staging, write, check, commit. Until the commit the old map stays active and whole; after a problem
  /// or a cancel what was staged is abandoned, as far as the link allows. A unit that names the active bank to write
  /// to, another unit on the link and another host's commit are found before the commit. From the commit on a cancel
  /// waits until the unit has said which map is active; every problem names that map, or says that it is not known.
  [[nodiscard]] Result<void> upload_image(std::span<const std::uint8_t> image, const UploadOptions& options = {},
                                          const ProgressCallback& progress = {});

 private:
  [[nodiscard]] Result<CommandResult> result_now();
  [[nodiscard]] std::uint16_t next_sequence();
  [[nodiscard]] Result<CommandResult> exchange(const Command& command);
  [[nodiscard]] Result<CommandResult> wait_for(const Command& command, CommandResult first,
                                               std::chrono::milliseconds limit, const CommandCallback& busy);
  [[nodiscard]] Result<CommandResult> stopped(const Command& command, bool over);
  [[nodiscard]] Result<UnitStatus> status_when_idle();
  [[nodiscard]] Result<bool> holds(const UnitStatus& now, std::uint32_t length, std::uint32_t crc);
  [[nodiscard]] Result<void> same_unit();
  [[nodiscard]] Result<void> commit_staged(const UnitStatus& before, std::uint32_t length, std::uint32_t crc);
  [[nodiscard]] Result<void> confirmed(std::uint32_t commit, std::uint32_t length, std::uint32_t crc);
  [[nodiscard]] Result<void> settled(const UnitStatus& before, std::uint32_t length, std::uint32_t crc, Problem why,
                                     bool cancelled);
  [[nodiscard]] Result<void> run_acting(const Command& command, std::chrono::milliseconds limit,
                                        std::string_view if_unanswered);
  [[nodiscard]] Result<void> run_plain(const Command& command, std::chrono::milliseconds limit);
  [[nodiscard]] Result<std::vector<std::uint8_t>> read_piece(Address address, std::size_t bytes);
  [[nodiscard]] Result<WindowAck> ask_ack(const WindowOpen& window, bool open);
  [[nodiscard]] Result<void> write_window(Address address, std::span<const std::uint8_t> bytes,
                                          const std::function<void(std::size_t)>& sent);
  [[nodiscard]] Result<void> send_missing(const WindowOpen& window, std::span<const std::uint8_t> bytes,
                                          std::uint64_t received, const std::function<void(std::size_t)>& sent);
  [[nodiscard]] Result<void> stage(Address address, std::span<const std::uint8_t> image, const UploadOptions& options,
                                   const ProgressCallback& progress);
  [[nodiscard]] Problem given_up(Problem why, const UnitStatus& before);
  [[nodiscard]] Result<UnitStatus> abandoned();
  [[nodiscard]] Result<void> nothing_else_committed(const UnitStatus& before);

  Link link_;
  std::string serial_number_;   ///< of the unit that answered first: no other one is sent a map
  std::uint16_t sequence_ = 0;  ///< 0: not yet known
  std::uint16_t window_tag_ = 0;
  std::uint32_t token_ = 0;  ///< of the staging that was begun last
};

}  // namespace ecs::protocol
