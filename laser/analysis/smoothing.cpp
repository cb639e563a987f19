// Smoothing of curves and the judgement of what it took away.
#include <algorithm>
#include <cmath>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "laser/analysis/curve_side.hpp"
#include "laser/analysis/process.hpp"

namespace ecs::laser {
namespace {

constexpr std::size_t kFewestPoints = 4;  ///< one more than a parabola has coefficients

struct Window {
  std::optional<double> mm;
  std::optional<int> points;
};

/// First and one-past-last index.
struct Reach {
  std::size_t begin = 0;
  std::size_t end = 0;
};

Reach reach_in_points(std::size_t count, std::size_t at, std::size_t points) {
  const std::size_t width = std::min(points, count);
  const std::size_t wanted = at < (width - 1) / 2 ? 0 : at - (width - 1) / 2;
  const std::size_t begin = std::min(wanted, count - width);
  return {begin, begin + width};
}

Reach reach_in_mm(const std::vector<SidePoint>& side, std::size_t at, double width_mm) {
  const double slack_mm = 1e-9 * width_mm;
  const double first_mm = side.front().position_mm;
  const double last_mm = side.back().position_mm;
  const double latest_mm = std::max(first_mm, last_mm - width_mm);
  const double from_mm = std::clamp(side[at].position_mm - width_mm / 2.0, first_mm, latest_mm);
  const auto before = [](const SidePoint& point, double p) { return point.position_mm < p; };
  const auto begin = std::lower_bound(side.begin(), side.end(), from_mm - slack_mm, before);
  const auto end = std::lower_bound(side.begin(), side.end(), from_mm + width_mm + slack_mm, before);
  return {static_cast<std::size_t>(begin - side.begin()), static_cast<std::size_t>(end - side.begin())};
}

Reach reach_of(const std::vector<SidePoint>& side, std::size_t at, const Window& window) {
  if (window.mm) return reach_in_mm(side, at, *window.mm);
  return reach_in_points(side.size(), at, static_cast<std::size_t>(*window.points));
}

/// Weights of the points in reach for the parabola's value at point `at`.
Eigen::VectorXd weights_of(const std::vector<SidePoint>& side, std::size_t at, Reach reach) {
  const auto count = static_cast<Eigen::Index>(reach.end - reach.begin);
  const double width_mm = side[reach.end - 1].position_mm - side[reach.begin].position_mm;
  Eigen::MatrixX3d powers(count, 3);
  for (Eigen::Index k = 0; k < count; ++k) {
    const double u = (side[reach.begin + static_cast<std::size_t>(k)].position_mm - side[at].position_mm) / width_mm;
    powers.row(k) << 1.0, u, u * u;
  }
  const Eigen::Matrix3d normal = powers.transpose() * powers;
  return powers * normal.ldlt().solve(Eigen::Vector3d::UnitX());
}

/// Smoothed values of one side and the degrees of freedom removed: trace((I − H)ᵀ(I − H)).
struct Smooth {
  std::vector<double> values;
  double removed_freedom = 0.0;
};

Result<Smooth> smooth(const std::vector<SidePoint>& side, const Window& window) {
  Smooth result;
  for (std::size_t i = 0; i < side.size(); ++i) {
    const Reach reach = reach_of(side, i, window);
    if (reach.end - reach.begin < kFewestPoints)
      return problem(ProblemKind::refused,
                     fmt::format("the window holds {} points at {} mm, smoothing needs {} or more: widen it",
                                 reach.end - reach.begin, side[i].position_mm, kFewestPoints));
    const Eigen::VectorXd weights = weights_of(side, i, reach);
    double value = 0.0;
    for (std::size_t k = reach.begin; k < reach.end; ++k) {
      const double weight = weights[static_cast<Eigen::Index>(k - reach.begin)];
      value += weight * side[k].value;
      const double left = (k == i ? 1.0 : 0.0) - weight;
      result.removed_freedom += left * left;
    }
    result.values.push_back(value);
  }
  return result;
}

/// Mean and reversal error as sides; every point must have both approaches.
Result<Curve> as_mean_and_reversal(const Curve& curve) {
  Curve turned = curve;
  for (CurvePoint& point : turned.points) {
    if (!point.forward || !point.reverse)
      return problem(ProblemKind::refused,
                     fmt::format("smoothing mean and reversal together needs both approaches at every target, "
                                 "one is missing at {} mm",
                                 point.position_mm));
    const double forward = *point.forward;
    point.forward = (forward + *point.reverse) / 2.0;
    point.reverse = forward - *point.reverse;
  }
  return turned;
}

void turn_back(Curve& curve) {
  for (CurvePoint& point : curve.points) {
    const double mean = *point.forward;
    const double reversal = *point.reverse;
    point.forward = mean + reversal / 2.0;
    point.reverse = mean - reversal / 2.0;
  }
}

void put(Curve& curve, Side side, const std::vector<double>& values) {
  std::size_t next = 0;
  for (CurvePoint& point : curve.points) {
    auto& place = side == Side::forward ? point.forward : point.reverse;
    if (place) place = values[next++];
  }
}

/// Smooths both sides in place; answers the mean degrees of freedom removed, summed over the sides.
Result<double> smooth_sides(Curve& curve, const Window& forward, const Window& reverse) {
  double freedom = 0.0;
  for (const Side side : {Side::forward, Side::reverse}) {
    const auto points = side_of(curve, side);
    if (points.empty()) continue;
    ECS_TRY(result, smooth(points, side == Side::forward ? forward : reverse));
    put(curve, side, result.values);
    freedom += result.removed_freedom;
  }
  return freedom;
}

/// 99 % point of F with n and m degrees of freedom (Wilson-Hilferty: F^(1/3) is nearly normal); nothing below m = 5.
std::optional<double> F_99_of(double n, double m) {
  constexpr double kNormal99 = 2.3263478740408408;
  if (n < 1.0 || m < 5.0) return std::nullopt;
  const double a = 2.0 / (9.0 * m);
  const double b = 2.0 / (9.0 * n);
  const double z2 = kNormal99 * kNormal99;
  const double below = (1.0 - a) * (1.0 - a) - a * z2;
  const double root = std::sqrt((1.0 - a) * (1.0 - a) * b + (1.0 - b) * (1.0 - b) * a - a * b * z2);
  return std::pow(((1.0 - a) * (1.0 - b) + kNormal99 * root) / below, 3.0);
}

/// Sums over the points and approaches that count (unknown approach: the same readings count once).
struct Removal {
  double squares = 0.0;
  int count = 0;
  double noise_squares = 0.0;  ///< variances of the means
  int noise_count = 0;
  double noise_freedom = 0.0;
};

void take(Removal& removal, Smoothed& result, const SidePoint& before, double after) {
  const double removed = before.value - after;
  removal.squares += removed * removed;
  ++removal.count;
  if (std::abs(removed) > result.removed_peak) {
    result.removed_peak = std::abs(removed);
    result.removed_peak_position_mm = before.position_mm;
  }
  if (!before.std || before.count < 2) return;
  removal.noise_squares += *before.std * *before.std / before.count;
  ++removal.noise_count;
  removal.noise_freedom += before.count - 1;
}

void judge(Smoothed& result, const Curve& before, double freedom) {
  Removal removal;
  for (const Side side : {Side::forward, Side::reverse}) {
    if (side == Side::reverse && !before.approach_known) continue;
    const auto from = side_of(before, side);
    const auto to = side_of(result.curve, side);
    for (std::size_t i = 0; i < from.size(); ++i) take(removal, result, from[i], to[i].value);
  }
  if (removal.count == 0) return;
  if (!before.approach_known) freedom /= 2.0;
  result.removed_rms = std::sqrt(removal.squares / removal.count);
  if (removal.noise_count == 0 || freedom <= 0.0) return;
  const double noise_variance = removal.noise_squares / removal.noise_count;
  result.noise_rms = std::sqrt(noise_variance);
  if (noise_variance <= 0.0) return;
  result.F = removal.squares / freedom / noise_variance;
  result.F_99 = F_99_of(freedom, removal.noise_freedom);
  if (result.F_99) result.taken = *result.F > *result.F_99 ? Taken::signal : Taken::noise;
}

bool is_usable(const Window& window) {
  return (window.mm.has_value() != window.points.has_value()) &&
         (!window.mm || (*window.mm > 0.0 && std::isfinite(*window.mm))) && (!window.points || *window.points > 0);
}

}  // namespace

Result<Smoothed> smoothed(const Curve& curve, const Smoothing& how) {
  const Window window{how.window_mm, how.window_points};
  const bool own = curve.approach_known && (how.reversal_window_mm || how.reversal_window_points);
  const Window reversal = own ? Window{how.reversal_window_mm, how.reversal_window_points} : window;
  if (!is_usable(window) || !is_usable(reversal))
    return problem(ProblemKind::usage, "smoothing needs one window above 0, in mm or in points");
  if (own && !how.common)
    return problem(ProblemKind::usage, "a window for the reversal error needs smoothing of mean and reversal together");
  Smoothed result{curve, 0.0, 0.0, 0.0, std::nullopt, std::nullopt, std::nullopt, Taken::unknown};
  if (how.common) {
    ECS_TRY(turned, as_mean_and_reversal(curve));
    result.curve = std::move(turned);
  }
  ECS_TRY(freedom, smooth_sides(result.curve, window, reversal));
  if (how.common) turn_back(result.curve);
  judge(result, curve, freedom);
  return result;
}

}  // namespace ecs::laser
