// What the module brings to the emulator: the single-axis rig of the thesis.
#include "ecs_emulator/verbs/module.hpp"

namespace ecs::emulator {

extern const std::vector<Action> kRig;

const Module& rig_emulator_module() {
  static const Module module{{"program", &kRig}};
  return module;
}

}  // namespace ecs::emulator
