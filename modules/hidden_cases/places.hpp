// Where on its ground an effect can sit: what the rows of hidings() ask about a place, and the places themselves.
#pragma once

#include <vector>

#include "modules/hidden_cases/hiding.hpp"

namespace ecs::emulator {

/// The places that a curve of this effect runs over.
[[nodiscard]] const std::vector<double>& places_under(const Ground& ground, const DrawnEffect& effect);
/// The sense is the translation along the axis.
[[nodiscard]] bool is_along(Sense sense, Axis axis);
/// The data hold temperature, pressure and humidity of the air.
[[nodiscard]] bool shows_air(const PlaceSearch& search);
/// The data tell the approaches of this axis apart.
[[nodiscard]] bool shows_approach(const PlaceSearch& search, Sense sense, Axis axis);
/// Every axis in every sense, where it has places enough, and an axis that stands still if it is the natural one of the
/// sense.
[[nodiscard]] std::vector<DrawnEffect> on_axes_or_parked(const PlaceSearch& search);
/// Each sense at its natural axis.
[[nodiscard]] std::vector<DrawnEffect> on_senses(const PlaceSearch& search);
/// The whole map, all of one axis, or one curve: each where it is not the same as a smaller part.
[[nodiscard]] std::vector<DrawnEffect> in_map(const PlaceSearch& search);
/// Each rotation of each axis that readings show through a lever.
[[nodiscard]] std::vector<DrawnEffect> rotations(const PlaceSearch& search);
[[nodiscard]] std::vector<DrawnEffect> squarenesses(const PlaceSearch& search);
/// One of the two senses shows it; a good place is one in which both axes of the plane are measured against each other.
[[nodiscard]] std::vector<DrawnEffect> planes(const PlaceSearch& search);
/// Straightness of an axis that moves, by each pair of sensors; a good pair are two bodies of the machine.
[[nodiscard]] std::vector<DrawnEffect> pairs_of_sensors(const PlaceSearch& search);
[[nodiscard]] std::vector<DrawnEffect> sensors_of_senses(const PlaceSearch& search);
[[nodiscard]] std::vector<DrawnEffect> lines_of_known(const PlaceSearch& search);

}  // namespace ecs::emulator
