// Lack of fit against the scatter of repeats: the F test (Fisher 1922; Draper and Smith 1998, 2.1), here without the
// loss of freedom by the fit.
#include "model/fit/compare.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include <fmt/format.h>

#include "model/data/curve_basis.hpp"
#include "model/fit/dependence.hpp"
#include "model/fit/noise.hpp"
#include "model/fit/statistics.hpp"

namespace ecs::model {
namespace {

/// Degrees of freedom of repeats below which no F is given: a choice; F(k, 3) exceeds 9 in one case of twenty.
constexpr double kFewestPureFreedom = 4.0;
/// Values of a variable closer than this share of its range are one value: far finer than any bin.
constexpr double kSameValue = 1e-6;

ResidualBin bin_of(const std::vector<std::pair<double, double>>& pairs, std::size_t from, std::size_t to) {
  ResidualBin bin;
  bin.from = pairs[from].first;
  bin.to = pairs[to - 1].first;
  bin.readings = to - from;
  const double n = static_cast<double>(bin.readings);
  double square = 0.0;
  for (std::size_t i = from; i < to; ++i) {
    bin.mean_um += pairs[i].second / n;
    square += pairs[i].second * pairs[i].second;
  }
  bin.rms_um = std::sqrt(square / n);
  bin.sigma_um =
      n < 2.0 ? bin.rms_um : std::sqrt(std::max(0.0, square - n * bin.mean_um * bin.mean_um) / (n - 1.0) / n);
  return bin;
}

std::optional<LackOfFit> lack_of_fit_of_rows(const std::vector<double>& residual, const std::vector<std::size_t>& rows,
                                             const Repeats& repeats) {
  std::map<std::size_t, std::vector<double>> nodes;
  for (const std::size_t k : rows) nodes[repeats.node_of[k]].push_back(residual[k]);
  double between = 0.0, within = 0.0, pure_freedom = 0.0;
  for (const auto& each : nodes) {
    const double n = static_cast<double>(each.second.size());
    const double mean = std::accumulate(each.second.begin(), each.second.end(), 0.0) / n;
    between += n * mean * mean;
    for (const double r : each.second) within += (r - mean) * (r - mean);
    pure_freedom += n - 1.0;
  }
  if (pure_freedom < kFewestPureFreedom || within <= 0.0) return std::nullopt;
  const double freedom = static_cast<double>(nodes.size());
  LackOfFit test;
  test.F = between / freedom / (within / pure_freedom);
  test.p = std::exp(ln_f_tail(test.F, freedom, pure_freedom));
  return test;
}

std::vector<DirectionSummary> directions_of(const Fit& fit, const Observations& data) {
  std::map<std::tuple<Channel, Axis, int>, std::vector<std::size_t>> groups;
  for (std::size_t k = 0; k < data.size(); ++k) groups[{data.channel(k), data.axis[k], -data.approach[k]}].push_back(k);
  const Repeats repeats = repeats_of(data);
  std::vector<DirectionSummary> list;
  for (const auto& [key, rows] : groups) {
    DirectionSummary one;
    one.sense = data.sense[rows.front()];
    one.axis = std::get<1>(key);
    one.approach = -std::get<2>(key);
    if (data.on_path(rows.front())) {
      one.path = data.path_name(rows.front());
      one.axes = axes_of(data.path_of(rows.front()));
    }
    one.readings = rows.size();
    std::vector<double> r;
    for (const std::size_t k : rows) {
      r.push_back(fit.residual[k]);
      one.bias_um += fit.residual[k] / static_cast<double>(rows.size());
      one.peak_um = std::max(one.peak_um, std::abs(fit.residual[k]));
    }
    one.rms_um = rms_of(r);
    one.lack_of_fit = lack_of_fit_of_rows(fit.residual, rows, repeats);
    list.push_back(one);
  }
  return list;
}

std::vector<WorstPlace> worst_of(const Fit& fit, const Observations& data, std::size_t count) {
  std::vector<std::size_t> order(data.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(
      order, [&](std::size_t a, std::size_t b) { return std::abs(fit.residual[a]) > std::abs(fit.residual[b]); });
  std::vector<WorstPlace> list;
  for (std::size_t i = 0; i < std::min(count, order.size()); ++i) {
    const std::size_t k = order[i];
    list.push_back({data.row[k], data.axis[k], data.sense[k], data.position_mm[k], data.approach[k], data.run[k],
                    data.reading[k] + data.of_map_in(k), fit.predicted[k] + data.of_map_in(k), fit.residual[k],
                    data.path_name(k), data.on_path(k) ? axes_of(data.path_of(k)) : std::string()});
  }
  return list;
}

/// One reading's worth of observations at a place that was not measured.
Observations one_place(const Model& model, const std::optional<params::Machine>& machine, const PointQuery& query) {
  laser::MeasurementSet set;
  laser::Reading reading;
  reading.axis = query.axis;
  reading.sense = query.sense;
  reading.rotary = query.rotary;
  (query.rotary ? reading.angle_deg : reading.position_mm) = query.position_mm;
  if (query.rotary) reading.position_mm = query.place_mm;
  reading.approach = static_cast<Approach>(query.approach);
  reading.time_s = query.time_s;
  reading.feed_mm_min = query.feed_mm_min;
  reading.load_kg = query.load_kg;
  for (const auto& [name, value] : query.sensors_degC) reading.sensors_degC[name] = value;
  set.readings.push_back(reading);
  Observations data = observations_of(set, model, machine);
  if (query.time_s) data.time_s = {*query.time_s};  // counts from the first reading of the fit, not of this one
  data.first_since_s = 0.0;
  return data;
}

}  // namespace

double variable_of(const Observations& data, std::size_t k, const std::string& name) {
  for (const Axis a : kAllAxes)
    if (name == data.position_name(a)) return data.position_mm[k][index_of(a)];
  if (data.on_path(k) && name == variable_along(data.path_of(k))) return data.along[k];
  if (name == "approach") return data.approach[k];
  if (name == "run") return data.run[k];
  if (name == "row") return data.row[k];
  if (name == "compensated") return data.compensated[k] ? 1.0 : 0.0;
  if (name == "time_s") return cell(data.time_s, k);
  if (name == "feed_mm_min") return cell(data.feed_mm_min, k);
  if (name == "load_kg") return cell(data.load_kg, k);
  if (name == "travel_since_reversal_mm") return cell(data.travel_since_reversal_mm, k);
  if (name == "pressure_hPa") return cell(data.pressure_hPa, k);
  if (name == "humidity_pct") return cell(data.humidity_pct, k);
  if (const auto sensor = data.sensors_degC.find(name); sensor != data.sensors_degC.end())
    return cell(sensor->second, k);
  if (const auto extra = data.extras.find(name); extra != data.extras.end()) return cell(extra->second, k);
  return kNotMeasured;
}

ResidualView residual_view(const Observations& data, const std::vector<double>& residual, const std::string& variable,
                           std::size_t most_bins) {
  ResidualView view;
  view.variable = variable;
  std::vector<std::pair<double, double>> pairs;
  for (std::size_t k = 0; k < data.size(); ++k)
    if (const double value = variable_of(data, k, variable); !std::isnan(value)) pairs.emplace_back(value, residual[k]);
  std::ranges::stable_sort(pairs, [](const auto& a, const auto& b) { return a.first < b.first; });
  if (pairs.empty() || pairs.front().first == pairs.back().first) return view;
  std::vector<double> values;
  for (const auto& pair : pairs) values.push_back(pair.first);
  const double tolerance = kSameValue * (values.back() - values.front());
  const bool by_value = distinct(values, tolerance).size() <= most_bins;
  for (std::size_t from = 0; from < pairs.size();) {
    std::size_t to = from + 1;
    const std::size_t wanted = by_value ? 1 : (pairs.size() + most_bins - 1) / most_bins;
    while (to < pairs.size() && (to - from < wanted || pairs[to].first - pairs[to - 1].first <= tolerance)) ++to;
    view.bins.push_back(bin_of(pairs, from, to));
    from = to;
  }
  return view;
}

namespace {

/// @param of  behind the name of each variable
void add_views(Comparison& comparison, const Observations& data, const std::vector<double>& residual,
               const std::string& of) {
  const Eigen::Map<const Eigen::VectorXd> values(residual.data(), static_cast<Eigen::Index>(residual.size()));
  for (const NamedShare& one : shares_by_variable(data, values, comparison.noise.noise_um)) {
    ResidualView view = residual_view(data, residual, one.variable);
    view.variable += of;
    view.share = one.share;
    if (view.bins.size() != 1) comparison.views.push_back(std::move(view));
  }
}

/// Of readings of several senses each variable for each of them too: residuals of two senses may cancel.
void add_views_by_sense(Comparison& comparison, const Fit& fit, const Observations& data) {
  std::map<std::string, std::vector<std::size_t>> rows;
  for (std::size_t k = 0; k < data.size(); ++k)
    rows[data.on_path(k) ? data.path_name(k) : std::string(name_of(data.sense[k]))].push_back(k);
  if (rows.size() < 2) return;
  for (const auto& [sense, of] : rows) {
    std::vector<double> residual;
    for (const std::size_t k : of) residual.push_back(fit.residual[k]);
    add_views(comparison, subset(data, of), residual, " of " + sense);
  }
}

}  // namespace

Comparison compare(const Fit& fit, const Observations& data, std::size_t worst_count) {
  Comparison comparison;
  comparison.rms_um = fit.rms_um;
  comparison.peak_um = fit.peak_um;
  comparison.rms_by_unit = fit.rms_by_unit;
  comparison.peak_by_unit = fit.peak_by_unit;
  comparison.noise = fit.noise;
  comparison.lack_of_fit = fit.lack_of_fit;
  comparison.outliers = fit.outliers;
  comparison.rotary = data.rotary;
  comparison.directions = directions_of(fit, data);
  comparison.worst = worst_of(fit, data, worst_count);
  add_views(comparison, data, fit.residual, "");
  add_views_by_sense(comparison, fit, data);
  return comparison;
}

Result<Breakdown> breakdown_at(const Model& fitted, const std::optional<params::Machine>& machine,
                               const PointQuery& query) {
  const Observations at = one_place(fitted, machine, query);
  Breakdown breakdown;
  for (const EffectInstance& effect : fitted.effects) {
    Model alone = fitted;
    alone.effects = {effect};
    ECS_TRY(value, predicted(alone, at));
    breakdown.shares.push_back({to_text(effect), value.front()});
    breakdown.total_um += value.front();
    if (value.front() == 0.0)
      breakdown.notes.push_back(
          fmt::format("{}: no contribution here, or the query lacks a quantity that it needs", to_text(effect)));
  }
  return breakdown;
}

Result<std::vector<VolumePoint>> predicted_volume(const Model& fitted, const params::Machine& machine,
                                                  std::size_t points_per_axis, int approach) {
  PerAxis<std::vector<double>> places;
  for (const Axis a : kAllAxes) {
    const auto& axis = machine.axes[index_of(a)];
    const std::size_t count = axis ? std::max<std::size_t>(points_per_axis, 2) : 1;
    for (std::size_t i = 0; i < count; ++i) {
      const double part = count > 1 ? static_cast<double>(i) / static_cast<double>(count - 1) : 0.0;
      places[index_of(a)].push_back(axis ? std::lerp(axis->travel_mm[0], axis->travel_mm[1], part) : 0.0);
    }
  }
  laser::MeasurementSet set;
  std::vector<VolumePoint> points;
  const auto moving = [&](Axis a) { return machine.axes[index_of(a)].has_value(); };
  for (const double x : places[0])
    for (const double y : places[1])
      for (const double z : places[2]) {
        points.push_back({{x, y, z}, {}});
        for (const Axis direction : kAllAxes) {
          laser::Reading reading;
          reading.axis = moving(direction) ? direction : *std::ranges::find_if(kAllAxes, moving);
          reading.sense = static_cast<Sense>(direction);
          reading.position_mm = {x, y, z};
          reading.approach = static_cast<Approach>(approach);
          reading.row = static_cast<int>(set.readings.size()) + 1;
          set.readings.push_back(reading);
        }
      }
  const Observations at = observations_of(set, fitted, machine);
  ECS_TRY(values, predicted(fitted, at));
  for (std::size_t k = 0; k < at.size(); ++k) {
    const auto place = static_cast<std::size_t>(at.row[k] - 1);
    points[place / kAxes].error_um[place % kAxes] = values[k];
  }
  return points;
}

}  // namespace ecs::model
