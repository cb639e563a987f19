// A world under one seed: hosts with the code of `ecs map send`, a unit with the code of the emulator, a line and a
// disk between them on which everything can go wrong, forgers, and what must hold all the same. One thread, a clock of
// its own; the same seed gives the same world, bit for bit.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "tests/world/place.hpp"

namespace ecs::world {

/// What must have been reached at least once in a run of many worlds: a check that is never put to the test says
/// nothing.
enum class Sometimes : std::uint8_t {
  supply_lost_in_record,
  supply_lost_while_staging,
  process_ended_before_battery,
  process_ended_before_name,
  process_ended_after_battery,
  file_taken_back_by_power,
  torn_file_refused_or_isolated,
  battery_not_written,
  staged_bit_flipped,
  commit_answer_lost,
  settled_as_active,
  told_new_with_failure,
  told_in_doubt,
  told_old,
  cancelled_after_commit,
  host_killed_while_staging,
  resumed,
  already_held,
  armed_again_in_transfer,
  window_closed_by_forger,
  wrong_key_refused,
  stranger_refused,
  replayed_command_ignored,
  late_refused,
  overtaken_refused,
  output_closed,
  output_opened_by_stranger,
  output_ended_by_silence,
  code_delayed,
  another_host_committed,
  collision,
  spoilt_frame_taken,
  needed_second_send_when_calm,
};
inline constexpr std::array kSometimes{
    "supply lost within the commit record",
    "supply lost while staging",
    "process ended after the commit, before the battery file",
    "process ended after the battery file, before its name lasts",
    "process ended after the battery file, before the answer",
    "battery file taken back by a loss of power",
    "torn battery file: refused, or the map isolated",
    "battery file could not be written at a commit",
    "a bit of the staged map flipped before the commit",
    "answer to a commit lost",
    "commit without answer found to be active",
    "failure told, the new map named as active",
    "failure told, in doubt which map is active",
    "failure told, the old map named as active",
    "cancelled after the commit was sent",
    "host killed while staging",
    "transfer continued from what was left",
    "map already held",
    "armed again within a transfer",
    "window closed by a forged block",
    "wrong key refused",
    "host without the code refused",
    "replayed command not carried out again",
    "late command refused",
    "overtaken command refused",
    "relay closed by an armed host",
    "relay opened by a host without the code",
    "relay opened after 60 s of silence",
    "code delayed after wrong ones",
    "another host committed meanwhile",
    "two frames at once on the line",
    "spoilt frame with a CRC that agrees reached the unit",
    "more than one send after the faults had stopped",
};

/// A break of the host that a world must find.
enum class HostBreak : std::uint8_t { none, believes_commits };

struct Breaks {
  UnitBreak unit = UnitBreak::none;
  HostBreak host = HostBreak::none;
};

struct Report {
  std::vector<std::string> violations;
  std::array<std::uint64_t, kSometimes.size()> reached{};
  std::map<std::string, std::uint64_t> endings;  ///< of uploads, by verdict
  std::uint64_t trace = 0;                       ///< of every frame, ending and change of the active map
  std::uint64_t frames = 0, faults = 0;
  double virtual_s = 0.0;
  double calm_s = 0.0;  ///< from the end of the faults to the map sent again
};

/// @param say  tells what happens, line by line; null: nobody listens
[[nodiscard]] Report run_world(std::uint64_t seed, const Breaks& breaks = {},
                               const std::function<void(const std::string&)>& say = {});

}  // namespace ecs::world
