// The tree of menus: what stands where. Does not live here: how a menu looks (menu_screen.cpp).
#include <fmt/format.h>

#include "app/screens/menu_screen.hpp"
#include "app/screens/model_form.hpp"
#include "app/screens/monitor_screen.hpp"
#include "app/screens/verb_screen.hpp"

namespace ecs::app {
namespace {

MenuChoice choice_of(const VerbEntry& verb, const std::string& link) {
  return {verb.name(), verb.help, [verb, link] { return std::make_unique<VerbScreen>(verb, link); }};
}

MenuChoice model_screen() {
  return {"model screen", "curves, what is missing, add it, watch the error fall",
          [] { return std::make_unique<ModelForm>(); }};
}

std::unique_ptr<Screen> menu_of(const MenuEntry& menu, const std::string& link) {
  std::vector<MenuChoice> choices;
  if (menu.title.starts_with("MODEL")) choices.push_back(model_screen());
  for (const VerbEntry& verb : menu.verbs) choices.push_back(choice_of(verb, link));
  return std::make_unique<MenuScreen>(menu.title.substr(0, menu.title.find(':')),
                                      menu.title + ". Every entry is a verb of `ecs` with its options as fields.",
                                      std::move(choices));
}

}  // namespace

std::unique_ptr<Screen> main_menu(const std::string& link) {
  const auto menus = verb_catalogue();
  std::vector<MenuChoice> choices;
  const MenuChoice monitor{"ON LINE MONITOR", "what the unit sees of its axes, as it happens",
                           [link] { return std::make_unique<MonitorScreen>(link); }};
  for (const MenuEntry& menu : menus) {
    if (choices.size() == 1) choices.push_back(monitor);  // where figure 5.4 has it
    const std::size_t colon = menu.title.find(": ");
    choices.push_back({menu.title.substr(0, colon), colon == std::string::npos ? "" : menu.title.substr(colon + 2),
                       [menu, link] { return menu_of(menu, link); }});
  }
  choices.push_back(model_screen());
  choices.back().only_sought = true;
  for (const MenuEntry& menu : menus)  // every action can be found by its name from here
    for (const VerbEntry& verb : menu.verbs) {
      choices.push_back(choice_of(verb, link));
      choices.back().only_sought = true;
    }
  return std::make_unique<MenuScreen>(
      "ECS",
      "The menus of the integration software (thesis figure 5.4), then every action by its name: type / and a part "
      "of it. The same actions exist as verbs for scripts: `ecs --help`.",
      std::move(choices));
}

}  // namespace ecs::app
