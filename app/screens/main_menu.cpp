// The tree of menus: what stands where.
#include <algorithm>
#include <functional>

#include <fmt/format.h>

#include "app/cli/module.hpp"
#include "app/screens/forms/rows.hpp"
#include "app/screens/laser/screen.hpp"
#include "app/screens/memory/screen.hpp"
#include "app/screens/model/form.hpp"
#include "app/screens/parameters/screen.hpp"
#include "app/screens/unit/screens.hpp"
#include "app/screens/utility/screens.hpp"
#include "app/ui/menu_screen.hpp"
#include "app/verbs/registry.hpp"

namespace ecs::app {
namespace {

using Connection = std::shared_ptr<UnitConnection>;
using Choices = std::vector<MenuChoice>;

/// Other words by which a screen or verb is sought.
struct Synonyms {
  const char* name;
  const char* words;
};
constexpr Synonyms kSynonyms[] = {
    {"E.C.S. PARAMETERS", "settings setup configuration"},
    {"EDIT PARAMETERS", "settings setup configuration scale"},
    {"ON LINE MONITOR", "live readout dro watch follow jog drive move speed"},
    {"PROCESS LASER DATA", "import interferometer renishaw leadscrew pitch error table map compensation"},
    {"FROM FILES TO THE MAP", "import open laser interferometer renishaw error table compensation send upload"},
    {"SET AXIS POSITION", "preset zero datum jog drive move counter"},
    {"OUTPUT COMPENSATION VALUE", "relay d/a dac analogue voltage polarity scale"},
    {"RECORD DATUM SEQUENCE", "reference home homing marker index switch velocity"},
    {"DISPLAY DATUM SEQUENCE", "reference home homing marker index switch velocity"},
    {"TEST DATUM ROUTINE", "reference home homing marker index switch"},
    {"DISPLAY ECS STATUS",
     "integration mode compensate compensation on off switch enable fault alarm reset error clear ram test"},
    {"RUN USER SOFTWARE", "machine code program execute"},
    {"TOOLS", "tool table length offset magazine spindle"},
    {"MEMORY ACCESS", "hex bytes dump image"},
    {"VIEW MEMORY", "hex bytes dump image write peek poke"},
    {"MODEL", "diagnose cause effect fit residual backlash thermal"},
    {"MODEL SCREEN", "diagnose cause effect fit residual backlash thermal"},
    {"LINK", "serial port baud cable connect connection usb com tcp modbus no answer doctor"},
    {"MESSAGES", "log history errors warnings"},
    {"COMMANDS", "history script replay record macro panel verbs done"},
    {"doctor", "no answer cable connection trouble"},
    {"utility mode", "integration compensate compensation on off enable"},
    {"utility output", "relay d/a dac"},
    {"utility clear", "fault alarm"},
    {"utility position", "preset zero"},
    {"utility datum test", "reference home homing"},
    {"utility datum record", "reference home homing"},
    {"unit arm", "unlock permission code write"},
    {"unit disarm", "lock read-only protect"},
    {"map send", "upload write transfer download compensation table"},
    {"map receive", "read back download"},
    {"map verify", "compare check"},
    {"map build", "compensation error table"},
    {"laser stats", "iso 230 accuracy repeatability"},
    {"model diagnose", "cause effect missing why"},
    {"monitor", "live readout dro watch"},
    {"VOLUME", "volumetric accuracy cube diagonals faces uncertainty anywhere"},
    {"volume", "volumetric accuracy cube diagonals faces uncertainty anywhere"},
};

std::string synonyms_of(const std::string& name) {
  std::string all;
  for (const Synonyms& row : kSynonyms)
    if (name == row.name) all = row.words;
  for (const Module* module : modules())
    for (const auto& [screen, words] : module->synonyms)
      if (name == screen) all += fmt::format(" {}", words);
  return all;
}

/// Verbs that a screen of the same menu does: they are found by their names, not listed beside it.
constexpr const char* kDoneByScreens[] = {
    "utility position", "utility output",       "utility run",        "utility ramtest",    "utility clear",
    "utility mode",     "utility datum record", "utility datum show", "utility datum test", "utility status",
    "monitor"};

/// Forms with a name of their own beside the menus.
Choices form_choices(const Connection& connection) {
  Choices choices;
  for (const FormEntry& entry : form_entries())
    if (!entry.help.empty() && !entry.row.verb.starts_with("utility "))
      choices.push_back({entry.row.title, entry.help,
                         [title = entry.row.title, connection] { return form_titled(title, connection); }});
  return choices;
}

MenuChoice choice_of(const VerbEntry& verb, const Connection& connection) {
  MenuChoice choice{verb.name(), verb.help, [verb, connection] { return verb_screen(verb, connection); }};
  choice.only_sought =
      std::find(std::begin(kDoneByScreens), std::end(kDoneByScreens), choice.name) != std::end(kDoneByScreens);
  choice.is_verb = true;
  return choice;
}

Choices with_synonyms(Choices choices) {
  for (MenuChoice& choice : choices) choice.synonyms = synonyms_of(choice.name);
  return choices;
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
  return {{"FROM FILES TO THE MAP", "files, exclusions, slope, ISO 230-2, map, header, send, verify",
           [connection] { return std::make_unique<LaserScreen>(connection); }}};
}
Choices memory_choices(const Connection& connection) {
  return {{"VIEW MEMORY", "bytes with their names; find, compare, write with undo, dump",
           [connection] { return std::make_unique<MemoryScreen>(connection); }}};
}
Choices model_choices(const Connection& connection) {
  return {{"MODEL SCREEN", "curves, missing effects, adding them, sending the map",
           [connection] { return model_form(connection); }}};
}

/// In the order of figure 5.4; ON LINE MONITOR, LINK and MESSAGES are screens without a menu.
const std::vector<TopMenu>& top_menus() {
  static const std::vector<TopMenu> menus{
      {"E.C.S. PARAMETERS", "data of the machine that the unit needs", parameters_choices},
      {"PROCESS LASER DATA", "from laser files to the error map in the unit", laser_choices},
      {"ECS UTILITY", "positions, outputs, datum sequences, status, faults", utility_choices},
      {"MEMORY ACCESS", "the unit's memory as bytes and as named fields", memory_choices},
      {"MODEL", "the error model and measurements: missing effects", model_choices},
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
      with_synonyms(std::move(choices)));
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

/// Every menu, every screen, every verb.
Choices all_choices(const Connection& connection) {
  Choices choices;
  for (const TopMenu& menu : top_menus())
    choices.push_back({menu.name, menu.help, [menu, connection] { return menu_of(menu, connection); }});
  choices.insert(choices.begin() + 1, {"ON LINE MONITOR", "live positions and signals of the axes",
                                       [connection] { return monitor_screen(connection); }});
  for (MenuChoice& form : form_choices(connection)) choices.insert(choices.end() - 1, std::move(form));
  for (const Module* module : modules())
    for (const ScreenEntry& screen : module->screens)
      choices.insert(choices.end() - 1,
                     {screen.name, screen.help, [open = screen.open, connection] { return open(connection); }});
  choices.insert(choices.end() - 1, {"LINK", "port, speed, unit number; link test; statistics",
                                     [connection] { return link_screen(connection); }});
  choices.insert(choices.end() - 1,
                 {"MESSAGES", "messages of the screens, errors in full, to copy", [] { return log_screen(); }});
  choices.push_back({"COMMANDS", "the actions so far as commands of ecs, to copy or save as a script (F6)",
                     [] { return commands_screen(); }, true});
  add_sought(choices, connection);
  return with_synonyms(std::move(choices));
}

constexpr const char* kFindHelp =
    "Type a part of the name of a screen or command, or a technical term (jog, relay, integration). Names are listed "
    "first, then terms, then descriptions.";

}  // namespace

std::unique_ptr<Screen> main_menu(const Connection& connection) {
  return std::make_unique<MenuScreen>(
      "ECS",
      "Five of these menus are those of the thesis (figure 5.4); the others came later. Type / and a part of a name to "
      "find an action. `ecs --help` lists the commands.",
      all_choices(connection));
}

std::unique_ptr<Screen> finder(const Connection& connection) {
  return std::make_unique<MenuScreen>("find", kFindHelp, all_choices(connection), MenuScreen::Kind::finder);
}

}  // namespace ecs::app
