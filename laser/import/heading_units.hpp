// The unit that the heading of a column states. Does not live here: the units themselves (laser/units.hpp), what a
// heading says of its column (column_advice.cpp).
#pragma once

#include <optional>
#include <string_view>

#include "laser/units.hpp"

namespace ecs::laser {

/// "Abweichung [mm]", "Pos (in)", "error_um", "T / °C", "Weg Zoll": the unit between brackets or at the end. Single
/// letters and words that mean other things too count between brackets and behind an underscore only. Nothing where
/// none is stated.
[[nodiscard]] std::optional<Unit> unit_in_heading(std::string_view heading);

}  // namespace ecs::laser
