// What `completion` and `manual` ask for and do, the same in every program.
#pragma once

#include <cstddef>
#include <string>

#include "base/cli/documents.hpp"

namespace ecs::cli {

struct CompletionRequest {
  std::string shell;
  static Fields<CompletionRequest> fields() {
    return {{"SHELL", &CompletionRequest::shell, "shell to write the completion script for",
             Words{"bash", "zsh", "fish"}, Need::required}};
  }
};
[[nodiscard]] inline std::string completion_script(const ShownProgram& program, const CompletionRequest& request) {
  if (request.shell == "bash") return bash_completion(program);
  return request.shell == "zsh" ? zsh_completion(program) : fish_completion(program);
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
/// Number of the pages written.
[[nodiscard]] inline Result<std::size_t> write_manual(const ShownProgram& program, const ManualRequest& request) {
  const std::vector<ManualPage> pages = manual_pages(program);
  ECS_DO(write_pages(pages, request.folder, request.force));
  return pages.size();
}

}  // namespace ecs::cli
