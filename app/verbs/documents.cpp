// `ecs completion` and `ecs manual`: what is written from the definitions of all verbs.
#include "base/cli/documents.hpp"

#include <filesystem>

#include <fmt/format.h>

#include "app/cli/program.hpp"
#include "app/verbs/registry.hpp"
#include "base/answer_table.hpp"

namespace ecs::app {
namespace {

struct CompletionRequest {
  std::string shell;
  static Fields<CompletionRequest> fields() {
    using R = CompletionRequest;
    return {
        {"SHELL", &R::shell, "shell to write the completion script for", Words{"bash", "zsh", "fish"}, Need::required}};
  }
};

Result<Outcome> completion(VerbContext& context, const CompletionRequest& request) {
  const cli::ShownProgram program = shown_program(all_verbs(), context);
  const std::string script = request.shell == "bash"  ? cli::bash_completion(program)
                             : request.shell == "zsh" ? cli::zsh_completion(program)
                                                      : cli::fish_completion(program);
  return outcome_of(record_cell("{script}", "shell"_is(request.shell), "script"_is(script)));
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

Result<Outcome> manual(VerbContext& context, const ManualRequest& request) {
  const std::vector<cli::ManualPage> pages = manual_pages(shown_program(all_verbs(), context));
  ECS_DO(cli::write_pages(pages, request.folder, request.force));
  return outcome_of(
      record_cell("{pages} manual pages in {folder}\n", "pages"_is(pages.size()), "folder"_is(request.folder)));
}

}  // namespace

extern const std::vector<Action> kDocuments{
    action("completion", "print a shell script that completes verbs and options",
           "ecs completion bash > ~/.local/share/bash-completion/completions/ecs", completion),
    action("manual", "write a manual page for each verb", "ecs manual -o ~/.local/share/man/man1", manual)};

}  // namespace ecs::app
