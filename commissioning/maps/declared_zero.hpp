// `--zero EBY="reason"`: a component declared zero on somebody's word.
#pragma once

#include <string>

#include "base/result.hpp"
#include "laser/map/error_map.hpp"

namespace ecs::commissioning {

/// A `usage` problem for anything but CODE=reason.
[[nodiscard]] Result<laser::DeclaredZero> declared_zero_in(const std::string& word);

}  // namespace ecs::commissioning
