// The list of all verbs, and `completion` and `manual`, which are written from it. A verb is defined in another file of
// this folder; here it gets its row.
#include "ecs_emulator/verbs/registry.hpp"

#include "base/cli/completion.hpp"
#include "base/cli/manual.hpp"
#include "base/version.hpp"

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

namespace {

cli::ShownProgram shown_program(VerbContext& context) {
  const cli::VerbRegistry<VerbContext> registry = all_verbs(context);
  cli::ShownProgram program{"ecs-emulator", program_version(), kProgramHelp, registry.menus, {}};
  for (const VerbDefinition* definition : registry.verbs) {
    Verb verb;
    const Action keeps_arguments = definition->declare(verb);
    program.verbs.push_back({definition->path, definition->help, definition->example, cli::shown(verb.arguments())});
  }
  return program;
}

struct CompletionArguments {
  std::string shell;
};

Result<Outcome> completion(VerbContext& context, const CompletionArguments& arguments) {
  const cli::ShownProgram program = shown_program(context);
  return Outcome{arguments.shell == "bash"  ? cli::bash_completion(program)
                 : arguments.shell == "zsh" ? cli::zsh_completion(program)
                                            : cli::fish_completion(program),
                 {}};
}

struct ManualArguments {
  std::string folder;
  bool force = false;
};

Result<Outcome> manual(VerbContext& context, const ManualArguments& arguments) {
  const std::vector<cli::ManualPage> pages = manual_pages(shown_program(context));
  ECS_DO(cli::write_pages(pages, arguments.folder, arguments.force));
  return Outcome{std::to_string(pages.size()) + " manual pages in " + arguments.folder, {}};
}

}  // namespace

extern const VerbDefinition kCompletion = verb<CompletionArguments>(
    "completion", "completion of verbs and options in a shell, as its script",
    "ecs-emulator completion bash > ~/.local/share/bash-completion/completions/ecs-emulator",
    [](Verb& options, CompletionArguments& arguments) {
      options.choice("SHELL", arguments.shell, {"bash", "zsh", "fish"}, "whose completion", Need::required);
    },
    completion);
extern const VerbDefinition kManual = verb<ManualArguments>(
    "manual", "a manual page for each verb", "ecs-emulator manual -o ~/.local/share/man/man1",
    [](Verb& options, ManualArguments& arguments) {
      options.text("-o,--output", arguments.folder, "folder for the pages; made if it is not there", Need::required);
      options.flag("--force", arguments.force, "overwrites pages that are there");
    },
    manual);

}  // namespace ecs::emulator
