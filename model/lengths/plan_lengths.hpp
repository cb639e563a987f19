// Which lengths to measure: the plan with the fewest minutes for a wanted uncertainty of the volume. Lines, or circles
// of a ball bar, are added by what they take off the mean variance of the error vector over the volume for a minute
// (greedy A-optimal design: V. V. Fedorov, Theory of Optimal Experiments, 1972; G. L. Nemhauser, L. A. Wolsey, M. L.
// Fisher, Math. Programming 14 (1978) 265), then those that are not needed are taken out again.
// Does not live here: what the lengths say (identify.hpp).
#pragma once

#include <string>
#include <vector>

#include "model/lengths/identify.hpp"
#include "model/planning/next_measurement.hpp"

namespace ecs::model {

struct LengthPlanSettings {
  double volume_U_um = 2.0;  ///< wanted: root mean square over the volume and the tools, k = 2
  LengthInstrument instrument = LengthInstrument::tracker;
  PerAxis<std::optional<double>> knots_mm{};  ///< spacing; by default a twelfth of the travel
  std::vector<Vector3> tools_mm{{0.0, 0.0, 0.0}};
  std::vector<Vector3> stations_mm;  ///< where a tracker or ball bar may stand; empty: around the volume, within it
  int reversal_degree = 1;
  double instrument_um = 0.2;     ///< of a reading, standard deviation
  double scatter_um = 1.0;        ///< of the machine at a stop, each axis, each direction
  double scatter_um_per_m = 0.5;  ///< the same of angles, for the single set-ups
  double scale_um_per_m = 0.1;    ///< of each set-up
  double ball_bar_mm = 150.0;     ///< its radius
  double tool_minutes = 5.0;      ///< another tool at the same station
  double feed_mm_min = 2000.0;
  double dwell_s = 2.0, trigger_s = 1.0;
  MeasuringTimes times{};  ///< line_minutes for a tracker or a line, align_minutes for a ball bar
};

/// One component after the other, each with its own set-up (thesis 6.3).
struct SingleSetUps {
  int set_ups = 0;
  int runs = 0;  ///< of each, both ways
  double minutes = 0.0;
  double volume_U_um = 0.0;
  bool reached = false;  ///< with fifty runs at most
};

struct LengthPlan {
  LengthTest test;
  double minutes = 0.0;
  double set_up_minutes = 0.0;   ///< of these
  double volume_U_um = 0.0;      ///< over the volume and the tools, k = 2
  double first_tool_U_um = 0.0;  ///< over the volume with the first tool
  bool reached = false;          ///< the wanted uncertainty
  std::size_t set_ups = 0, paths = 0;
  SingleSetUps single;             ///< for the same uncertainty over the volume and the tools
  SingleSetUps single_first_tool;  ///< for that with the first tool alone, and the components that act there
  std::vector<std::string> notes;
};

/// Refused: a machine with fewer than three axes, a ball bar that fits nowhere.
[[nodiscard]] Result<LengthPlan> planned_lengths(const params::Machine& machine, const LengthPlanSettings& settings);

/// What the single set-ups take for an uncertainty over the volume and these tools (k = 2).
[[nodiscard]] SingleSetUps single_set_ups(const MachineCurves& curves, const LengthPlanSettings& settings,
                                          const std::vector<Vector3>& tools_mm, double volume_U_um);

}  // namespace ecs::model
