// Slopes and datums of curves, and squareness, which is a slope; smoothing and the judgement of what it took away;
// curves on uniform grids; rotations from two translations.
#include "laser/analysis/process.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Core>
#include <fmt/format.h>

#include "base/linear/decompositions.hpp"
#include "base/units.hpp"
#include "laser/groups.hpp"

namespace ecs::laser {
namespace {

struct Fit {
  Line line;
  std::optional<double> slope_std_error_per_m;
};

Line line_through(double at_mm, double value, double slope_per_m) {
  return {value - slope_per_m * at_mm / kMmPerM, slope_per_m};
}

Fit through_ends(const std::vector<MeanPoint>& means) {
  const MeanPoint& first = means.front();
  const MeanPoint& last = means.back();
  const double span_m = (last.position_mm - first.position_mm) / kMmPerM;
  Fit fit{line_through(first.position_mm, first.value, (last.value - first.value) / span_m), std::nullopt};
  if (first.std_error && last.std_error)
    fit.slope_std_error_per_m = std::hypot(*first.std_error, *last.std_error) / span_m;
  return fit;
}

/// Straight line by least squares, centred; its slope's standard error from the residuals.
Fit through_all(const std::vector<MeanPoint>& means) {
  const auto count = static_cast<double>(means.size());
  double centre_mm = 0.0;
  double mean = 0.0;
  for (const MeanPoint& point : means) {
    centre_mm += point.position_mm / count;
    mean += point.value / count;
  }
  double spread = 0.0;  // m²
  double product = 0.0;
  for (const MeanPoint& point : means) {
    const double lever_m = (point.position_mm - centre_mm) / kMmPerM;
    spread += lever_m * lever_m;
    product += lever_m * (point.value - mean);
  }
  Fit fit{line_through(centre_mm, mean, product / spread), std::nullopt};
  if (means.size() < 3) return fit;
  double squares = 0.0;
  for (const MeanPoint& point : means) {
    const double left = point.value - value_at(fit.line, point.position_mm);
    squares += left * left;
  }
  fit.slope_std_error_per_m = std::sqrt(squares / (count - 2.0) / spread);
  return fit;
}

void subtract(Curve& curve, const Line& line) {
  for (CurvePoint& point : curve.points) {
    const double value = value_at(line, point.position_mm);
    if (point.forward) *point.forward -= value;
    if (point.reverse) *point.reverse -= value;
  }
}

struct SquarenessRule {
  Axis first;
  Axis second;
  Component component;
  double sign;
};
constexpr std::array<SquarenessRule, 3> kSquarenessRules{{{Axis::X, Axis::Y, Component::C0Y, -1.0},
                                                          {Axis::X, Axis::Z, Component::B0Z, 1.0},
                                                          {Axis::Y, Axis::Z, Component::A0Z, -1.0}}};

const SquarenessRule* rule_of(Axis along, Axis observed) {
  for (const SquarenessRule& rule : kSquarenessRules)
    if ((rule.first == along && rule.second == observed) || (rule.first == observed && rule.second == along))
      return &rule;
  return nullptr;
}

tl::unexpected<Problem> too_few(std::size_t found) {
  return problem(ProblemKind::refused, "a slope needs two targets or more, found {}", found);
}

}  // namespace

double value_at(const Line& line, double position_mm) { return line.offset + line.slope_per_m * position_mm / kMmPerM; }

Result<Levelled> levelled(const Curve& curve, SlopeMethod method) {
  Levelled result{curve, method, {}, std::nullopt};
  if (method == SlopeMethod::none) return result;
  const auto means = mean_points(curve);
  if (means.size() < 2) return too_few(means.size());
  const Fit fit = method == SlopeMethod::end_points ? through_ends(means) : through_all(means);
  result.removed = fit.line;
  result.slope_std_error_per_m = fit.slope_std_error_per_m;
  subtract(result.curve, fit.line);
  return result;
}

Result<Zeroed> zeroed_at(const Curve& curve, double datum_mm) {
  std::vector<SidePoint> means;
  for (const MeanPoint& point : mean_points(curve)) means.push_back({point.position_mm, point.value, 0, std::nullopt});
  const auto at_datum = point_at(means, datum_mm, curve.merge_tolerance_mm, false);
  if (!at_datum) {
    if (means.empty()) return problem(ProblemKind::refused, "a curve without points has no value at the datum");
    return problem(
        ProblemKind::refused,
        "the datum {} mm lies outside the measured travel {} to {} mm: measure there, or give a position inside",
        datum_mm, means.front().position_mm, means.back().position_mm);
  }
  Zeroed result{curve, at_datum->value};
  subtract(result.curve, {at_datum->value, 0.0});
  return result;
}

Result<Squareness> squareness_of(const Curve& indicator) {
  const SquarenessRule* const rule =
      is_rotation(indicator.sense) ? nullptr : rule_of(indicator.axis, direction_of(indicator.sense));
  if (rule == nullptr)
    return problem(ProblemKind::refused,
                   "squareness needs readings across the axis run along (EX, EY, EZ), found {} along {}",
                   ecs::name_of(indicator.sense), letter_of(indicator.axis));
  const auto means = mean_points(indicator);
  if (means.size() < 2) return too_few(means.size());
  const Fit fit = through_all(means);
  return Squareness{rule->component, rule->sign * fit.line.slope_per_m, fit.slope_std_error_per_m,
                    fit.line.slope_per_m};
}

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
  Eigen::MatrixXd powers(count, 3);
  for (Eigen::Index k = 0; k < count; ++k) {
    const double u = (side[reach.begin + static_cast<std::size_t>(k)].position_mm - side[at].position_mm) / width_mm;
    powers.row(k) << 1.0, u, u * u;
  }
  return pseudo_inverse(powers).row(0);
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
    if (side.size() < static_cast<std::size_t>(kFewestPoints))
      return problem(ProblemKind::refused, "the line has {} targets, smoothing needs {} or more: do not smooth it",
                     side.size(), kFewestPoints);
    if (reach.end - reach.begin < kFewestPoints)
      return problem(ProblemKind::refused,
                     "the window contains {} points at {} mm, smoothing needs {} or more: increase it (--smooth)",
                     reach.end - reach.begin, side[i].position_mm, kFewestPoints);
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
      return problem(
          ProblemKind::refused,
          "smoothing mean and reversal together needs both approaches at every target, one is missing at {} mm",
          point.position_mm);
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

namespace {

constexpr int kMostPoints = 1'000'000;

bool is_usable(const Grid& grid) {
  return std::isfinite(grid.start_mm) && std::isfinite(grid.increment_mm) && grid.increment_mm > 0.0 &&
         grid.count >= 1 && grid.count <= kMostPoints;
}

double position_of(const Grid& grid, int k) { return grid.start_mm + grid.increment_mm * k; }

}  // namespace

Result<Curve> resampled(const Curve& curve, const Grid& grid, Beyond beyond) {
  if (!is_usable(grid))
    return problem(ProblemKind::usage, "a grid needs an increment above 0 mm and 1 to 1 000 000 points");
  if (curve.points.empty())
    return problem(ProblemKind::refused, "a curve without points cannot be resampled to a grid");
  const auto forward = side_of(curve, Side::forward);
  const auto reverse = side_of(curve, Side::reverse);
  const bool hold = beyond == Beyond::hold_end_value;
  Curve result = curve;
  result.points.clear();
  for (int k = 0; k < grid.count; ++k) {
    CurvePoint point;
    point.position_mm = position_of(grid, k);
    set_side(point, Side::forward, point_at(forward, point.position_mm, curve.merge_tolerance_mm, hold));
    set_side(point, Side::reverse, point_at(reverse, point.position_mm, curve.merge_tolerance_mm, hold));
    if (point.forward.has_value() == forward.empty() || point.reverse.has_value() == reverse.empty())
      return problem(ProblemKind::refused,
                     "the grid point {} mm lies outside the measured travel {} to {} mm of an approach",
                     point.position_mm, curve.points.front().position_mm, curve.points.back().position_mm);
    result.points.push_back(point);
  }
  return result;
}

namespace {

/// The direction of the lever: the only axis in which the parked positions differ.
Result<Axis> lever_of(const Curve& first, const Curve& second) {
  std::optional<Axis> lever;
  for (const Axis axis : kAllAxes) {
    if (axis == first.axis ||
        std::abs(first.parked_mm[index_of(axis)] - second.parked_mm[index_of(axis)]) <= kSamePlace_mm)
      continue;
    if (lever)
      return problem(ProblemKind::refused, "the two lines differ in two axes: move one axis only between them");
    lever = axis;
  }
  if (!lever)
    return problem(ProblemKind::refused, "the two lines are the same: an angle needs two lines at a distance");
  return Result<Axis>(*lever);
}

/// The axis about which the rotation turns, and the sign of its lever: ε × r along `observed` is sign · ε · r_lever.
struct Rotation {
  Axis about = Axis::X;
  double sign = 1.0;
};

Rotation rotation_of(Axis observed, Axis lever) {
  const auto about = static_cast<Axis>(kAxes - index_of(observed) - index_of(lever));
  const bool cyclic = (index_of(about) + 1) % kAxes == index_of(lever);
  return {about, cyclic ? 1.0 : -1.0};
}

/// (a − b) · factor with its scatter, so that std/√count is its standard error.
SidePoint difference(const SidePoint& a, const SidePoint& b, double factor) {
  SidePoint result{a.position_mm, (a.value - b.value) * factor, std::min(a.count, b.count), std::nullopt};
  if (a.std && b.std && a.count > 0 && b.count > 0)
    result.std = std::abs(factor) * std::sqrt(result.count * (*a.std * *a.std / a.count + *b.std * *b.std / b.count));
  return result;
}

/// The differences of one side at the targets of `first` that the other line covers, times `factor`.
std::vector<SidePoint> differences(const Curve& first, const Curve& second, Side side, double factor) {
  const auto others = side_of(second, side);
  std::vector<SidePoint> result;
  for (const SidePoint& here : side_of(first, side))
    if (const auto there = point_at(others, here.position_mm, second.merge_tolerance_mm, false))
      result.push_back(difference(here, *there, factor));
  return result;
}

std::optional<SidePoint> exactly_at(const std::vector<SidePoint>& side, double position_mm) {
  const auto found = std::lower_bound(side.begin(), side.end(), position_mm,
                                      [](const SidePoint& point, double p) { return point.position_mm < p; });
  if (found == side.end() || found->position_mm != position_mm) return std::nullopt;
  return *found;
}

}  // namespace

Result<Curve> rotation_from(const Curve& first, const Curve& second) {
  if (first.axis != second.axis || first.sense != second.sense)
    return problem(ProblemKind::refused, "the two lines have different errors: expected the same axis and sense");
  if (is_rotation(first.sense))
    return problem(ProblemKind::refused, "expected translations EX, EY or EZ, found {}", ecs::name_of(first.sense));
  ECS_TRY(lever, lever_of(first, second));
  const Axis observed = direction_of(first.sense);
  if (lever == observed)
    return problem(ProblemKind::refused,
                   "the lines differ along {}, the direction of the readings: no rotation acts there",
                   letter_of(lever));
  const Rotation rotation = rotation_of(observed, lever);
  const double distance_mm = first.parked_mm[index_of(lever)] - second.parked_mm[index_of(lever)];
  Curve result;
  result.axis = first.axis;
  result.sense = static_cast<Sense>(static_cast<std::size_t>(Sense::EA) + index_of(rotation.about));
  result.parked_mm = first.parked_mm;
  result.merge_tolerance_mm = first.merge_tolerance_mm;
  result.approach_known = first.approach_known && second.approach_known;
  const double factor = rotation.sign * kMmPerM / distance_mm;
  const auto forward = differences(first, second, Side::forward, factor);
  const auto reverse = differences(first, second, Side::reverse, factor);
  for (const CurvePoint& at : first.points) {
    CurvePoint point;
    point.position_mm = at.position_mm;
    set_side(point, Side::forward, exactly_at(forward, at.position_mm));
    set_side(point, Side::reverse, exactly_at(reverse, at.position_mm));
    if (point.forward || point.reverse) result.points.push_back(point);
  }
  if (result.points.size() < 2)
    return problem(ProblemKind::refused,
                   "these are two parallel lines of {}, whose difference would give an angle; they have {} target{} in "
                   "common, expected two or more",
                   letter_of(first.axis), result.points.size(), result.points.size() == 1 ? "" : "s");
  if (result.points.size() < first.points.size())
    result.notes.push_back(fmt::format("{} targets outside the other line's travel are ignored",
                                       first.points.size() - result.points.size()));
  result.notes.emplace_back("the angle is zero where the two lines were set to zero");
  return result;
}

}  // namespace ecs::laser
