// What the module brings to the emulator: the verb `hide`.
#include "ecs_emulator/verbs/module.hpp"

namespace ecs::emulator {

extern const std::vector<Action> kHide;

const Module& hidden_cases_emulator_module() {
  static const Module module{{"program", &kHide}};
  return module;
}

}  // namespace ecs::emulator
