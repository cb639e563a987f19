// The unit as it was seen last, and what the controllers of ECS UTILITY share: the emulated machine moved and
// referenced as somebody at the machine would do it, by requests to the workshop of the bundled emulator
// (docs/emulator.md) beside the screen. A real machine is moved by its own control: here is nothing for it.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "commissioning/link/unit_connection.hpp"
#include "commissioning/session/message.hpp"
#include "commissioning/session/task_runner.hpp"
#include "core/axis.hpp"

namespace ecs::commissioning {

/// Why a unit in this mode refuses what needs integration mode, and what to do; empty: it does not.
[[nodiscard]] std::string refusal_in(UnitMode mode, std::string_view what = "This is possible",
                                     std::string_view how = "Press m in DISPLAY ECS STATUS (F3) to switch.");

/// The unit as it was seen last, and how long ago.
struct UnitView {
  WatchedUnit watched;                            ///< without samples
  std::optional<protocol::MonitorSample> sample;  ///< the last one that came, also when the link is lost
  bool fresh = false;                             ///< `sample` came from the link that is open
  double age_s = 0.0;                             ///< of `sample`
  int restarts = 0;                               ///< how often the unit restarted while it was watched
  std::uint64_t changes = 0;

  /// @return whether there is anything new to draw
  bool look(const UnitConnection& connection);
  /// A sample that came with a piece of work while the connection could not look.
  void take(const protocol::MonitorSample& seen);
  [[nodiscard]] std::vector<Axis> axes() const;  ///< that the unit has; all as long as none answered
  [[nodiscard]] const protocol::AxisSample* axis(Axis which) const;
  [[nodiscard]] bool integrating() const { return sample && sample->mode == UnitMode::integration; }
  /// Why the unit refuses what it does in integration mode only; empty: it does it, or its mode is not known now.
  [[nodiscard]] std::string refusal() const { return fresh && sample ? refusal_in(sample->mode) : ""; }

 private:
  void take(const protocol::MonitorSample& seen, std::chrono::steady_clock::time_point at);
  std::chrono::steady_clock::time_point taken_at_{};
  std::uint64_t times_lost_ = 0;  ///< lines, when `sample` came
};

/// Whether the unit was started again between two samples: it then shows less than it had run, or lacks, of the time
/// that passed, at least all it had run before; half of that is the limit, for samples that came late.
/// @param passed  from one sample to the other while the link was lost, else 0
[[nodiscard]] bool began_anew(const protocol::MonitorSample& before, const protocol::MonitorSample& after,
                              std::chrono::steady_clock::duration passed);

/// "seen 4 s ago", coarse; empty below one second.
[[nodiscard]] std::string age_text(double age_s);

/// How work ended that did not succeed: given up by the user, or the problem.
void say_failed(Message& message, const Problem& problem, bool given_up);

/// A stem with the local time, "datum-x-20260504-140509.csv".
[[nodiscard]] std::string file_name_now(const std::string& stem, const std::string& extension);

/// Nothing happens while `task` runs. @param workshop  socket of the emulator's workshop
/// @param axes  one after the other; empty: all  @param failed  to say so when it fails; outlives the task
/// @param beside  it belongs to a command under way, which names it (reference_words())
void reference_machine(TaskRunner& task, const std::string& workshop, const std::vector<Axis>& axes, Message& failed,
                       bool beside = false);
/// As a command line.
[[nodiscard]] std::vector<std::string> reference_words(const std::string& workshop, const std::vector<Axis>& axes);

/// The request for what a person typed: "X-100 Y50 F2000" moves axes to machine coordinates in mm (F in mm/min, none:
/// rapid), "G01 X-100 F2000" is a block of a part program, the name of a file a whole one. A usage problem otherwise.
[[nodiscard]] Result<std::string> drive_request(const std::string& typed);

/// Drives the machine by such a request. Nothing happens while `task` runs; cancelling it stops the machine.
/// @param message  gets where it is afterwards; outlives the task  @param failed  gets why it is not there
void drive_machine(TaskRunner& task, const std::string& workshop, const std::string& request, Message& message,
                   std::function<void(const Problem&)> failed);

/// What the emulated laser measures.
struct EmulatedMeasurement {
  std::string plan;     ///< file; empty: the positions of every axis of the machine over its travel
  std::string machine;  ///< file, for that
  std::string phase;    ///< of the plan: "before" or "after"
  std::string folder;   ///< where the files go; none that is there is overwritten
};
/// @param taken  gets the files that were written, or why not
void measure_by_plan(TaskRunner& task, const std::string& workshop, const EmulatedMeasurement& wanted,
                     std::function<void(const Result<std::vector<std::string>>&)> taken);

}  // namespace ecs::commissioning
