// How a verb is defined: its words, help, example, arguments and what it runs, all as data.
// Does not live here: the list of verbs (app/verbs/registry.cpp), parsing (parser.hpp).
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "app/cli/verb_context.hpp"
#include "base/outcome.hpp"

namespace ecs::app {

using Action = std::function<Result<Outcome>(VerbContext&)>;

enum class Need { optional, required };

/// An argument named in capitals ("FILE") is taken by its place, one with dashes ("-o,--output") by its name.
struct VerbArgument {
  using Target = std::variant<std::string*, std::vector<std::string>*, double*, std::optional<double>*, int*, bool*>;

  std::string name;
  Target into;
  std::string help;
  Need need = Need::optional;
  double least = std::numeric_limits<double>::lowest();  ///< of a number
  double most = std::numeric_limits<double>::max();
  std::vector<std::string> choices{};  ///< the words that are allowed, whatever their case; empty: any text

  [[nodiscard]] bool by_place() const { return !name.starts_with('-'); }
  [[nodiscard]] bool is_flag() const { return std::holds_alternative<bool*>(into); }
  [[nodiscard]] bool takes_many() const { return std::holds_alternative<std::vector<std::string>*>(into); }
  /// A preset that means something, as the help shows it; else empty.
  [[nodiscard]] std::string preset() const;
};

/// The arguments of one verb, in the order of its help. Their variables must live as long as the action of the verb.
/// Every verb has --help, --json and --quiet besides.
class Verb {
 public:
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

  [[nodiscard]] const std::vector<VerbArgument>& arguments() const { return arguments_; }
  [[nodiscard]] bool writes() const { return writes_; }

  /// @param link  takes the value of --link
  explicit Verb(std::string& link) : link_(&link) {}

 private:
  std::string* link_;
  bool writes_ = false;
  std::vector<VerbArgument> arguments_;
};

/// A verb as its file defines it; a row of the registry names it.
struct VerbDefinition {
  std::string path;  ///< "utility datum record"
  std::string help;
  std::string example;                   ///< one or more full command lines
  std::function<Action(Verb&)> declare;  ///< declares the arguments; answers what runs with them

  [[nodiscard]] std::vector<std::string> words() const;
};

/// A group of verbs; a menu may hold menus ("utility datum").
struct MenuDefinition {
  std::string path;
  std::string help;
};

/// Every menu and verb, in the order in which the help shows them; the verbs of a menu are adjacent.
struct VerbRegistry {
  std::vector<MenuDefinition> menus;
  std::vector<const VerbDefinition*> verbs;

  /// "" where no menu has that path.
  [[nodiscard]] std::string menu_help(const std::string& path) const;
};

/// What `ecs --help` says first.
inline constexpr const char* kProgramHelp =
    "ECS: parameters, error maps and tests of an error compensation system for machine tools";

/// The definition of a verb with arguments of its own, which live as long as its action.
template <class Arguments>
[[nodiscard]] VerbDefinition verb(std::string path, std::string help, std::string example,
                                  void (*declare)(Verb&, Arguments&),
                                  Result<Outcome> (*run)(VerbContext&, const Arguments&)) {
  return {std::move(path), std::move(help), std::move(example), [declare, run](Verb& options) -> Action {
            const auto arguments = std::make_shared<Arguments>();
            declare(options, *arguments);
            return [arguments, run](VerbContext& context) { return run(context, *arguments); };
          }};
}

/// The same for a verb without arguments of its own.
[[nodiscard]] VerbDefinition verb(std::string path, std::string help, std::string example, void (*declare)(Verb&),
                                  Result<Outcome> (*run)(VerbContext&));

}  // namespace ecs::app
