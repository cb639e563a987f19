#include "app/cli/overview.hpp"

#include <fmt/format.h>

#include "base/json.hpp"
#include "commissioning/link/choice.hpp"

namespace ecs::app {
namespace {

/// One line per verb, under the help of its menu; a verb outside any menu has its own paragraph.
void add_verbs(const VerbRegistry& registry, std::string& text, Json& verbs) {
  std::string menu;
  for (const VerbDefinition* verb : registry.verbs) {
    const std::string first = verb->words().front();
    if (first != menu)
      text += registry.menu_help(first).empty() ? "\n" : fmt::format("\n{}\n", registry.menu_help(first));
    menu = first;
    text += fmt::format("  {:<26} {}\n", verb->path, verb->help);
    verbs.push_back({{"verb", verb->path}, {"help", verb->help}});
  }
}

std::string state_of_link(const Result<LinkChoice>& choice) {
  if (!choice) return to_text(choice.error());
  const std::string name = to_text(*choice);
  if (choice->origin == "default") return name + " (default: none is given or stored)";
  return fmt::format("{} ({})", name,
                     choice->origin == "--link" ? "given" : "stored in " + configuration_file().string());
}

}  // namespace

std::string verbs_overview(const VerbRegistry& registry) {
  std::string text;
  Json verbs = Json::array();
  add_verbs(registry, text, verbs);
  return text;
}

Result<Outcome> overview(const VerbRegistry& registry, VerbContext& context) {
  const auto choice = chosen_link(context.link_option);
  std::string text = std::string(kProgramHelp) + "\n";
  Json verbs = Json::array();
  add_verbs(registry, text, verbs);
  text +=
      fmt::format("\nLink: {}\n`ecs VERB --help` explains a verb; `ecs doctor` finds out why a link does not work.\n",
                  state_of_link(choice));
  const Json link = choice ? Json(to_text(*choice)) : Json(nullptr);
  return Outcome{text, one_line(Json{{"verbs", verbs}, {"link", link}}), kDone};
}

}  // namespace ecs::app
