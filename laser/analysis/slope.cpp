// Slopes and datums of curves, and squareness, which is a slope.
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "base/units.hpp"
#include "laser/analysis/curve_side.hpp"
#include "laser/analysis/process.hpp"

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
  return problem(ProblemKind::refused, fmt::format("a slope needs two targets or more, found {}", found));
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
    return problem(ProblemKind::refused,
                   fmt::format("the datum {} mm lies outside the measured travel {} to {} mm: measure there, or give "
                               "a position inside",
                               datum_mm, means.front().position_mm, means.back().position_mm));
  }
  Zeroed result{curve, at_datum->value};
  subtract(result.curve, {at_datum->value, 0.0});
  return result;
}

Result<Squareness> squareness_of(const Curve& indicator, const RemainingSlopes& remaining) {
  const SquarenessRule* const rule =
      is_rotation(indicator.sense) ? nullptr : rule_of(indicator.axis, direction_of(indicator.sense));
  if (rule == nullptr)
    return problem(ProblemKind::refused,
                   fmt::format("squareness needs readings across the axis run along (EX, EY, EZ), found {} along {}",
                               ecs::name_of(indicator.sense), letter_of(indicator.axis)));
  const auto means = mean_points(indicator);
  if (means.size() < 2) return too_few(means.size());
  const Fit fit = through_all(means);
  const double tilt = fit.line.slope_per_m - remaining.own_um_per_m - remaining.reference_um_per_m;
  return Squareness{rule->component, rule->sign * tilt, fit.slope_std_error_per_m, fit.line.slope_per_m};
}

}  // namespace ecs::laser
