// What the module brings: `model compare` of a recorded step.
#include "app/cli/module.hpp"

#include "modules/traces/compare_trace.hpp"

namespace ecs::app {

const Module& traces_module() {
  static const Module module{.has_data_for = commissioning::is_trace_file, .compare = commissioning::compare_trace};
  return module;
}

}  // namespace ecs::app
