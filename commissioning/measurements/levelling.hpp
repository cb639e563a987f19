// Readings of one measurement line without the slope of their mean curve, and the band that is left.
// Does not live here: how a slope is found (laser/analysis/process.hpp).
#pragma once

#include "base/result.hpp"
#include "laser/analysis/curve.hpp"
#include "laser/analysis/process.hpp"

namespace ecs::app {

/// Values in um, or um/m for a rotation.
struct LevelledReadings {
  laser::MeasurementSet before;  ///< the readings of the line
  laser::Curve before_curve;     ///< their means
  laser::MeasurementSet after;   ///< every reading less the line that was removed
  laser::Levelled level;         ///< the means less that line, and the line
  double band_before = 0.0;      ///< range of all readings
  double band = 0.0;             ///< range of all readings, slope removed
};

/// How the band of the tables is defined, in one sentence.
inline constexpr const char* kBandDefinition =
    "band = largest minus smallest of all readings, after the slope named is removed";

/// @pre the group has readings
[[nodiscard]] Result<LevelledReadings> levelled_readings(const laser::MeasurementSet& set, const laser::Group& group,
                                                         laser::SlopeMethod method);

}  // namespace ecs::app
