// What the module brings: an `export` verb for each control, and `export read`.
#include "app/cli/module.hpp"

namespace ecs::app {

extern const std::vector<Action> kExportReading;
/// One for each format.
const std::vector<Action>& export_writers();

const Module& controllers_module() {
  static const Module module{.menus = {{"export", "the error map as compensation tables of other controls, and back"}},
                             .verbs = {{"volume", &export_writers()}, {"volume", &kExportReading}}};
  return module;
}

}  // namespace ecs::app
