// Arguments that a verb declares as members of its own struct, name, help and value in one place.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "base/cli/verb.hpp"

namespace ecs::cli {

enum class Access {
  reads,
  writes,  ///< or moves, or runs: messages say EMULATOR where that is the unit
};

/// Base of a struct with a member for each argument, in the order of the help:
///
///     struct DumpArguments : VerbArguments {
///       const std::string& output = text("-o,--output", "file to write", Need::required);
///       const Access access = uses_link();
///     };
class VerbArguments : public Verb {
 public:
  VerbArguments() = default;
  VerbArguments(const VerbArguments&) = delete;  // the members refer to each other
  VerbArguments& operator=(const VerbArguments&) = delete;

 protected:
  const std::string& text(std::string name, std::string help, Need need = Need::optional, std::string preset = {});
  /// A file that the verb writes: see OutputGuard.
  const std::string& output_file(std::string name, std::string help, Need need = Need::optional);
  /// Takes all that follow.
  const std::vector<std::string>& texts(std::string name, std::string help, Need need = Need::optional);
  /// A finite number within least … most.
  const double& number(std::string name, std::string help, double preset = 0.0, Need need = Need::optional,
                       double least = std::numeric_limits<double>::lowest(),
                       double most = std::numeric_limits<double>::max());
  const std::optional<double>& optional_number(std::string name, std::string help);
  const int& integer(std::string name, std::string help, int preset, int least, int most, Need need = Need::optional);
  const std::string& choice(std::string name, std::vector<std::string> words, std::string help,
                            Need need = Need::optional, std::string preset = {});
  const bool& flag(std::string name, std::string help);
  Access uses_link();
  Access writes_to_unit();
  /// It may write, but its messages do not say what the unit is.
  Access may_write_to_unit();

 private:
  template <class Value>
  Value& own(Value preset);

  std::deque<std::variant<std::string, std::vector<std::string>, double, std::optional<double>, int, bool>> own_;
};

/// The definition of a verb whose arguments live as long as its action.
template <class Context, class Arguments>
[[nodiscard]] VerbDefinition<Context> defined_verb(std::string path, std::string help, std::string example,
                                                   Result<Outcome> (*run)(Context&, const Arguments&)) {
  return {std::move(path), std::move(help), std::move(example),
          [run](Verb& options) -> typename VerbDefinition<Context>::Action {
            const auto arguments = std::make_shared<Arguments>();
            options.add_all(*arguments);
            return [arguments, run, guard = OutputGuard(options)](Context& context) -> Result<Outcome> {
              ECS_DO(guard.check());
              return run(context, *arguments);
            };
          }};
}

}  // namespace ecs::cli
