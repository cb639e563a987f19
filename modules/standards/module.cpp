// What the module brings: the verbs of the ISO 230 tests.
#include "app/cli/module.hpp"

namespace ecs::app {

extern const std::vector<Action> kTestsOfPaths, kTestsOverTime;

const Module& standards_module() {
  static const Module module{.menus = {{"test", "PROCESS LASER DATA: tests of the ISO 230 standards"}},
                             .verbs = {{"laser", &kTestsOfPaths}, {"laser", &kTestsOverTime}}};
  return module;
}

}  // namespace ecs::app
