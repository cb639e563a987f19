#include "laser/analysis/repeatability.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include <Eigen/QR>

namespace ecs::laser {
namespace {

/// Deviations of one pass from the means of its targets, scaled to the variance of single readings.
struct PassDeviations {
  std::vector<double> position_mm;
  std::vector<double> deviation;
};

/// Every pass of one approach.
std::vector<PassDeviations> passes_of(const MeasurementSet& set, const Group& group, Approach approach,
                                      double tolerance_mm) {
  struct Stop {
    double position_mm;
    int run;
    double error;
  };
  std::vector<Stop> stops;
  for (const std::size_t i : group.readings)
    if (const Reading& reading = set.readings[i]; reading.approach == approach)
      stops.push_back({target_of(reading), reading.run, reading.error});
  std::stable_sort(stops.begin(), stops.end(),
                   [](const Stop& a, const Stop& b) { return a.position_mm < b.position_mm; });
  std::map<int, PassDeviations> passes;
  for (std::size_t first = 0; first < stops.size();) {
    std::size_t last = first;
    double sum = 0.0;
    while (last < stops.size() && stops[last].position_mm - stops[first].position_mm <= tolerance_mm)
      sum += stops[last++].error;
    const auto count = static_cast<double>(last - first);
    if (count > 1.0)
      for (std::size_t i = first; i < last; ++i) {
        PassDeviations& pass = passes[stops[i].run];
        pass.position_mm.push_back(stops[i].position_mm);
        pass.deviation.push_back((stops[i].error - sum / count) * std::sqrt(count / (count - 1.0)));
      }
    first = last;
  }
  std::vector<PassDeviations> list;
  for (auto& [run, pass] : passes) list.push_back(std::move(pass));
  return list;
}

/// Orthonormal columns that span the smooth shapes, as many as these targets can bear.
Eigen::MatrixXd smooth_basis(const std::vector<double>& position_mm) {
  const auto targets = static_cast<Eigen::Index>(position_mm.size());
  const Eigen::Index count = targets >= 12 ? 6 : targets >= 6 ? 2 : targets >= 3 ? 1 : 0;
  Eigen::MatrixXd shapes(targets, count);
  const double first = position_mm.front(), length = position_mm.back() - position_mm.front();
  for (Eigen::Index i = 0; i < targets; ++i) {
    const double t = length > 0.0 ? (position_mm[static_cast<std::size_t>(i)] - first) / length : 0.0;
    const double turn = 2.0 * std::numbers::pi * t;
    const double values[] = {1.0, t, std::cos(turn), std::sin(turn), std::cos(2.0 * turn), std::sin(2.0 * turn)};
    for (Eigen::Index c = 0; c < count; ++c) shapes(i, c) = values[c];
  }
  if (count == 0) return shapes;
  return Eigen::HouseholderQR<Eigen::MatrixXd>(shapes).householderQ() * Eigen::MatrixXd::Identity(targets, count);
}

/// Sums over passes.
struct Sums {
  double smooth = 0.0, rest = 0.0;
  double smooth_columns = 0.0, rest_columns = 0.0, targets = 0.0, passes = 0.0;
  void take(const PassDeviations& pass) {
    const Eigen::MatrixXd columns = smooth_basis(pass.position_mm);
    const Eigen::Map<const Eigen::VectorXd> d(pass.deviation.data(), static_cast<Eigen::Index>(pass.deviation.size()));
    const double in_columns = (columns.transpose() * d).squaredNorm();
    smooth += in_columns;
    rest += d.squaredNorm() - in_columns;
    smooth_columns += static_cast<double>(columns.cols());
    rest_columns += static_cast<double>(d.size() - columns.cols());
    targets += static_cast<double>(d.size());
    passes += 1.0;
  }
};

}  // namespace

std::optional<Repeatability> repeatability_of(const MeasurementSet& set, const Group& group) {
  const double tolerance_mm = target_tolerance_mm(set, group);
  Sums sums;
  Repeatability out;
  double readings = 0.0, places = 0.0;
  for (const Approach approach : {Approach::forward, Approach::reverse, Approach::unknown}) {
    if (approach == Approach::unknown && has_known_approach(set, group)) continue;
    const auto passes = passes_of(set, group, approach, tolerance_mm);
    if (passes.size() < 2) continue;
    for (const PassDeviations& pass : passes) sums.take(pass);
    out.pass_freedom += static_cast<int>(passes.size()) - 1;
    readings += static_cast<double>(passes.size());
    places += 1.0;
  }
  if (sums.rest_columns < 1.0) return std::nullopt;
  const double variance = sums.rest / sums.rest_columns;
  const double beyond = sums.smooth - sums.smooth_columns * variance;
  out.reading = std::sqrt(variance);
  out.pass = std::sqrt(std::max(0.0, beyond / sums.targets));
  out.repeats = readings / places;
  out.reading_freedom = static_cast<int>(sums.rest_columns * (1.0 - 1.0 / out.repeats));
  return out;
}

}  // namespace ecs::laser
