// `j` on screens that show axes: the emulated machine is driven, by coordinates, a block or a part program.
#pragma once

#include "app/screens/files/prompt.hpp"
#include "app/ui/screen.hpp"
#include "commissioning/link/unit_connection.hpp"
#include "commissioning/utility/emulated_machine.hpp"

namespace ecs::app {

class MachineDriver {
 public:
  /// Whether there is a machine to drive: the bundled emulator's.
  [[nodiscard]] static bool can_drive(const WatchedUnit& unit) { return unit.emulator && !unit.workshop.empty(); }
  [[nodiscard]] static KeyHelp key() { return {"j", "jog, or run a program"}; }
  /// Asks where to go; of a real unit it says that its own control moves it.
  /// @param prompt, message  outlive this
  void ask(Prompt& prompt, const WatchedUnit& unit, Message& message);
  [[nodiscard]] bool running() const { return task_.running(); }
  /// Stops the machine. @return whether it moved
  bool stop();
  [[nodiscard]] bool advance() { return task_.advance() || task_.running(); }

 private:
  TaskRunner task_;
};

}  // namespace ecs::app
