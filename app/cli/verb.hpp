// How a verb is declared: name, help, example, arguments and the function behind it. The command-line library stops in
// verb.cpp. Does not live here: the list of menus (menus.hpp), running a command line (program.hpp).
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/cli/verb_context.hpp"
#include "base/outcome.hpp"

namespace CLI {
class App;
}

namespace ecs::app {

using Action = std::function<Result<Outcome>(VerbContext&)>;

enum class Need { optional, required };

/// One verb. An argument named in capitals ("FILE") is taken by its place, one with dashes ("-o,--output") by its name.
/// The variables must live as long as the action: keep them in a shared_ptr that the action holds.
/// Every verb has --help, --json and --quiet by itself.
class Verb {
 public:
  Verb(CLI::App& app, Action& chosen, std::string& link) : app_(&app), chosen_(&chosen), link_(&link) {}

  Verb& text(const std::string& name, std::string& into, const std::string& help, Need need = Need::optional);
  /// Takes all that follow.
  Verb& texts(const std::string& name, std::vector<std::string>& into, const std::string& help,
              Need need = Need::optional);
  /// A finite number within least … most.
  Verb& number(const std::string& name, double& into, const std::string& help, Need need = Need::optional,
               double least = std::numeric_limits<double>::lowest(), double most = std::numeric_limits<double>::max());
  Verb& number(const std::string& name, std::optional<double>& into, const std::string& help);
  Verb& integer(const std::string& name, int& into, const std::string& help, int least, int most,
                Need need = Need::optional);
  Verb& choice(const std::string& name, std::string& into, std::vector<std::string> words, const std::string& help,
               Need need = Need::optional);
  Verb& flag(const std::string& name, bool& into, const std::string& help);
  /// The verb talks to a unit: it takes --link.
  Verb& uses_link();
  /// The same, and it writes, moves or runs: every message says EMULATOR where that is the unit, refusals included.
  Verb& writes_to_unit();

  void runs(Action action);

 private:
  CLI::App* app_;
  Action* chosen_;
  std::string* link_;
  bool writes_ = false;
};

/// What the command line says for every verb.
struct CommonOptions {
  bool json = false;   ///< --json
  bool quiet = false;  ///< --quiet
  std::string link;    ///< --link as given; empty: not given
};

/// A group of verbs, or the whole program. A menu may hold menus ("utility datum").
class Menu {
 public:
  Menu(CLI::App& app, CommonOptions& common, Action& chosen) : app_(&app), common_(&common), chosen_(&chosen) {}

  [[nodiscard]] Menu menu(const std::string& name, const std::string& help);
  /// @param example  one or more full command lines
  [[nodiscard]] Verb verb(const std::string& name, const std::string& help, const std::string& example);

 private:
  CLI::App* app_;
  CommonOptions* common_;
  Action* chosen_;
};

}  // namespace ecs::app
