// The paths among which a plan of lengths chooses: lines through the volume, circles and arcs of a ball bar, and where
// the instrument may stand.
// Does not live here: which of them are taken (plan_choice.hpp).
#pragma once

#include <vector>

#include "model/lengths/plan_lengths.hpp"

namespace ecs::model {

/// One path of the tool, there and back.
struct PlanPath {
  std::vector<LengthReading> readings;  ///< of which set-up and tool: the stand's
  double minutes = 0.0;
  bool in_bundle = false;  ///< of the first paths at a new set-up
};

/// Edges of the volume, lines through the middle of its faces and its own, diagonals of faces and body, skew lines.
[[nodiscard]] std::vector<PlanPath> plan_lines(const MachineCurves& curves, const LengthPlanSettings& settings);

/// About the ball of a ball bar, by a tool without offset: circles about the vertical and arcs over it, each there and
/// back, that lie within the travel; the ball's post keeps the tool above `settings.bar_lowest_deg`.
[[nodiscard]] std::vector<PlanPath> plan_arcs(const MachineCurves& curves, const LengthPlanSettings& settings,
                                              const Vector3& centre_mm);

/// Stations as given, else around and below the volume; of a ball bar, centres within it, for a tool without offset.
[[nodiscard]] std::vector<Vector3> plan_stations(const LengthMachine& machine, const LengthPlanSettings& settings);

[[nodiscard]] double distance_mm(const Vector3& a, const Vector3& b);

}  // namespace ecs::model
