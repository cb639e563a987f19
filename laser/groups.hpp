// Which readings belong together: one axis, one sense, one parked position; and their targets.
// Does not live here: what is computed from them (laser/analysis/iso230.hpp, laser/analysis/process.hpp).
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "laser/measurement_set.hpp"

namespace ecs::laser {

/// The readings of one measurement line, compensated or not.
struct Group {
  Axis axis = Axis::X;
  Sense sense = Sense::EX;
  Vector3 parked_mm{};                ///< where the other axes stand; the moving axis's own entry is 0
  std::optional<bool> compensated;    ///< as the readings have it
  std::vector<std::size_t> readings;  ///< indices into `set.readings`, in file order
  bool rotary = false;                ///< the axis turns: positions of its targets are in degrees
  Vector3 parked_deg{};               ///< where the other rotary axes stand
};

/// Every group, in the order of its first reading. Parked positions within 1e-6 mm are the same.
[[nodiscard]] std::vector<Group> groups_of(const MeasurementSet& set);

/// Readings at one target.
struct TargetReadings {
  double position_mm = 0.0;     ///< mean of the merged positions; of a rotary axis [deg]
  std::vector<double> forward;  ///< um or um/m, in file order
  std::vector<double> reverse;
  std::vector<double> undirected;  ///< approach unknown
};

/// Positions [mm, or deg] closer than this are one target: 1 % of the smallest step inside a single pass (one run, one
/// approach). Steps below 1e-6 mm are repeats, no steps. 1e-3 mm where no pass has two targets.
[[nodiscard]] double target_tolerance_mm(const MeasurementSet& set, const Group& group);

/// Ascending targets. @param tolerance_mm  ≥ 0
[[nodiscard]] std::vector<TargetReadings> targets_of(const MeasurementSet& set, const Group& group,
                                                     double tolerance_mm);

/// True if some reading of the group has a known approach; then those without one take no part.
[[nodiscard]] bool has_known_approach(const MeasurementSet& set, const Group& group);

/// Mean; nothing for no values.
[[nodiscard]] std::optional<double> mean_of(const std::vector<double>& values);

/// Sample standard deviation (n − 1); nothing for fewer than two values.
[[nodiscard]] std::optional<double> deviation_of(const std::vector<double>& values);

/// The value in the middle, the upper of two; 0 for no values.
[[nodiscard]] double median_of(std::vector<double> values);

/// Targets closer than this are one target.
inline constexpr double kSamePlace_mm = 1e-6;

}  // namespace ecs::laser
