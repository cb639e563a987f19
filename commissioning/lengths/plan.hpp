// A plan of lengths as asked for by a verb or a screen: words become settings, the machine file is read.
// Does not live here: the choice (model/lengths/plan_lengths.hpp), its words (view.hpp).
#pragma once

#include <functional>
#include <string>

#include "base/cli/action.hpp"
#include "model/lengths/plan_lengths.hpp"

namespace ecs::commissioning {

/// As typed; empty: not given.
struct LengthsPlanAsked {
  std::string machine;
  double volume_um = 0.0;  ///< wanted expanded uncertainty
  std::string instrument = "tracker";
  std::string tools = "0,0,0;0,0,-250;150,0,-120";
  std::string stations, knots;
  int reversal_degree = 1;
  double instrument_um = 0.2, scatter_um = 1.0, scatter_um_per_m = 0.5, scale_um_per_m = 0.1;
  double ball_bar_mm = 150.0, bar_um = 1.0, bar_lowest_deg = -20.0;
  double targets_an_interval = 1.0, feed_mm_min = 2000.0, dwell_s = 2.0;
  double set_up_minutes = model::MeasuringTimes{}.line_minutes, tool_minutes = 5.0;
  std::string output;  ///< file to write
  static cli::Fields<LengthsPlanAsked> fields();
};

/// @param stopped  asked now and then: true ends the search, and the problem says so
[[nodiscard]] Result<model::LengthPlan> lengths_plan(const LengthsPlanAsked& asked,
                                                     const std::function<bool()>& stopped = {});

}  // namespace ecs::commissioning
