// A verb is defined in a file of this folder; here it gets its row.
#include "ecs_emulator/verbs/registry.hpp"

namespace ecs::emulator {

extern const VerbDefinition kServe;
/// What can be done in a workshop that runs.
const std::vector<VerbDefinition>& workshop_verbs();
extern const VerbDefinition kPlan;
/// The same for a machine without a unit.
const std::vector<VerbDefinition>& verbs_without_unit();
extern const VerbDefinition kProgram;
extern const VerbDefinition kRig;
extern const VerbDefinition kHide;
extern const VerbDefinition kCompletion, kManual;

cli::VerbRegistry<VerbContext> all_verbs(VerbContext& context) {
  cli::Menu workshop{"workshop", "what a person in the workshop does, at a running server", {}};
  workshop.arguments =
      Verb().text("SOCKET", context.workshop, "the server's --workshop socket", Need::required).arguments();
  cli::VerbRegistry<VerbContext> registry{{workshop}, {&kServe}};
  for (const VerbDefinition& verb : workshop_verbs()) registry.verbs.push_back(&verb);
  registry.verbs.push_back(&kPlan);
  for (const VerbDefinition& verb : verbs_without_unit()) registry.verbs.push_back(&verb);
  registry.verbs.insert(registry.verbs.end(), {&kProgram, &kRig, &kHide, &kCompletion, &kManual});
  return registry;
}

}  // namespace ecs::emulator
