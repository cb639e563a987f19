// The list of all verbs, and `completion` and `manual`, which are written from it. A verb is defined in another file of
// this folder; here it gets its row.
#include "base/cli/document_verbs.hpp"
#include "ecs_emulator/verbs/module.hpp"
#include "ecs_emulator/verbs/verb.hpp"

namespace ecs::emulator {

extern const Action kServe;
/// What can be done in a workshop that runs.
const std::vector<Action>& workshop_verbs();
extern const Action kPlan;
/// The same for a machine without a unit.
const std::vector<Action>& verbs_without_unit();
extern const Action kProgram;
extern const Action kCompletion, kManual;

Registry all_verbs(VerbContext& context) {
  cli::Menu workshop{"workshop", "do the work of a person in the workshop, on a running `ecs-emulator` server", {}};
  workshop.arguments = {{"SOCKET", &context.workshop, "the server's --workshop socket", Need::required}};
  Registry registry;
  registry.menus = {workshop};
  registry.actions = {&kServe};
  for (const Action& verb : workshop_verbs()) registry.actions.push_back(&verb);
  registry.actions.push_back(&kPlan);
  for (const Action& verb : verbs_without_unit()) registry.actions.push_back(&verb);
  registry.actions.insert(registry.actions.end(), {&kProgram, &kCompletion, &kManual});
  for (const Module* module : modules()) registry.add(module->verbs);
  return registry;
}

namespace {

cli::ShownProgram program(VerbContext& context) {
  return cli::shown_program("ecs-emulator", kProgramHelp, all_verbs(context));
}

Result<Outcome> completion(VerbContext& context, const cli::CompletionRequest& request) {
  return Outcome{completion_script(program(context), request), {}};
}

Result<Outcome> manual(VerbContext& context, const cli::ManualRequest& request) {
  ECS_TRY(pages, write_manual(program(context), request));
  return Outcome{std::to_string(pages) + " manual pages in " + request.folder, {}};
}

}  // namespace

extern const Action kCompletion =
    action("completion", "print a shell script that completes verbs and options",
           "ecs-emulator completion bash > ~/.local/share/bash-completion/completions/ecs-emulator", completion);
extern const Action kManual =
    action("manual", "write a manual page for each verb", "ecs-emulator manual -o ~/.local/share/man/man1", manual);

}  // namespace ecs::emulator
