// Circles (ISO 230-4) that a person with a ball bar could run next: those measured now under other conditions, and one
// in each plane of the machine. Does not live here: lines (options.hpp), what each would tell (separation.hpp).
#pragma once

#include <vector>

#include "model/data/observations.hpp"
#include "model/planning/run.hpp"

namespace ecs::model {

inline constexpr double kTurn_deg = 360.0;
/// Motion on the circle before and after the turn that is read: ISO 230-4 leaves it to the user; a drive has settled
/// within an eighth of a turn.
inline constexpr double kOverlap_deg = 45.0;

/// Some of the readings are of a circle: a ball bar is at hand.
[[nodiscard]] bool has_circles(const Observations& data);

/// Circles worth weighing, one run of each: of every present circle itself, at a quarter and at twice its feed and with
/// readings three times as close; the largest that a ball bar and the travels allow in every plane, of another radius
/// than the present one.
[[nodiscard]] std::vector<MeasurementProposal> circle_options(const Observations& data, const MeasuringTimes& times);

/// Stops of a proposed circle: every reading, counter-clockwise and clockwise, as stops_of() has those of a line.
[[nodiscard]] std::vector<Stop> stops_on_circle(const MeasurementProposal& proposal, double rapid_mm_min);

/// The point at an angle of the circle.
[[nodiscard]] Vector3 point_on_circle(const Path& circle, double angle_deg);

}  // namespace ecs::model
