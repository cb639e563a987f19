// What the module brings: readings taken with the machine, and sensors beside it.
#include "app/cli/module.hpp"

#include "modules/capture/capture.hpp"

namespace ecs::app {

extern const std::vector<Action> kLaserCapturing;

const Module& capture_module() {
  static const Module module{.verbs = {{"laser", &kLaserCapturing}},

                             .synonyms = {{"laser capture", "measure readings record interferometer"}},
                             .surroundings = commissioning::environment_watch};
  return module;
}

}  // namespace ecs::app
