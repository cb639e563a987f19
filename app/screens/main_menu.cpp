// The tree of menus: what stands where. Does not live here: how a menu looks (menu_screen.cpp).
#include <fmt/format.h>

#include "app/screens/laser_screen.hpp"
#include "app/screens/link_screen.hpp"
#include "app/screens/log_screen.hpp"
#include "app/screens/memory_screen.hpp"
#include "app/screens/menu_screen.hpp"
#include "app/screens/model_form.hpp"
#include "app/screens/monitor_screen.hpp"
#include "app/screens/parameters_screen.hpp"
#include "app/screens/utility_choices.hpp"
#include "app/screens/verb_screen.hpp"

namespace ecs::app {
namespace {

using Desk = std::shared_ptr<UnitDesk>;
using Choices = std::vector<MenuChoice>;

MenuChoice choice_of(const VerbEntry& verb, const Desk& desk) {
  return {verb.name(), verb.help, [verb, desk] { return std::make_unique<VerbScreen>(verb, desk); }};
}

/// The screens of a menu, before its verbs. @param word  the first word of the menu's title
Choices screens_of(const std::string& word, const Desk& desk) {
  Choices choices;
  if (word == "E.C.S. PARAMETERS")
    choices.push_back({"PARAMETERS SCREEN", "edit in place, check, compare with file and unit, send, receive, save",
                       [desk] { return std::make_unique<ParametersScreen>(desk); }});
  if (word == "ECS UTILITY") choices = utility_choices(desk);
  if (word == "MEMORY ACCESS")
    choices.push_back({"MEMORY SCREEN", "bytes with their names; find, compare, write with undo, dump",
                       [desk] { return std::make_unique<MemoryScreen>(desk); }});
  if (word == "PROCESS LASER DATA")
    choices.push_back({"FROM FILES TO THE MAP", "files, what is left out, slope, ISO 230, map, header, send, verify",
                       [desk] { return std::make_unique<LaserScreen>(desk); }});
  if (word == "MODEL")
    choices.push_back({"MODEL SCREEN", "curves, what is missing, add it, watch the error fall",
                       [] { return std::make_unique<ModelForm>(); }});
  return choices;
}

std::string name_of(const MenuEntry& menu) { return menu.title.substr(0, menu.title.find(':')); }
std::string help_of(const MenuEntry& menu) {
  const std::size_t colon = menu.title.find(": ");
  return colon == std::string::npos ? "" : menu.title.substr(colon + 2);
}

std::unique_ptr<Screen> menu_of(const MenuEntry& menu, const Desk& desk) {
  Choices choices = screens_of(name_of(menu), desk);
  for (const VerbEntry& verb : menu.verbs) choices.push_back(choice_of(verb, desk));
  return std::make_unique<MenuScreen>(
      name_of(menu),
      menu.title + ". Entries in capitals are screens; the others are verbs of `ecs` with their options as fields.",
      std::move(choices));
}

MenuChoice monitor_of(const Desk& desk) {
  return {"ON LINE MONITOR", "what the unit sees of its axes, as it happens",
          [desk] { return std::make_unique<MonitorScreen>(desk); }};
}

/// LINK and LOG, after MODEL.
void add_link_and_log(Choices& choices, const Desk& desk) {
  choices.push_back({"LINK", "port, speed, unit number; a doctor; statistics",
                     [desk] { return std::make_unique<LinkScreen>(desk); }});
  choices.push_back({"LOG", "what the screens told, errors whole, to copy",
                     [] { return std::make_unique<LogScreen>(); }});
}

/// Found from here by their names, not shown.
void add_sought(Choices& choices, const std::vector<MenuEntry>& menus, const Desk& desk) {
  const std::size_t shown = choices.size();
  for (const MenuEntry& menu : menus)
    for (MenuChoice& screen : screens_of(name_of(menu), desk)) choices.push_back(std::move(screen));
  for (const MenuEntry& menu : menus)
    for (const VerbEntry& verb : menu.verbs) choices.push_back(choice_of(verb, desk));
  for (std::size_t k = shown; k < choices.size(); ++k) choices[k].only_sought = true;
}

}  // namespace

std::unique_ptr<Screen> main_menu(const Desk& desk) {
  const auto menus = verb_catalogue();
  Choices choices;
  for (const MenuEntry& menu : menus) {
    if (choices.size() == 1) choices.push_back(monitor_of(desk));  // where figure 5.4 has it
    choices.push_back({name_of(menu), help_of(menu), [menu, desk] { return menu_of(menu, desk); }});
    if (name_of(menu) == "MODEL") add_link_and_log(choices, desk);
  }
  add_sought(choices, menus, desk);
  return std::make_unique<MenuScreen>(
      "ECS",
      "The menus of the integration software (thesis figure 5.4), then every action by its name: type / and a part "
      "of it. The same actions exist as verbs for scripts: `ecs --help`.",
      std::move(choices));
}

}  // namespace ecs::app
