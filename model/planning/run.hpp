// A proposed run, stop by stop: where the axis stops, how it came there, and how long it takes. Circles (ISO 230-4)
// that a person with a ball bar could run next: those measured now under other conditions, and one in each plane of the
// machine. Does not live here: which lines to propose, the part program (questions.hpp), what each would tell
// (separation.hpp).
#pragma once

#include <array>
#include <vector>

#include "model/data/observations.hpp"
#include "model/planning/next_measurement.hpp"
#include "params/machine.hpp"

namespace ecs::model {

inline constexpr double kSecondsAMinute = 60.0, kMinutesAnHour = 60.0;

/// A load for a machine measured without one: a choice.
inline constexpr double kTypicalLoad_kg = 100.0;

/// To a micrometre, as a control takes positions.
[[nodiscard]] double to_micrometre(double mm);

/// One reading of a run.
struct Stop {
  double target_mm = 0.0;  ///< on a circle the angle [deg]
  int approach = 1;
  int run = 1;
  double feed_mm_min = 0.0;
  double since_reversal_mm = 0.0;  ///< travel since the last reversal
  double after_s = 0.0;            ///< since the start of the program
};

/// Stops in the order in which they are visited: run by run, pass by pass; the second feed after the first.
/// @param rapid_mm_min  for the way to the overrun
[[nodiscard]] std::vector<Stop> stops_of(const MeasurementProposal& proposal, double rapid_mm_min = 6000.0);

/// Senses of approach (1 or -1) of the passes of one run, in order.
[[nodiscard]] std::vector<int> pass_senses(const MeasurementProposal& proposal);

/// Everything [min]: waiting, setting up, moving, dwelling. Accelerations are neglected.
[[nodiscard]] double minutes_of(const MeasurementProposal& proposal, const MeasuringTimes& times);

/// Lower and upper end of the way that an axis may take [mm].
using Range = std::array<double, 2>;

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

/// Sets of a ball worth weighing, one run of each, that the travels allow: the same ball and tool at pairs of + and -
/// angles, a tool of another length where rotary axes carry the tool, the ball at another place along X, Y or Z.
[[nodiscard]] std::vector<MeasurementProposal> ball_options(const Observations& data, const MeasuringTimes& times);

/// Stops of a proposed circle: every reading, counter-clockwise and clockwise, as stops_of() has those of a line.
[[nodiscard]] std::vector<Stop> stops_on_circle(const MeasurementProposal& proposal, double rapid_mm_min);

/// The point at an angle of the circle.
[[nodiscard]] Vector3 point_on_circle(const Path& circle, double angle_deg);

}  // namespace ecs::model
