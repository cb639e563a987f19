// Calibrating the rig as thesis 3.5.2 does (BS 4656: linear cycle, five runs each way, ±3σ), and making compensation
// tables from it. Does not live here: the rig (rig.hpp), the figures (figures.hpp).
#pragma once

#include "ecs_emulator/rig/rig.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::emulator {

struct RigPlan {
  double from_mm = 450.0;  ///< the datum of the calibration
  double to_mm = 0.0;
  double step_mm = 4.0;
  int runs = 5;
  double feed_mm_min = 3000.0;
  double dwell_s = 0.6;
  double overrun_mm = 4.0;  ///< beyond either end, so that every target is reached from the right side
};

[[nodiscard]] laser::MeasurementSet calibrated(Rig& rig, const RigPlan& plan, bool compensated);

/// One target in one direction.
struct RigTarget {
  double position_mm = 0.0;
  Approach approach = Approach::forward;
  double mean_um = 0.0;
  double sigma_um = 0.0;  ///< n − 1
};
/// The numbers in the heads of figures 3.9 to 3.12.
struct RigBand {
  double error_band_um = 0.0;         ///< largest mean + 3σ less smallest mean − 3σ, whatever the direction
  double non_repeatability_um = 0.0;  ///< largest 6σ
  double largest_reading_um = 0.0;    ///< largest size of a single reading
  std::vector<RigTarget> targets;
};
[[nodiscard]] RigBand band_of(const laser::MeasurementSet& set);

/// Minus the means, at the targets. @pre the targets are `plan`'s
[[nodiscard]] RigTables tables_of(const RigBand& band, const RigPlan& plan);

}  // namespace ecs::emulator
