// An axis as an argument of a verb.
#pragma once

#include <string_view>

#include "base/result.hpp"
#include "core/axis.hpp"

namespace ecs::app {

/// "x" or "X"; a usage problem otherwise.
[[nodiscard]] Result<Axis> axis_named(std::string_view text);

}  // namespace ecs::app
