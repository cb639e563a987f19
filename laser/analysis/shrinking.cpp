#include "laser/analysis/shrinking.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "base/linear/decompositions.hpp"

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
  std::ranges::stable_sort(stops, [](const Stop& a, const Stop& b) { return a.position_mm < b.position_mm; });
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
  return PivotedQr(shapes).basis();
}

/// Sums over passes.
struct Sums {
  double smooth = 0.0, rest = 0.0;
  double smooth_columns = 0.0, rest_columns = 0.0, targets = 0.0, passes = 0.0;
  void take(const PassDeviations& pass) {
    const Eigen::MatrixXd columns = smooth_basis(pass.position_mm);
    const Eigen::VectorXd d =
        Eigen::Map<const Eigen::VectorXd>(pass.deviation.data(), static_cast<Eigen::Index>(pass.deviation.size()));
    const double left = without(columns, d).squaredNorm();
    smooth += d.squaredNorm() - left;
    rest += left;
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

namespace {

constexpr std::size_t kLeastBlock = 3;  ///< below three, shrinking gains nothing (Stein 1956)

/// Orthonormal cosines, DCT-II; its transpose turns back.
double cosine(std::size_t k, std::size_t i, std::size_t count) {
  const auto n = static_cast<double>(count);
  return std::sqrt((k == 0 ? 1.0 : 2.0) / n) *
         std::cos(std::numbers::pi * static_cast<double>(k) * (static_cast<double>(i) + 0.5) / n);
}

/// End of the octave that begins at `first`; a short rest belongs to it.
std::size_t block_end(std::size_t first, std::size_t count) {
  const std::size_t end = first == 1 ? 4 : 2 * first;
  return end + kLeastBlock > count ? count : end;
}

/// Shrinks values in place. @return the share of degrees of freedom that is left
double shrink(std::vector<double>& values, double variance, double freedom) {
  const std::size_t count = values.size();
  if (count < kLeastBlock + 1) return 1.0;
  std::vector<double> part(count, 0.0);
  for (std::size_t k = 0; k < count; ++k)
    for (std::size_t i = 0; i < count; ++i) part[k] += cosine(k, i, count) * values[i];
  double kept = 1.0;
  for (std::size_t first = 1; first < count;) {
    const std::size_t end = block_end(first, count);
    double square = 0.0;
    for (std::size_t k = first; k < end; ++k) square += part[k] * part[k];
    const auto size = static_cast<double>(end - first);
    const double noise = (size - 2.0) * variance * freedom / (freedom + 2.0);  // of an estimated variance
    const double factor = square > 0.0 ? std::max(0.0, 1.0 - noise / square) : 1.0;
    for (std::size_t k = first; k < end; ++k) part[k] *= factor;
    kept += factor * size;
    first = end;
  }
  std::ranges::fill(values, 0.0);
  for (std::size_t k = 0; k < count; ++k)
    for (std::size_t i = 0; i < count; ++i) values[i] += cosine(k, i, count) * part[k];
  return kept / static_cast<double>(count);
}

/// The same of what a straight line over the positions leaves.
double shrink_off_line(std::vector<double>& values, const std::vector<double>& position_mm, double variance,
                       double freedom) {
  const auto count = static_cast<double>(values.size());
  double mean_p = 0.0, mean = 0.0, square = 0.0, product = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    mean_p += position_mm[i] / count;
    mean += values[i] / count;
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    square += (position_mm[i] - mean_p) * (position_mm[i] - mean_p);
    product += (position_mm[i] - mean_p) * (values[i] - mean);
  }
  const double slope = square > 0.0 ? product / square : 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) values[i] -= mean + slope * (position_mm[i] - mean_p);
  const double kept = shrink(values, variance, freedom);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] += mean + slope * (position_mm[i] - mean_p);
  return kept;
}

using SideMember = std::optional<double> CurvePoint::*;

/// One approach on its own.
double shrink_side(Curve& curve, SideMember side, double variance, double freedom) {
  std::vector<double> values, position_mm;
  for (const CurvePoint& point : curve.points) {
    if (!(point.*side)) continue;
    values.push_back(*(point.*side));
    position_mm.push_back(point.position_mm);
  }
  const double kept = shrink_off_line(values, position_mm, variance, freedom);
  std::size_t next = 0;
  for (CurvePoint& point : curve.points)
    if (point.*side) point.*side = values[next++];
  return kept;
}

/// Mean and half of the reversal error; each has half of the variance of one approach.
double shrink_both(Curve& curve, double variance, double freedom) {
  std::vector<double> mean, half, position_mm;
  for (const CurvePoint& point : curve.points) {
    mean.push_back(0.5 * (*point.forward + *point.reverse));
    half.push_back(0.5 * (*point.forward - *point.reverse));
    position_mm.push_back(point.position_mm);
  }
  const double kept = shrink_off_line(mean, position_mm, 0.5 * variance, freedom);
  const double kept_half = shrink(half, 0.5 * variance, freedom);
  for (std::size_t i = 0; i < mean.size(); ++i) {
    curve.points[i].forward = mean[i] + half[i];
    curve.points[i].reverse = mean[i] - half[i];
  }
  return 0.5 * (kept + kept_half);
}

}  // namespace

Shrunk shrunk(const Curve& curve, const Repeatability& repeatability) {
  const double variance = repeatability.reading * repeatability.reading / std::max(1.0, repeatability.repeats);
  const double freedom = repeatability.reading_freedom;
  Shrunk out{curve, 0.0, 1.0};
  const bool both =
      std::ranges::all_of(curve.points, [](const CurvePoint& point) { return point.forward && point.reverse; });
  if (both && curve.approach_known) {
    out.kept = shrink_both(out.curve, variance, freedom);
  } else {
    out.kept = shrink_side(out.curve, &CurvePoint::forward, variance, freedom);
    shrink_side(out.curve, &CurvePoint::reverse, variance, freedom);
  }
  double sum = 0.0, count = 0.0;
  for (std::size_t i = 0; i < curve.points.size(); ++i)
    for (const SideMember side : {&CurvePoint::forward, &CurvePoint::reverse})
      if (const auto before = curve.points[i].*side) {
        sum += std::pow(*before - *(out.curve.points[i].*side), 2);
        count += 1.0;
      }
  if (count > 0.0) out.removed_rms = std::sqrt(sum / count);
  return out;
}

}  // namespace ecs::laser
