// `ecs-emulator completion` and `manual`: what is written from the definitions of all verbs.
#include "base/cli/completion.hpp"
#include "base/cli/manual.hpp"
#include "base/version.hpp"
#include "ecs_emulator/verbs/registry.hpp"

namespace ecs::emulator {
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
