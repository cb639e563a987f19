// The true errors of the machine: its components along its axes, what a volume is computed from, and the volumetric
// accuracy as it stands, unit included: what no instrument can measure at once.
// Does not live here: where the errors come from (ecs_emulator/errors/true_errors.hpp).
#pragma once

#include <array>
#include <string>
#include <vector>

#include "ecs_emulator/machine/simulation.hpp"

namespace ecs::emulator {

/// Systematic part at the coordinates asked for [um, um/m]; empty for an axis that does not exist.
struct AxisComponents {
  std::array<std::vector<double>, kCurves> forward;
  std::array<std::vector<double>, kCurves> reverse;
  ComponentValues squareness{};
};

/// The other axes stand at the datum. Refused: a component that depends on where another axis stands, by its name.
/// @param places_mm  coordinates of each axis
[[nodiscard]] Result<AxisComponents> components_along(const Simulation& simulation,
                                                      const PerAxis<std::vector<double>>& places_mm);

/// A cause that the components above leave out: they are those of a machine at rest, as it was switched on.
struct LeftOut {
  std::string cause;  ///< "scatter", "load", …
  std::vector<Component> components;
};
/// Those that the errors file has: found by changing one condition after the other.
[[nodiscard]] std::vector<LeftOut> left_out(const Simulation& simulation);

/// The same of the rotary axes: by A, B, C and sense, at the angles asked for; location errors.
struct RotaryComponents {
  PerAxis<std::array<std::vector<double>, 6>> forward;
  PerAxis<std::array<std::vector<double>, 6>> reverse;
  PerAxis<SixOfAxis> location{};
};
[[nodiscard]] RotaryComponents rotary_components(const Simulation& simulation,
                                                 const PerAxis<std::vector<double>>& angles_deg);

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
