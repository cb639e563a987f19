// The list of all verbs, and `completion` and `manual`, which are written from it. A verb is defined in another file of
// this folder; here it gets its row.
#include "base/cli/documents.hpp"
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
  cli::Menu workshop{"workshop", "actions of a person in the workshop, at a running server", {}};
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

struct CompletionRequest {
  std::string shell;
  static Fields<CompletionRequest> fields() {
    return {{"SHELL", &CompletionRequest::shell, "shell to write the completion script for", Need::required,
             Words{"bash", "zsh", "fish"}}};
  }
};

Result<Outcome> completion(VerbContext& context, const CompletionRequest& arguments) {
  const cli::ShownProgram shown = program(context);
  return Outcome{arguments.shell == "bash"  ? cli::bash_completion(shown)
                 : arguments.shell == "zsh" ? cli::zsh_completion(shown)
                                            : cli::fish_completion(shown),
                 {}};
}

struct ManualRequest {
  std::string folder;
  bool force = false;
  static Fields<ManualRequest> fields() {
    using R = ManualRequest;
    return {{"-o,--output", &R::folder, "folder for the pages; created if missing", Need::required},
            {"--force", &R::force, "overwrite existing pages"}};
  }
};

Result<Outcome> manual(VerbContext& context, const ManualRequest& arguments) {
  const std::vector<cli::ManualPage> pages = manual_pages(program(context));
  ECS_DO(cli::write_pages(pages, arguments.folder, arguments.force));
  return Outcome{std::to_string(pages.size()) + " manual pages in " + arguments.folder, {}};
}

}  // namespace

extern const Action kCompletion =
    action("completion", "print a shell script that completes verbs and options",
           "ecs-emulator completion bash > ~/.local/share/bash-completion/completions/ecs-emulator", completion);
extern const Action kManual =
    action("manual", "write a manual page for each verb", "ecs-emulator manual -o ~/.local/share/man/man1", manual);

}  // namespace ecs::emulator
