// `ecs completion` and `ecs manual`: what is written from the definitions of all verbs.
#include "app/cli/program.hpp"
#include "app/verbs/registry.hpp"
#include "base/answer_table.hpp"
#include "base/cli/document_verbs.hpp"

namespace ecs::app {
namespace {

Result<Outcome> completion(VerbContext& context, const cli::CompletionRequest& request) {
  const std::string script = completion_script(shown_program(all_verbs(), context), request);
  return outcome_of(record_cell("{script}", "shell"_is(request.shell), "script"_is(script)));
}

Result<Outcome> manual(VerbContext& context, const cli::ManualRequest& request) {
  ECS_TRY(pages, write_manual(shown_program(all_verbs(), context), request));
  return outcome_of(record_cell("{pages} manual pages in {folder}\n", "pages"_is(pages), "folder"_is(request.folder)));
}

}  // namespace

extern const std::vector<Action> kDocuments{
    action("completion", "print a shell script that completes verbs and options",
           "ecs completion bash > ~/.local/share/bash-completion/completions/ecs", completion),
    action("manual", "write a manual page for each verb", "ecs manual -o ~/.local/share/man/man1", manual)};

}  // namespace ecs::app
