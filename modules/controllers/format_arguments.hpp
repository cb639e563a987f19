// The options of controller formats as fields of a request.
#pragma once

#include <map>
#include <string>
#include <variant>

#include "app/cli/verb.hpp"
#include "modules/controllers/format.hpp"

namespace ecs::app {

/// What was typed for the options of formats, by their names.
struct FormatValues {
  std::map<std::string, std::variant<std::string, int, bool>> typed;
  [[nodiscard]] controllers::OptionValues values() const;
};

/// `--name`
[[nodiscard]] Fields<FormatValues> field_of(const controllers::FormatOption& option, const std::string& help);

}  // namespace ecs::app
