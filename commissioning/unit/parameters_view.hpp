// A parameter set as a table for people and as typed JSON, driven by the field table.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/json_fwd.hpp"
#include "core/parameters.hpp"
#include "params/diff.hpp"

namespace ecs::commissioning {

/// Every field by its key: numbers as numbers, choices and texts as text, truth as true or false.
[[nodiscard]] Json json_of(const UnitParameters& parameters);

/// One line for each field of a present axis or of no axis: key, value, unit; grouped as in thesis 5.3.
[[nodiscard]] std::string table_of(const UnitParameters& parameters);

/// Key, unit and both values of each. @param key_a, key_b  of the values in JSON  @param name_a, name_b  in the text
[[nodiscard]] Cell differences_cell(const std::vector<params::Difference>& differences, std::string_view key_a,
                                    std::string_view key_b, std::string_view name_a, std::string_view name_b);

}  // namespace ecs::commissioning
