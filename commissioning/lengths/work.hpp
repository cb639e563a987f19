// `ecs lengths fit` without a terminal: files read, components identified, the map made.
// Does not live here: the least squares (model/lengths), words and JSON (view.hpp).
#pragma once

#include <string>
#include <vector>

#include "base/cli/action.hpp"
#include "laser/map/error_map.hpp"
#include "model/lengths/identify.hpp"
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

}  // namespace ecs::commissioning
