// A parameter set as a table for people and as typed JSON, driven by the field table.
#pragma once

#include <string>

#include "base/json_fwd.hpp"
#include "core/parameters.hpp"

namespace ecs::commissioning {

/// Every field by its key: numbers as numbers, choices and texts as text, truth as true or false.
[[nodiscard]] Json json_of(const UnitParameters& parameters);

/// One line for each field of a present axis or of no axis: key, value, unit; grouped as in thesis 5.3.
[[nodiscard]] std::string table_of(const UnitParameters& parameters);

}  // namespace ecs::commissioning
