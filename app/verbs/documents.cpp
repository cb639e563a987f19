// `ecs completion` and `ecs manual`: what is written from the definitions of all verbs.
#include <filesystem>

#include <fmt/format.h>

#include "app/cli/parser.hpp"
#include "app/verbs/registry.hpp"
#include "base/answer_table.hpp"
#include "base/cli/completion.hpp"
#include "base/cli/manual.hpp"
#include "base/file.hpp"
#include "base/overwriting.hpp"

namespace ecs::app {
namespace {

struct CompletionArguments : VerbArguments {
  const std::string& shell = choice("SHELL", {"bash", "zsh", "fish"}, "whose completion", Need::required);
};

Result<Outcome> completion(VerbContext& context, const CompletionArguments& arguments) {
  const cli::ShownProgram program = shown_program(all_verbs(), context);
  const std::string script = arguments.shell == "bash"  ? cli::bash_completion(program)
                             : arguments.shell == "zsh" ? cli::zsh_completion(program)
                                                        : cli::fish_completion(program);
  return outcome_of(record_cell("{script}", {{"shell", word_cell(arguments.shell)}, {"script", word_cell(script)}}));
}

struct ManualArguments : VerbArguments {
  const std::string& folder = text("-o,--output", "folder for the pages; made if it is not there", Need::required);
  const bool& force = flag("--force", "overwrites pages that are there");
};

Result<Outcome> manual(VerbContext& context, const ManualArguments& arguments) {
  const std::vector<cli::ManualPage> pages = manual_pages(shown_program(all_verbs(), context));
  ECS_DO(cli::write_pages(pages, arguments.folder, arguments.force));
  return outcome_of(record_cell("{pages} manual pages in {folder}\n",
                                {{"pages", count_cell(pages.size())}, {"folder", word_cell(arguments.folder)}}));
}

}  // namespace

extern const VerbDefinition kCompletion =
    verb<CompletionArguments>("completion", "completion of verbs and options in a shell, as its script",
                              "ecs completion bash > ~/.local/share/bash-completion/completions/ecs", completion);
extern const VerbDefinition kManual =
    verb<ManualArguments>("manual", "a manual page for each verb", "ecs manual -o ~/.local/share/man/man1", manual);

}  // namespace ecs::app
