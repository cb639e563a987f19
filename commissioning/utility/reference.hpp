// The emulated machine referenced by its control, as somebody at the machine would do it: `ecs-emulator workshop SOCKET
// reference` beside the screen. A real machine is referenced by its own control: here is nothing for it.
#pragma once

#include <string>
#include <vector>

#include "commissioning/session/job.hpp"
#include "commissioning/session/message.hpp"
#include "core/axis.hpp"

namespace ecs::commissioning {

class MachineReference {
 public:
  /// Nothing happens while one is under way. @param workshop  socket of the emulator's workshop
  /// @param axes  one after the other; empty: all
  void start(const std::string& workshop, std::vector<Axis> axes);
  void cancel() { running_.cancel(); }
  [[nodiscard]] bool running() const { return running_.running(); }
  /// Tells the message line when it failed. @return whether it ended
  [[nodiscard]] bool advance(Message& message);

 private:
  Job<Result<void>> running_;
};

}  // namespace ecs::commissioning
