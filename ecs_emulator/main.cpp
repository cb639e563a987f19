// `ecs-emulator`: the command line of the virtual workshop, from its words to its exit code.
#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

#include "base/cli/command_tree.hpp"
#include "base/shown.hpp"
#include "base/version.hpp"
#include "ecs_emulator/verbs/registry.hpp"

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
  const cli::VerbRegistry<VerbContext> registry = all_verbs(context);
  cli::CommandTree tree("ecs-emulator", {{}, kProgramHelp}, registry.menus);
  Action chosen;
  for (const VerbDefinition* definition : registry.verbs) {
    Verb verb;
    Action action = definition->declare(verb);
    tree.add_verb(definition->path, definition->help, definition->example, verb.arguments(),
                  [&chosen, action = std::move(action)] { chosen = action; });
  }
  using Kind = cli::Request::Kind;
  const cli::Request request = tree.parsed({argv + 1, argv + argc});
  if (request.kind == Kind::help) return answered(request.text);
  if (request.kind == Kind::version) return answered(program_version_and_commit());
  if (request.kind != Kind::run) return failed({ProblemKind::usage, request.text, {}, 0, 0, {}});
  const Result<Outcome> outcome = chosen(context);
  return outcome ? answered(outcome->text, outcome->exit_code) : failed(outcome.error());
}
