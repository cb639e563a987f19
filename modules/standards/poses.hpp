// Points of a body that a robot or a machine brings to one pose again and again (ISO 9283, pose repeatability), and how
// much of their scatter is one rigid motion of the whole body per visit: then the body arrives elsewhere, and neither
// the points nor the instrument scatter. Does not live here: the set-up of a workpiece (laser/import/set_up.hpp).
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "laser/import/set_up.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::laser {

/// One point of the body over all visits.
struct PosePoint {
  Vector3 mean_mm{};              ///< barycentre of its attained positions
  double repeatability_mm = 0.0;  ///< RP = mean distance from the barycentre + 3 standard deviations of it (ISO 9283)
  /// Barycentre less commanded position, whose length is the accuracy AP (ISO 9283, 7.2.1). Nothing where the file has
  /// the barycentre in place of a commanded position.
  std::optional<Vector3> off_mm{};
};

struct PoseTest {
  std::string file;
  std::vector<PosePoint> points{};  ///< in the order of the file
  int visits = 0;
  double rms_um = 0.0;         ///< of all coordinates about the barycentres
  double rms_after_um = 0.0;   ///< the same after one rigid motion per visit
  double shift_um = 0.0;       ///< rms over the visits of the motion of the barycentre of all points, along one axis
  double turn_um_per_m = 0.0;  ///< … of its rotation, about one axis
  /// Variance of a coordinate by the motions over that of the rest (F test), and its probability if each point
  /// scattered on its own.
  double ratio = 0.0;
  double probability = 1.0;
  /// Degrees of freedom of the motions, and of the rest.
  int of_motions = 0, of_rest = 0;
  std::map<int, RigidSetUp> motions{};  ///< by visit, from the nominal points
  [[nodiscard]] bool moves_as_a_whole() const;
};

/// Two tests of one pose, and whether they differ by the way in which it was reached.
struct PoseComparison {
  double ratio = 0.0;                        ///< variance of the motions of the second over that of the first
  double probability = 1.0;                  ///< of a ratio as large, or as small, by chance
  double rest_probability = 1.0;             ///< the same of the scatter of the points after the motions
  std::optional<double> largest_shift_mm{};  ///< of the barycentres of points; nothing if they have other points
  /// The motions differ and the scatter of the points does not: the way of approach, not the instrument.
  [[nodiscard]] bool is_way_of_approach() const;
};

/// @param set  EX, EY, EZ of each point at its nominal or mean position, `run` the number of the visit. Refused: fewer
///   than three points, fewer than three visits, visits that lack a point, points along one line
[[nodiscard]] Result<PoseTest> pose_test_of(const MeasurementSet& set);

/// The readings less the motion of their visit. @pre `test` is of these readings
[[nodiscard]] MeasurementSet without_motions(MeasurementSet set, const PoseTest& test);

[[nodiscard]] PoseComparison comparison_of(const PoseTest& first, const PoseTest& second);

}  // namespace ecs::laser
