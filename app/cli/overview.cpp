#include "app/cli/overview.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "base/json.hpp"
#include "commissioning/link/choice.hpp"

namespace ecs::app {
namespace {

std::vector<const CLI::App*> subs_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

void add_tree(const CLI::App& app, const std::string& path, std::string& text, Json& verbs) {
  for (const CLI::App* sub : subs_of(app)) {
    const std::string name = path.empty() ? sub->get_name() : path + " " + sub->get_name();
    if (!subs_of(*sub).empty()) {
      if (path.empty()) text += fmt::format("\n{}\n", sub->get_description());
      add_tree(*sub, name, text, verbs);
      continue;
    }
    if (path.empty()) text += '\n';
    text += fmt::format("  {:<26} {}\n", name, sub->get_description());
    verbs.push_back({{"verb", name}, {"help", sub->get_description()}});
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

Result<Outcome> overview(const CLI::App& root, VerbContext& context) {
  const auto choice = chosen_link(context.link_option);
  std::string text = root.get_description() + "\n";
  Json verbs = Json::array();
  add_tree(root, "", text, verbs);
  text +=
      fmt::format("\nLink: {}\n`ecs VERB --help` explains a verb; `ecs doctor` finds out why a link does not work.\n",
                  state_of_link(choice));
  const Json link = choice ? Json(to_text(*choice)) : Json(nullptr);
  return Outcome{text, one_line(Json{{"verbs", verbs}, {"link", link}}), kDone};
}

}  // namespace ecs::app
