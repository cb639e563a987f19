// What the module brings: `model investigate`, and the key i of the MODEL screen.
#include "app/cli/module.hpp"

#include "app/screens/model/screen.hpp"

namespace ecs::app {

extern const std::vector<Action> kModelInvestigation;
NextPart investigation_part(ModelController& model, Prompt& prompt);

const Module& investigation_module() {
  static const Module module{.verbs = {{"model next", &kModelInvestigation}}, .next_part = investigation_part};
  return module;
}

}  // namespace ecs::app
