// The tree of menus: what stands where.
#include <algorithm>
#include <functional>

#include "app/screens/laser/screen.hpp"
#include "app/screens/memory/screen.hpp"
#include "app/screens/model/form.hpp"
#include "app/screens/parameters/screen.hpp"
#include "app/screens/unit/screens.hpp"
#include "app/screens/utility/screens.hpp"
#include "app/screens/verbs/verb_screen.hpp"
#include "app/ui/menu_screen.hpp"
#include "app/verbs/registry.hpp"

namespace ecs::app {
namespace {

using Connection = std::shared_ptr<UnitConnection>;
using Choices = std::vector<MenuChoice>;

MenuChoice choice_of(const VerbEntry& verb, const Connection& connection) {
  return {verb.name(), verb.help, [verb, connection] { return verb_screen(verb, connection); }};
}

/// One entry of the first screen that opens a menu.
struct TopMenu {
  const char* name;
  const char* help;
  std::function<Choices(const Connection&)> screens;  ///< before the verbs
};

Choices parameters_choices(const Connection& connection) {
  return {{"EDIT PARAMETERS", "edit in place, check, compare with file and unit, send, receive, save",
           [connection] { return std::make_unique<ParametersScreen>(connection); }}};
}
Choices laser_choices(const Connection& connection) {
  return {{"FROM FILES TO THE MAP", "files, what is left out, slope, ISO 230, map, header, send, verify",
           [connection] { return std::make_unique<LaserScreen>(connection); }}};
}
Choices memory_choices(const Connection& connection) {
  return {{"VIEW MEMORY", "bytes with their names; find, compare, write with undo, dump",
           [connection] { return std::make_unique<MemoryScreen>(connection); }}};
}
Choices model_choices(const Connection& connection) {
  return {{"MODEL SCREEN", "curves, what is missing, add it, watch the error fall, the map to the unit",
           [connection] { return model_form(connection); }}};
}

/// In the order of figure 5.4; ON LINE MONITOR, LINK and LOG are screens without a menu.
const std::vector<TopMenu>& top_menus() {
  static const std::vector<TopMenu> menus{
      {"E.C.S. PARAMETERS", "what the unit must know of its machine", parameters_choices},
      {"PROCESS LASER DATA", "from laser files to the error map in the unit", laser_choices},
      {"ECS UTILITY", "positions, outputs, datum sequences, status, faults", utility_choices},
      {"MEMORY ACCESS", "the unit's memory, byte by byte and by its meaning", memory_choices},
      {"MODEL", "the error model beside measurements: what is missing", model_choices},
      {"MORE", "report, tables for other controls, many units, doctor", [](const Connection&) { return Choices{}; }},
  };
  return menus;
}

/// The verbs of a menu: those of the catalogue under its name; under MORE what has no menu here.
std::vector<VerbEntry> verbs_of(const std::string& name, const std::vector<MenuEntry>& catalogue) {
  const auto has_menu = [](const std::string& title) {
    return std::any_of(top_menus().begin(), top_menus().end(), [&](const TopMenu& m) { return m.name == title; });
  };
  std::vector<VerbEntry> verbs;
  for (const MenuEntry& menu : catalogue) {
    const std::string title = menu.title.substr(0, menu.title.find(':'));
    if (title == name || (name == "MORE" && !has_menu(title)))
      verbs.insert(verbs.end(), menu.verbs.begin(), menu.verbs.end());
  }
  return verbs;
}

std::unique_ptr<Screen> menu_of(const TopMenu& menu, const Connection& connection) {
  Choices choices = menu.screens(connection);
  for (const VerbEntry& verb : verbs_of(menu.name, verb_catalogue(all_verbs())))
    choices.push_back(choice_of(verb, connection));
  return std::make_unique<MenuScreen>(
      menu.name,
      std::string(menu.name) + ": " + menu.help +
          ". Entries in capitals are screens; the others are verbs of `ecs` with their options as fields.",
      std::move(choices));
}

/// Found from here by their names, not shown.
void add_sought(Choices& choices, const Connection& connection) {
  const std::size_t shown = choices.size();
  for (const TopMenu& menu : top_menus())
    for (MenuChoice& screen : menu.screens(connection)) choices.push_back(std::move(screen));
  for (const MenuEntry& menu : verb_catalogue(all_verbs()))
    for (const VerbEntry& verb : menu.verbs) choices.push_back(choice_of(verb, connection));
  for (std::size_t k = shown; k < choices.size(); ++k) choices[k].only_sought = true;
}

}  // namespace

std::unique_ptr<Screen> main_menu(const Connection& connection) {
  Choices choices;
  for (const TopMenu& menu : top_menus())
    choices.push_back({menu.name, menu.help, [menu, connection] { return menu_of(menu, connection); }});
  choices.insert(choices.begin() + 1, {"ON LINE MONITOR", "what the unit sees of its axes, as it happens",
                                       [connection] { return monitor_screen(connection); }});
  choices.insert(choices.end() - 1, {"LINK", "port, speed, unit number; a doctor; statistics",
                                     [connection] { return link_screen(connection); }});
  choices.insert(choices.end() - 1,
                 {"LOG", "messages of the screens, errors whole, to copy", [] { return log_screen(); }});
  add_sought(choices, connection);
  return std::make_unique<MenuScreen>(
      "ECS",
      "The menus of the integration software (thesis figure 5.4), then every action by its name: type / and a part of "
      "it. The same actions exist as verbs for scripts: `ecs --help`.",
      std::move(choices));
}

}  // namespace ecs::app
