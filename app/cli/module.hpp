// What a subject beside the thesis's job brings to the program. It lives in modules/<subject>/ with all that is theirs;
// CMake lists those that are there (cmake/modules.cmake), and nothing else names one.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "app/cli/program.hpp"

namespace ecs::commissioning {
class UnitConnection;
}

namespace ecs::app {

class Screen;
struct FormEntry;

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
  std::vector<std::pair<const char*, const char*>>
      synonyms{};  ///< other words by which its screens and verbs are sought
};

/// In the order of their names.
[[nodiscard]] const std::vector<const Module*>& modules();

}  // namespace ecs::app
