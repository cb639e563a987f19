// Paths of moves: lines and arcs between nominal points, places along them with the approach by which each axis comes
// there, straight pieces in place of a path. Internal to the correction of programs. Does not live here: what is aimed
// at (corrected_program.cpp).
#pragma once

#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "base/result.hpp"
#include "core/axis.hpp"
#include "modules/controllers/corrected_program.hpp"
#include "modules/controllers/program_blocks.hpp"

namespace ecs::controllers {

inline constexpr double kFarthest_mm = 1e6;

[[nodiscard]] inline Vector3 sum_of(const Vector3& a, const Vector3& b, double weight = 1.0) {
  return {a[0] + weight * b[0], a[1] + weight * b[1], a[2] + weight * b[2]};
}
[[nodiscard]] inline double length_of(const Vector3& v) { return std::hypot(v[0], v[1], v[2]); }

struct ArcPath {
  std::size_t u = 0, v = 1, w = 2;  ///< axes of the plane, from u to v is counterclockwise, and the one across
  double centre_u = 0.0, centre_v = 0.0;
  double radius_from = 0.0, radius_to = 0.0;
  double angle = 0.0, sweep = 0.0;  ///< of the start from u, and from there to the end, counterclockwise positive [rad]
};

/// Between nominal points, machine coordinates.
struct NominalPath {
  Vector3 from_mm{}, to_mm{};
  std::optional<ArcPath> arc{};

  [[nodiscard]] Vector3 at(double s) const;
  [[nodiscard]] double length_mm() const;
  /// Ends of the stretches on which every axis goes one way: 0, those of quarters of a circle, 1.
  [[nodiscard]] std::vector<double> turns() const;
};

/// The arc between the ends of a path that the words of a block ask for. Refused, without a place: words that make
/// none.
[[nodiscard]] Result<ArcPath> arc_of(const BlockOfWords& block, const ModalState& modal, const NominalPath& path);

/// How an axis came to where it is.
struct AxisSense {
  Approach approach = Approach::unknown;
  std::optional<double> extreme_mm;  ///< absent: it has been nowhere yet

  void arrive(double position_mm, double deadband_mm);
  /// Where, from 0 to 1 of a straight stretch, the approach changes; nothing: it does not.
  [[nodiscard]] std::optional<double> change_between(double from_mm, double to_mm, double deadband_mm) const;
};
[[nodiscard]] inline PerAxis<Approach> approaches_of(const PerAxis<AxisSense>& sense) {
  return {sense[0].approach, sense[1].approach, sense[2].approach};
}

struct PathSample {
  double s = 1.0;  ///< part of the way
  MachinePlace place;
};

/// Even steps along a path, and the turns of the axes: parts of the way from 0 to 1.
[[nodiscard]] std::vector<double> steps_along(const NominalPath& path, const ProgramSettings& settings);

struct SensedPath {
  std::vector<PathSample> samples;  ///< its start first
  PerAxis<AxisSense> at_end{};
};
/// The places at these steps, and those round each change of an approach.
/// @param mean_mm  where the axes go at each step
/// @param sense    of the axes at the start
[[nodiscard]] SensedPath sensed_along(const NominalPath& path, const std::vector<double>& steps,
                                      const std::vector<Vector3>& mean_mm, PerAxis<AxisSense> sense,
                                      const PerAxis<double>& deadband_mm);

/// Numbers of the points of a path, the last among them, between which straight lines miss none by more than the
/// tolerance (D. Douglas, T. Peucker, Cartographica 10 (1973) 112): split where the line is furthest off.
/// @param s  part of the way at each point, ascending
[[nodiscard]] std::vector<std::size_t> ends_of_pieces(const std::vector<Vector3>& points, const std::vector<double>& s,
                                                      double tolerance_mm);

}  // namespace ecs::controllers
