#include "app/cli/parser.hpp"

#include <utility>

#include "app/cli/verb_unit.hpp"
#include "base/version.hpp"

namespace ecs::app {
namespace {

/// What every menu and verb takes.
Verb common_arguments(VerbContext& context) {
  Verb common(context.link_option, context.arm_code);
  common.flag("--json", context.console.json, "the answer as one JSON object on stdout");
  common.flag("--quiet", context.console.quiet, "no notes and no progress bar");
  return common;
}

Action announcing(Action action) {
  return [action = std::move(action)](VerbContext& context) {
    announce_writing(context);
    return action(context);
  };
}

}  // namespace

ParsedWords parsed(const VerbRegistry& registry, const std::vector<std::string>& words, VerbContext& context) {
  std::vector<MenuDefinition> menus = registry.menus;
  for (MenuDefinition& menu : menus) menu.arguments = common_arguments(context).arguments();
  cli::CommandTree tree("ecs", {{}, kProgramHelp, common_arguments(context).uses_link().arguments()}, menus);
  ParsedWords answer;
  for (const VerbDefinition* definition : registry.verbs) {
    Verb verb = common_arguments(context);
    Action action = definition->declare(verb);
    if (verb.writes()) action = announcing(std::move(action));
    tree.add_verb(definition->path, definition->help, definition->example, verb.arguments(),
                  [&answer, action = std::move(action)] { answer.action = action; });
  }
  answer.request = tree.parsed(words);
  return answer;
}

cli::ShownProgram shown_program(const VerbRegistry& registry, VerbContext& context) {
  cli::ShownProgram program{"ecs", program_version(), kProgramHelp, registry.menus, {}};
  for (const VerbDefinition* definition : registry.verbs) {
    Verb verb = common_arguments(context);
    const Action keeps_arguments = definition->declare(verb);
    program.verbs.push_back({definition->path, definition->help, definition->example, cli::shown(verb.arguments())});
  }
  return program;
}

}  // namespace ecs::app
