// `ecs lengths fit` and `plan` without a terminal: files read, components identified, the map made; a plan as asked
// for; both answers as text and JSON. Does not live here: the least squares and the choice (identify.hpp, plan_lengths.hpp).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/cli/action.hpp"
#include "base/json_fwd.hpp"
#include "laser/map/error_map.hpp"
#include "modules/lengths/identify.hpp"
#include "modules/lengths/plan_lengths.hpp"
#include "params/parameters_toml.hpp"

namespace ecs::commissioning {

/// As typed; empty: not given.
struct LengthsArguments {
  std::string file, machine;
  std::string params;              ///< needed for a map
  std::string output, params_out;  ///< files to write
  std::string knots;               ///< "100,50,50" [mm]
  std::vector<std::string> zero;   ///< EBY="reason"
  int reversal_degree = 1;
  double scale_um_per_m = 0.1;
  bool keep_outliers = false;
  std::string customer, engineer, date;
  static cli::Fields<LengthsArguments> fields();
};

struct LengthsWork {
  model::LengthTest test;
  std::string machine_name;
  model::Identification found;
  std::vector<laser::DeclaredZero> zero;
  std::optional<laser::ErrorMap> map;          ///< where parameters are given and everything is determined
  std::optional<params::ParametersFile> unit;  ///< with the squareness that was found
};

[[nodiscard]] Result<LengthsWork> lengths_work(const LengthsArguments& arguments);

/// "100,50,50" as three lengths above 0. @param option  as problems name it
[[nodiscard]] Result<PerAxis<std::optional<double>>> three_lengths_in(const std::string& text, std::string_view option);

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

/// Uncertainties are expanded (95 %). @param map, params_out  files that were written; empty: none
[[nodiscard]] Cell lengths_cell(const LengthsWork& work, const std::string& map, const std::string& params_out);
/// The answer of `ecs lengths plan`. @param file  that was written; empty: none
[[nodiscard]] Cell lengths_plan_cell(const model::LengthPlan& plan, double wanted_U_um, const std::string& file);

}  // namespace ecs::commissioning
