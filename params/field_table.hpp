// The rows of the field table, built once. Users take fields() of fields.hpp.
#pragma once

#include <vector>

#include "params/fields.hpp"

namespace ecs::params {

/// All rows, in the order of the file.
[[nodiscard]] std::vector<Field> field_table();

}  // namespace ecs::params
