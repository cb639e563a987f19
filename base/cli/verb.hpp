// How a verb is defined: its words, help, example, arguments and what it runs, all as data.
// Does not live here: which verbs a program has (its registry), parsing (command_tree.hpp).
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "base/outcome.hpp"

namespace ecs::cli {

enum class Need { optional, required };

/// What is called with the value of an argument that was given.
using OnFlag = std::function<void()>;
using OnNumber = std::function<void(double)>;
using OnInteger = std::function<void(long long)>;
using OnText = std::function<void(const std::string&)>;
using OnNumbers = std::function<void(const std::vector<double>&)>;
using OnTexts = std::function<void(const std::vector<std::string>&)>;

/// An argument named in capitals ("FILE") is taken by its place, one with dashes ("-o,--output") by its name.
struct VerbArgument {
  using Target =
      std::variant<std::string*, std::vector<std::string>*, double*, std::optional<double>*, int*,
                   std::optional<std::uint64_t>*, bool*, OnFlag, OnNumber, OnInteger, OnText, OnNumbers, OnTexts>;

  std::string name;
  Target into;
  std::string help;
  Need need = Need::optional;
  double least = std::numeric_limits<double>::lowest();  ///< of a number
  double most = std::numeric_limits<double>::max();
  std::vector<std::string> choices{};  ///< the words that are allowed, whatever their case; empty: any text
  bool by_commas = false;              ///< of many values: one word holds them, parted by commas
  bool is_output = false;              ///< names a file that the verb writes
  std::string group{};                 ///< heading in the help; empty: with the other options

  [[nodiscard]] bool by_place() const { return !name.starts_with('-'); }
  [[nodiscard]] bool is_flag() const {
    return std::holds_alternative<bool*>(into) || std::holds_alternative<OnFlag>(into);
  }
  [[nodiscard]] bool takes_many() const {
    return std::holds_alternative<std::vector<std::string>*>(into) || std::holds_alternative<OnTexts>(into) ||
           std::holds_alternative<OnNumbers>(into);
  }
  /// A preset that means something, as the help shows it; else empty.
  [[nodiscard]] std::string preset() const;
};

/// The arguments of one verb, in the order of its help. Their variables must live as long as the action of the verb.
class Verb {
 public:
  Verb& text(const std::string& name, std::string& into, const std::string& help, Need need = Need::optional);
  /// A file that the verb writes: see OutputGuard.
  Verb& output_file(const std::string& name, std::string& into, const std::string& help, Need need = Need::optional);
  /// Takes all that follow.
  Verb& texts(const std::string& name, std::vector<std::string>& into, const std::string& help,
              Need need = Need::optional);
  /// A finite number within least … most.
  Verb& number(const std::string& name, double& into, const std::string& help, Need need = Need::optional,
               double least = std::numeric_limits<double>::lowest(), double most = std::numeric_limits<double>::max());
  Verb& number(const std::string& name, std::optional<double>& into, const std::string& help);
  Verb& integer(const std::string& name, int& into, const std::string& help, int least, int most,
                Need need = Need::optional);
  /// The seed of everything random: a whole number, not negative.
  Verb& seed(std::optional<std::uint64_t>& into, const std::string& help);
  Verb& choice(const std::string& name, std::string& into, std::vector<std::string> words, const std::string& help,
               Need need = Need::optional);
  Verb& flag(const std::string& name, bool& into, const std::string& help);
  Verb& add(VerbArgument argument);
  /// The arguments that follow stand below this heading in the help, until the next one; empty: no heading.
  Verb& group(std::string heading);
  /// Those of another verb, except that the values of --link and --arm-code go where this one takes them.
  Verb& add_all(const Verb& other);
  /// The verb talks to a unit: it takes --link.
  Verb& uses_link();
  /// The same, and it writes, moves or runs: every message says EMULATOR where that is the unit, refusals included. It
  /// takes --arm-code.
  Verb& writes_to_unit();
  Verb& takes_arm_code();

  [[nodiscard]] const std::vector<VerbArgument>& arguments() const { return arguments_; }
  [[nodiscard]] bool writes() const { return writes_; }

  Verb() = default;
  /// @param link, arm_code  take the values of --link and --arm-code
  Verb(std::string& link, std::string& arm_code) : link_(&link), arm_code_(&arm_code) {}

 private:
  std::string* link_ = nullptr;
  std::string* arm_code_ = nullptr;
  bool writes_ = false;
  std::string group_;
  std::vector<VerbArgument> arguments_;
};

/// What a verb writes replaces nothing: an output file that is there is refused unless --force is given. The file
/// that the verb takes first is changed in place, unless the verb refuses that itself; so is that of --NAME by
/// --NAME-out.
class OutputGuard {
 public:
  /// Adds --force where an argument is an output file and no flag of that name is there.
  explicit OutputGuard(Verb& verb);
  /// A `usage` problem for the first file that would be overwritten.
  [[nodiscard]] Result<void> check() const;

 private:
  std::vector<VerbArgument> arguments_;
  std::shared_ptr<bool> own_force_;
  const bool* force_ = nullptr;
};

/// The words of a path: {"utility", "datum", "record"} of "utility datum record".
[[nodiscard]] std::vector<std::string> words_of(const std::string& path);

/// A verb as its file defines it; a row of the program's registry names it.
/// @tparam Context  what the program gives to every verb
template <class Context>
struct VerbDefinition {
  using Action = std::function<Result<Outcome>(Context&)>;

  std::string path;  ///< "utility datum record"
  std::string help;
  std::string example;                   ///< one or more full command lines
  std::function<Action(Verb&)> declare;  ///< declares the arguments; answers what runs with them

  [[nodiscard]] std::vector<std::string> words() const { return words_of(path); }
};

/// A group of verbs; a menu may hold menus ("utility datum").
struct Menu {
  std::string path;  ///< empty: the program itself
  std::string help;
  std::vector<VerbArgument> arguments{};
};

/// Every menu and verb, in the order in which the help shows them; the verbs of a menu are adjacent.
template <class Context>
struct VerbRegistry {
  std::vector<Menu> menus;
  std::vector<const VerbDefinition<Context>*> verbs;

  /// "" where no menu has that path.
  [[nodiscard]] std::string menu_help(const std::string& path) const {
    for (const Menu& menu : menus)
      if (menu.path == path) return menu.help;
    return {};
  }
};

/// The definition of a verb with arguments of its own, which live as long as its action.
template <class Context, class Arguments>
[[nodiscard]] VerbDefinition<Context> defined_verb(std::string path, std::string help, std::string example,
                                                   void (*declare)(Verb&, Arguments&),
                                                   Result<Outcome> (*run)(Context&, const Arguments&)) {
  return {std::move(path), std::move(help), std::move(example),
          [declare, run](Verb& options) -> typename VerbDefinition<Context>::Action {
            const auto arguments = std::make_shared<Arguments>();
            declare(options, *arguments);
            return [arguments, run, guard = OutputGuard(options)](Context& context) -> Result<Outcome> {
              ECS_DO(guard.check());
              return run(context, *arguments);
            };
          }};
}

}  // namespace ecs::cli
