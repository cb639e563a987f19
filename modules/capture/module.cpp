// What the module brings: readings taken with the machine, and sensors beside it.
#include "app/cli/module.hpp"

#include "app/screens/forms/rows.hpp"
#include "modules/capture/devices.hpp"

namespace ecs::app {

extern const std::vector<Action> kLaserCapturing;

namespace {

std::vector<FormEntry> capture_forms() {
  return {{{}, {.verb = "laser capture", .talks = true}}, {{}, {.verb = "laser devices", .talks = true}}};
}

}  // namespace

const Module& capture_module() {
  static const Module module{.verbs = {{"laser", &kLaserCapturing}},
                             .forms = capture_forms,
                             .synonyms = {{"laser capture", "measure readings record interferometer"}},
                             .surroundings = commissioning::environment_watch};
  return module;
}

}  // namespace ecs::app
