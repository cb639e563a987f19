// Measurements as JSON. Only for .cpp files (heavy header).
#pragma once

#include "base/json_fwd.hpp"
#include "commissioning/measurements/summary.hpp"

namespace ecs::commissioning {

/// {"axis", "sense", "unit", "parked_mm": {"y", "z"}, "compensated"}; parked coordinates of the axes that do not move.
[[nodiscard]] Json json_of_line(Axis axis, Sense sense, const Vector3& parked_mm, std::optional<bool> compensated);
[[nodiscard]] Json json_of(const LineSummary& line);

/// {"readings", "axes", "senses", "runs", "targets", "metadata", "notes", "lines", "sensors"}
[[nodiscard]] Json json_of(const laser::MeasurementSet& set);

}  // namespace ecs::commissioning
