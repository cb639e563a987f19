// The true volumetric accuracy of the machine as it stands, unit included: what no instrument can measure at once.
// Does not live here: the machine's errors (ecs_emulator/errors/true_errors.hpp).
#pragma once

#include <vector>

#include "ecs_emulator/machine/simulation.hpp"

namespace ecs::emulator {

struct SurveyPlan {
  double step_mm = 250.0;                 ///< of the grid; both ends of every travel belong to it
  Approach approach = Approach::forward;  ///< of every axis at every point
  bool scatter = false;
  double overrun_mm = 5.0;  ///< before every row
};

/// One place of the working volume.
struct SurveyPoint {
  Vector3 position_mm{};
  Vector3 error_um{};  ///< actual − target, less that at the datum
  [[nodiscard]] double length_um() const;
};

struct Survey {
  std::vector<SurveyPoint> grid;
  std::vector<SurveyPoint> corners;  ///< those of the grid that are corners of the working volume
};

/// Drives to every point of the grid. @return nothing if given up
[[nodiscard]] Result<Survey> survey(Simulation& simulation, const SurveyPlan& plan);

/// The point with the longest error vector. @pre !points.empty()
[[nodiscard]] const SurveyPoint& worst(const std::vector<SurveyPoint>& points);
/// √(mean length²)
[[nodiscard]] double rms_um(const std::vector<SurveyPoint>& points);

}  // namespace ecs::emulator
