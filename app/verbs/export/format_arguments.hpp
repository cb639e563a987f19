// The options of controller formats as options of a command line.
#pragma once

#include <deque>
#include <string>
#include <variant>

#include "app/cli/verb.hpp"
#include "controllers/format.hpp"

namespace ecs::app {

/// What was typed for the options of formats. Must live as long as the verb.
class FormatArguments {
 public:
  /// Adds `--name`.
  void take(Verb& verb, const controllers::FormatOption& option, const std::string& help);
  [[nodiscard]] controllers::OptionValues values() const;

 private:
  struct Typed {
    std::string name;
    std::variant<std::string, int, bool> value;
  };
  std::deque<Typed> typed_;  ///< a deque: the verb keeps references to the values
};

}  // namespace ecs::app
