// `ecs-emulator`: the command line of the virtual workshop, from its words to its exit code.
#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

#include "base/cli/command_tree.hpp"
#include "base/text.hpp"
#include "base/version.hpp"
#include "ecs_emulator/verbs/verb.hpp"

namespace {

using namespace ecs;
using namespace ecs::emulator;

int failed(const Problem& problem) {
  fmt::print(stderr, "{}\n", shown(to_text(problem)));
  return exit_code_of(problem.kind);
}

int answered(const std::string& text, int exit_code = kDone) {
  if (!text.empty()) fmt::print("{}{}", shown(text), text.back() == '\n' ? "" : "\n");
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  VerbContext context{{}, getppid()};
  const Registry registry = all_verbs(context);
  cli::CommandTree tree("ecs-emulator", {{}, kProgramHelp}, registry.menus);
  Action::Run chosen;
  for (const Action* action : registry.actions) {
    auto [arguments, run] = action->bound({});
    tree.add_verb(action->path, action->help, action->example, arguments,
                  [&chosen, run = std::move(run)] { chosen = run; });
  }
  using Kind = cli::Request::Kind;
  const cli::Request request = tree.parsed({argv + 1, argv + argc});
  if (request.kind == Kind::help) return answered(request.text);
  if (request.kind == Kind::version) return answered(program_version_and_commit());
  if (request.kind != Kind::run) return failed({ProblemKind::usage, request.text, {}, 0, 0, {}});
  const Result<Outcome> outcome = chosen(context);
  return outcome ? answered(outcome->text, outcome->exit_code) : failed(outcome.error());
}
