// What the module brings: the verb `report`.
#include "app/cli/module.hpp"

namespace ecs::app {

extern const std::vector<Action> kReport;

const Module& report_module() {
  static const Module module{.verbs = {{"volume", &kReport}}};
  return module;
}

}  // namespace ecs::app
