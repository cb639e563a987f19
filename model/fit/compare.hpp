// Where a model fails: residuals by direction, position and every other variable, the worst places, the share of each
// effect at one place, the predicted map of the volume. Does not live here: why it fails
// (model/diagnosis/diagnose.hpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "model/fit/fit.hpp"

namespace ecs::model {

struct DirectionSummary {
  Sense sense = Sense::EX;
  Axis axis = Axis::X;  ///< moving
  int approach = 0;     ///< 1, -1, 0 unknown
  std::string path{};   ///< "circle XY": of readings along a path, whose first axis stands above; else ""
  std::string axes{};   ///< that move along the path
  double bias_um = 0.0;
  double rms_um = 0.0;
  double peak_um = 0.0;  ///< largest size
  std::optional<LackOfFit> lack_of_fit;
  std::size_t readings = 0;
};

struct ResidualBin {
  double from = 0.0;  ///< of the variable
  double to = 0.0;
  double mean_um = 0.0;
  double sigma_um = 0.0;  ///< standard error of the mean
  double rms_um = 0.0;
  std::size_t readings = 0;
};

/// Residuals against one variable ("x_mm", "approach", "run", "time_s", "feed_mm_min", "load_kg", a sensor …).
struct ResidualView {
  std::string variable;
  std::vector<ResidualBin> bins;
  double share = 0.0;  ///< of Σ r² that the variable explains beyond noise, 0 … 1: share_beyond_position()
};

struct WorstPlace {
  int row = 0;
  Axis axis = Axis::X;
  Sense sense = Sense::EX;
  Vector3 position_mm{};
  int approach = 0;
  int run = 0;
  double reading_um = 0.0;
  double predicted_um = 0.0;
  double residual_um = 0.0;
  std::string path{};  ///< "circle XY"; of a reading along a path
  std::string axes{};  ///< that move along it
};

struct Comparison {
  double rms_um = 0.0;
  double peak_um = 0.0;
  SizesByUnit rms_by_unit, peak_by_unit;  ///< the same
  PureError noise;
  std::optional<LackOfFit> lack_of_fit;
  std::vector<DirectionSummary> directions;
  std::vector<ResidualView> views;
  std::vector<WorstPlace> worst;  ///< largest first
  std::vector<int> outliers;
  bool rotary = false;  ///< of rotary axes: A, B, C, positions in degrees
};

[[nodiscard]] Comparison compare(const Fit& fit, const Observations& data, std::size_t worst_count = 10);

/// The value of a variable in reading k, by its column name (see ResidualView); kNotMeasured where it has none.
[[nodiscard]] double variable_of(const Observations& data, std::size_t k, const std::string& name);

/// The residuals against one variable, in bins of about equal counts, one per value where there are few values.
[[nodiscard]] ResidualView residual_view(const Observations& data, const std::vector<double>& residual,
                                         const std::string& variable, std::size_t most_bins = 16);

/// One effect's share at one place.
struct ShareAtPoint {
  std::string effect;
  double um = 0.0;
};
struct PointQuery {
  Axis axis = Axis::X;  ///< moving
  bool rotary = false;  ///< it is A, B or C: positions are in degrees
  Sense sense = Sense::EX;
  Vector3 position_mm{};
  Vector3 place_mm{};  ///< of rotary axes: where the linear axes stand, for what a ball there shows
  int approach = 1;
  std::optional<double> time_s, feed_mm_min, load_kg;
  std::map<std::string, double, std::less<>> sensors_degC;
};
/// @param fitted  a model with values (with_values()); effects whose cells the query lacks give nothing and say so
struct Breakdown {
  double total_um = 0.0;
  std::vector<ShareAtPoint> shares;
  std::vector<std::string> notes;
};
[[nodiscard]] Result<Breakdown> breakdown_at(const Model& fitted, const std::optional<params::Machine>& machine,
                                             const PointQuery& query);

/// Predicted error vector over the working volume, every axis at `points_per_axis` places of its travel.
struct VolumePoint {
  Vector3 position_mm{};
  Vector3 error_um{};
};
[[nodiscard]] Result<std::vector<VolumePoint>> predicted_volume(const Model& fitted, const params::Machine& machine,
                                                                std::size_t points_per_axis, int approach = 1);

}  // namespace ecs::model
