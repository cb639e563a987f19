// The emulated machine moved and referenced, as somebody at the machine would do it: requests to the workshop of the
// bundled emulator (docs/emulator.md) beside the screen. A real machine is moved by its own control: here is nothing
// for it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "commissioning/session/message.hpp"
#include "commissioning/session/task_runner.hpp"
#include "core/axis.hpp"

namespace ecs::commissioning {

/// Nothing happens while `task` runs. @param workshop  socket of the emulator's workshop
/// @param axes  one after the other; empty: all  @param failed  to say so when it fails; outlives the task
/// @param beside  it belongs to a command under way, which names it (reference_words())
void reference_machine(TaskRunner& task, const std::string& workshop, std::vector<Axis> axes, Message& failed,
                       bool beside = false);
/// As a command line.
[[nodiscard]] std::vector<std::string> reference_words(const std::string& workshop, const std::vector<Axis>& axes);

/// The request for what a person typed: "X-100 Y50 F2000" moves axes to machine coordinates in mm (F in mm/min, none:
/// rapid), "G01 X-100 F2000" is a block of a part program, the name of a file a whole one. A usage problem otherwise.
[[nodiscard]] Result<std::string> drive_request(const std::string& typed);

/// Drives the machine by such a request. Nothing happens while `task` runs; cancelling it stops the machine.
/// @param message  gets where it is afterwards, or why not; outlives the task
void drive_machine(TaskRunner& task, const std::string& workshop, const std::string& request, Message& message);

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
