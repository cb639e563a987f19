// The steps from readings towards the map: means, slope off, smoothed (thesis 5.3). The map, `laser process`, tables
// and the screens' preview all take them from here. The datum and the grid of the tables: laser/map/build.hpp.
#pragma once

#include <optional>
#include <vector>

#include "base/result.hpp"
#include "laser/analysis/curve.hpp"
#include "laser/analysis/process.hpp"

namespace ecs::laser {

struct CurveSteps {
  SlopeMethod slope = SlopeMethod::none;
  double smoothing_mm = 0.0;  ///< window of the local quadratic; 0: none
};

/// Values in um, or um/m for a rotation.
struct ProcessedCurve {
  Levelled level;                          ///< the curve less its slope
  std::optional<Smoothed> smooth;          ///< that curve smoothed
  std::optional<Problem> smoothing_fault;  ///< why it could not be smoothed
  [[nodiscard]] const Curve& curve() const { return smooth ? smooth->curve : level.curve; }
};

/// `refused` where the slope cannot be taken.
[[nodiscard]] Result<ProcessedCurve> processed(const Curve& curve, const CurveSteps& steps);

/// The readings of one measured line, with the curve of their means.
struct ProcessedReadings : ProcessedCurve {
  MeasurementSet before;     ///< the readings of the line
  Curve before_curve;        ///< their means
  MeasurementSet after;      ///< every reading less the slope that was taken off the means
  double band_before = 0.0;  ///< range of all readings
  double band = 0.0;         ///< range of all readings, slope off
};

/// How the band of the tables is defined, in one sentence.
inline constexpr const char* kBandDefinition =
    "band = largest minus smallest of all readings, after removal of the stated slope";

/// @pre the group has readings
[[nodiscard]] Result<ProcessedReadings> processed_readings(const MeasurementSet& set, const Group& group,
                                                           const CurveSteps& steps);

/// Range of the means of a curve, both approaches; 0 where there are none.
[[nodiscard]] double band_of(const Curve& curve);

/// The readings of the group that stand out from the others of their target and approach by more than five times what
/// is usual on the line (median of the distances, so that outliers do not hide themselves: Rousseeuw and Croux 1993);
/// at most one of a target and approach, which needs three readings there. Indices into `set.readings`, ascending.
[[nodiscard]] std::vector<std::size_t> outliers_of(const MeasurementSet& set, const Group& group);

}  // namespace ecs::laser
