// A parameter set as a table for people and as typed JSON, driven by the field table.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/json_fwd.hpp"
#include "core/parameters.hpp"
#include "params/fields.hpp"

namespace ecs::commissioning {

/// In JSON every field by its key: a number, true or false, or text. In the text a line for each field of a present
/// axis or of no axis: key, value, unit; grouped as in thesis 5.3.
[[nodiscard]] Cell parameters_cell(const UnitParameters& parameters);

/// Key, unit and both values of each. @param key_a, key_b  of the values in JSON  @param name_a, name_b  in the text
[[nodiscard]] Cell differences_cell(const std::vector<params::Difference>& differences, std::string_view key_a,
                                    std::string_view key_b, std::string_view name_a, std::string_view name_b);

}  // namespace ecs::commissioning
