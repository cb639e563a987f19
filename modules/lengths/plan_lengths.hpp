// Which lengths to measure: the plan with the fewest minutes for a wanted uncertainty of the volume, beside what single
// set-ups take for it.
// Does not live here: what the lengths say (identify.hpp), candidates and choice (plan_choice.hpp).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "model/planning/next_measurement.hpp"
#include "modules/lengths/identify.hpp"

namespace ecs::model {

/// Places along each axis by which a plan weighs the volume.
inline constexpr int kPlanPlaces = 4;

struct LengthPlanSettings {
  double volume_U_um = 2.0;  ///< wanted: root mean square over the volume and the tools, k = 2
  LengthInstrument instrument = LengthInstrument::tracker;
  PerAxis<std::optional<double>> knots_mm{};  ///< spacing; by default a twelfth of the travel
  std::vector<Vector3> tools_mm{{0.0, 0.0, 0.0}};
  std::vector<Vector3> stations_mm;  ///< where a tracker or ball bar may stand; empty: around the volume, within it
  int reversal_degree = 1;
  double instrument_um = 0.2;        ///< of a reading, standard deviation
  double scatter_um = 1.0;           ///< of the machine at a stop, each axis, each direction
  double scatter_um_per_m = 0.5;     ///< the same of its angles
  double scale_um_per_m = 0.1;       ///< of each set-up
  double targets_an_interval = 1.0;  ///< of a line, between two knots; four more
  double ball_bar_mm = 150.0;        ///< its radius
  double bar_um = 1.0;            ///< standard uncertainty of its length, the same in all set-ups; 0: not known at all
  double bar_lowest_deg = -20.0;  ///< below the horizontal: the post of its ball is in the way
  double tool_minutes = 5.0;      ///< another tool at the same station
  double feed_mm_min = 2000.0;
  double dwell_s = 2.0, trigger_s = 1.0;
  std::function<bool()> stopped{};  ///< asked now and then: true ends the search, the plan is then the best so far
  MeasuringTimes times{};           ///< line_minutes for a tracker or a line, align_minutes for a ball bar
};

/// One component after the other, each with its own set-up (thesis 6.3).
struct SingleSetUps {
  int set_ups = 0;
  int targets = 0;  ///< of each, 25 at most: as few as suffice
  int runs = 0;     ///< of each, both ways
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
  SingleSetUps single;                    ///< for the same uncertainty over the volume and the tools
  SingleSetUps single_first_tool;         ///< for that with the first tool alone, and the components that act there
  std::vector<std::string> undetermined;  ///< components of which no candidate determines all
  std::vector<std::string> notes;
};

/// Refused: a machine with fewer than three axes, a ball bar that fits nowhere.
[[nodiscard]] Result<LengthPlan> planned_lengths(const params::Machine& machine, const LengthPlanSettings& settings);

/// What the single set-ups take for an uncertainty over the volume and these tools (k = 2).
[[nodiscard]] SingleSetUps single_set_ups(const MachineCurves& curves, const LengthPlanSettings& settings,
                                          const std::vector<Vector3>& tools_mm, double volume_U_um);

}  // namespace ecs::model
