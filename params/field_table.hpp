// The rows of the field table, built once. Users take fields() of fields.hpp.
#pragma once

#include <vector>

#include "params/fields.hpp"

namespace ecs::params {

/// All rows, in the order of the file.
[[nodiscard]] std::vector<Field> field_table();

/// The rows of one axis, keys under "axis.X.".
[[nodiscard]] std::vector<Field> axis_fields(Axis axis);

}  // namespace ecs::params
