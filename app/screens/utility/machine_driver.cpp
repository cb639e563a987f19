#include "app/screens/utility/machine_driver.hpp"

namespace ecs::app {

void MachineDriver::ask(Prompt& prompt, const WatchedUnit& unit, Message& message) {
  if (!can_drive(unit)) {
    message.say("This is a real unit: move the axes at the machine's own control.", Tone::warning);
    return;
  }
  if (task_.running()) {
    message.say("The emulated machine moves: Esc stops it.", Tone::warning);
    return;
  }
  prompt.ask(
      "Drive to:", Prompt::Kind::text, "",
      [this, workshop = unit.workshop, &message](const std::string& typed) {
        const auto request = drive_request(typed);
        if (!request) return request.error().message;
        drive_machine(task_, workshop, *request, message);
        return std::string();
      },
      "X-100 F2000 (machine mm), G01 X-100, or a program's file");
}

bool MachineDriver::stop() {
  const bool moved = task_.running();
  task_.cancel();
  return moved;
}

}  // namespace ecs::app
