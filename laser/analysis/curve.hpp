// An error curve: mean error over position, forward and reverse, made from the chosen readings of one group; one side
// of it (forward, reverse or mean) as a piecewise linear function. Does not live here: what is done to curves
// (process.hpp), maps (laser/map/error_map.hpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "laser/groups.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::laser {

/// Values in um, or um/m for a rotation.
struct CurvePoint {
  double position_mm = 0.0;
  std::optional<double> forward;  ///< mean of the forward readings
  std::optional<double> reverse;
  int forward_count = 0;
  int reverse_count = 0;
  std::optional<double> forward_std;  ///< of a single reading, n − 1; absent below two readings
  std::optional<double> reverse_std;
  friend bool operator==(const CurvePoint&, const CurvePoint&) = default;
};

struct Curve {
  Axis axis = Axis::X;
  Sense sense = Sense::EX;
  Vector3 parked_mm{};
  std::vector<CurvePoint> points;   ///< ascending positions, each once
  double merge_tolerance_mm = 0.0;  ///< positions closer than this are the same target
  bool approach_known = true;       ///< false: forward and reverse are the same readings of unknown approach
  std::vector<std::string> notes;
  friend bool operator==(const Curve&, const Curve&) = default;
};

/// Mean of both approaches, or the one there is; nothing if there is none.
[[nodiscard]] std::optional<double> mean_of(const CurvePoint& point);

/// Standard error of that mean from the standard deviations; nothing if a side that counts has none.
[[nodiscard]] std::optional<double> mean_std_error(const CurvePoint& point, bool approach_known);

/// Position and bidirectional mean of the points that have both approaches; of all points where fewer than two have
/// both (the reversal error must not enter a slope).
struct MeanPoint {
  double position_mm = 0.0;
  double value = 0.0;
  std::optional<double> std_error;
};
[[nodiscard]] std::vector<MeanPoint> mean_points(const Curve& curve);

/// Readings left out of an evaluation: those that fit every condition given. Nothing is removed from the data.
struct Exclusion {
  std::optional<int> row;
  std::optional<int> run;
  std::optional<Axis> axis;
  std::optional<Sense> sense;
  std::optional<Approach> approach;
  std::optional<double> target_mm;  ///< of the moving axis, within 1e-3 mm
  std::string reason;
};

struct Selection {
  MeasurementSet chosen;              ///< rows keep their numbers
  std::vector<std::size_t> left_out;  ///< readings that each exclusion fits, in the order of the exclusions
  std::vector<std::string> notes;     ///< exclusions that fit nothing
};

/// The readings that no exclusion fits. An exclusion without any condition fits nothing.
[[nodiscard]] Selection selected(const MeasurementSet& set, const std::vector<Exclusion>& exclusions);

/// Means at the targets of a group; targets closer than the tolerance are merged, the order of rows does not matter.
/// @param tolerance_mm  absent: `target_tolerance_mm`
[[nodiscard]] Result<Curve> averaged(const MeasurementSet& set, const Group& group,
                                     std::optional<double> tolerance_mm = std::nullopt);

/// A value at a position, with what is known about its scatter.
struct SidePoint {
  double position_mm = 0.0;
  double value = 0.0;
  int count = 0;
  std::optional<double> std;
};

enum class Side { forward, reverse };

/// The points that have that side, ascending.
[[nodiscard]] std::vector<SidePoint> side_of(const Curve& curve, Side side);

/// Puts a value on that side of a point; nothing leaves the side empty.
void set_side(CurvePoint& point, Side side, const std::optional<SidePoint>& value);

/// Linear between neighbours; a position within `tolerance_mm` of a point takes that point. Beyond the ends: the end
/// point where `hold`, else nothing. Nothing for no points.
[[nodiscard]] std::optional<SidePoint> point_at(const std::vector<SidePoint>& side, double position_mm,
                                                double tolerance_mm, bool hold);

}  // namespace ecs::laser
