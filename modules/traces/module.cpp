// What the module brings: `model compare` of a recorded step, and the worksheet `model drive`.
#include "app/cli/module.hpp"

#include "modules/traces/compare_trace.hpp"

namespace ecs::app {

extern const std::vector<Action> kDriveWorksheet;

const Module& traces_module() {
  static const Module module{
      .verbs = {{"model", &kDriveWorksheet}},
      .synonyms = {{"model drive", "servo tacho friction inertia worksheet appendix A spring balance"}},
      .has_data_for = commissioning::is_trace_file,
      .compare = commissioning::compare_trace};
  return module;
}

}  // namespace ecs::app
