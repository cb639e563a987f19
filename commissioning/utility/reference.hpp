// The emulated machine referenced by its control, as somebody at the machine would do it: `ecs-emulator workshop SOCKET
// reference` beside the screen. A real machine is referenced by its own control: here is nothing for it.
#pragma once

#include <string>
#include <vector>

#include "commissioning/session/message.hpp"
#include "commissioning/session/task_runner.hpp"
#include "core/axis.hpp"

namespace ecs::commissioning {

/// Nothing happens while `task` runs. @param workshop  socket of the emulator's workshop
/// @param axes  one after the other; empty: all  @param failed  to say so when it fails; outlives the task
void reference_machine(TaskRunner& task, const std::string& workshop, std::vector<Axis> axes, Message& failed);

}  // namespace ecs::commissioning
