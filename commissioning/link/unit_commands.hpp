// Actions on the unit as the commands that do the same (commissioning/session/commands.hpp).
#pragma once

#include <string>
#include <vector>

#include "commissioning/link/unit_connection.hpp"
#include "commissioning/session/commands.hpp"

namespace ecs::commissioning {

/// The words with the --link that reaches this unit, "ecs" in front of them.
[[nodiscard]] std::vector<std::string> words_on_unit(const UnitConnection& unit, std::vector<std::string> words);
/// Notes them.
void note_on_unit(const UnitConnection& unit, std::vector<std::string> words, int exit_code = 0);

/// A verb that was run from a form, with the words of the form: over the link of the screens where it names that one or
/// none.
void note_form(const UnitConnection& unit, std::vector<std::string> words, int exit_code);

}  // namespace ecs::commissioning
