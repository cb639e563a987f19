// What a subject beside the thesis's job brings to the program. It lives in modules/<subject>/ with all that is theirs;
// CMake lists those that are there (cmake/modules.cmake), and nothing else names one.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "app/cli/program.hpp"

namespace ecs::commissioning {
struct DrawnOutcome;
class ModelController;
class SurroundingsWatch;
class UnitConnection;
}  // namespace ecs::commissioning

namespace ecs::app {

class Prompt;
class Screen;
struct FormEntry;
struct NextPart;

/// An entry of the first menu that opens a screen.
struct ScreenEntry {
  std::string name, help;
  std::function<std::unique_ptr<Screen>(const std::shared_ptr<commissioning::UnitConnection>&)> open;
};

/// Whatever is empty it does not bring.
struct Module {
  std::vector<MenuDefinition> menus{};
  std::vector<cli::Family<VerbContext>> verbs{};
  std::vector<FormEntry> (*forms)() = nullptr;  ///< rows of screens over its verbs
  std::vector<ScreenEntry> screens{};
  /// Other words by which its screens and verbs are sought.
  std::vector<std::pair<const char*, const char*>> synonyms{};
  /// What it does with files that the core does not take: kind and command (base/file_kind.hpp).
  std::vector<std::pair<std::string_view, const char*>> advice{};
  /// Once, when the program begins.
  void (*begin)() = nullptr;
  /// Round each verb of `ecs words…`; of several modules the first is.
  AroundVerb (*around)(const std::vector<std::string>& words) = nullptr;
  /// A second part of the page NEXT of the MODEL screen (app/screens/model/screen.hpp).
  NextPart (*next_part)(commissioning::ModelController&, Prompt&) = nullptr;
  /// Whether a file holds data of a kind that `model compare` gives to the module, and what it says to them.
  bool (*has_data_for)(const std::string& file) = nullptr;
  Result<commissioning::DrawnOutcome> (*compare)(const std::string& model, const std::string& file) = nullptr;
  /// Sensors beside the machine (commissioning/unit/monitor_record.hpp).
  std::unique_ptr<commissioning::SurroundingsWatch> (*surroundings)(const std::string& device,
                                                                    double every_s) = nullptr;
};

/// In the order of their names.
[[nodiscard]] const std::vector<const Module*>& modules();

/// Null: no module knows such devices. @param device  as --environment takes it: "temper", "room.toml@SERIAL"
/// @param every_s  between two readings
[[nodiscard]] std::unique_ptr<commissioning::SurroundingsWatch> watched_surroundings(const std::string& device,
                                                                                     double every_s);

}  // namespace ecs::app
