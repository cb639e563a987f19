#include "modules/controllers/program_path.hpp"

#include <algorithm>
#include <numbers>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "base/units.hpp"
#include "core/tick.hpp"

namespace ecs::controllers {
namespace {

constexpr double kArcMismatch_mm = 0.02;  ///< of the two radii of an arc; a tenth of a thou is 0.0025 mm
constexpr double kSmallestRadius_mm = 1e-3;
constexpr double kLeastDirectionChange_mm = 0.001;  ///< path behind a turn on which the approach changes, at least
constexpr std::size_t kMostSamples = 2'000'000;     ///< of one move
constexpr double kSamplesOfSagitta = 8.0;  ///< a sample of an arc is off its chord by this part of the tolerance

}  // namespace

Vector3 NominalPath::at(double s) const {
  if (s >= 1.0) return to_mm;
  Vector3 place = sum_of(from_mm, sum_of(to_mm, from_mm, -1.0), s);
  if (!arc || s <= 0.0) return place;
  const double radius = std::lerp(arc->radius_from, arc->radius_to, s);
  place[arc->u] = arc->centre_u + radius * std::cos(arc->angle + s * arc->sweep);
  place[arc->v] = arc->centre_v + radius * std::sin(arc->angle + s * arc->sweep);
  return place;
}

double NominalPath::length_mm() const {
  if (!arc) return length_of(sum_of(to_mm, from_mm, -1.0));
  return std::hypot(std::abs(arc->sweep) * arc->radius_from, to_mm[arc->w] - from_mm[arc->w]);
}

std::vector<double> NominalPath::turns() const {
  std::vector<double> at{0.0, 1.0};
  if (!arc) return at;
  constexpr double kQuarter = std::numbers::pi / 2.0;
  const double low = std::min(arc->angle, arc->angle + arc->sweep), high = low + std::abs(arc->sweep);
  for (int quarter = static_cast<int>(std::ceil(low / kQuarter)); quarter * kQuarter < high; ++quarter) {
    const double s = (quarter * kQuarter - arc->angle) / arc->sweep;
    if (s > 1e-9 && s < 1.0 - 1e-9) at.push_back(s);
  }
  std::sort(at.begin(), at.end());
  return at;
}

Result<ArcPath> arc_of(const BlockOfWords& block, const ModalState& modal, const NominalPath& path) {
  ArcPath arc;
  if (modal.plane == 18) arc.u = 2, arc.v = 0, arc.w = 1;
  if (modal.plane == 19) arc.u = 1, arc.v = 2, arc.w = 0;
  const auto refuse = [](std::string why) { return problem(ProblemKind::bad_input, std::move(why)); };
  if (block.has_centre() == (block.radius != nullptr))
    return refuse(block.radius ? "expected the centre of the arc (I, J, K) or its radius (R), found both"
                               : "expected the centre of the arc (I, J, K) or its radius (R), found none");
  if (block.centre[arc.w]) return refuse("expected the centre of the arc in its plane (G17 I J, G18 I K, G19 J K)");
  if (block.repeats || (block.turns && block.turns->value != 1.0))
    return refuse("arcs of several turns are not supported; write the turns one by one");
  const bool clockwise = modal.motion == 20;
  const double along = path.to_mm[arc.u] - path.from_mm[arc.u], across = path.to_mm[arc.v] - path.from_mm[arc.v];
  const double chord_mm = std::hypot(along, across);
  if (block.radius) {
    const double radius_mm = block.radius->value * modal.unit_mm;
    const double short_by_mm = 0.5 * chord_mm - std::abs(radius_mm);
    if (chord_mm < kSmallestRadius_mm) return refuse("a radius alone does not define a full circle; use I, J, K");
    if (short_by_mm > kArcMismatch_mm)
      return refuse(fmt::format("a radius of {:.6g} mm cannot span {:.6g} mm", std::abs(radius_mm), chord_mm));
    const double height = std::sqrt(std::max(0.0, radius_mm * radius_mm - 0.25 * chord_mm * chord_mm));
    const double left = clockwise == (radius_mm > 0.0) ? -1.0 : 1.0;
    arc.centre_u = path.from_mm[arc.u] + 0.5 * along - left * height * across / chord_mm;
    arc.centre_v = path.from_mm[arc.v] + 0.5 * across + left * height * along / chord_mm;
  } else {
    const auto offset_mm = [&](std::size_t a) {
      return block.centre[a] ? block.centre[a]->value * modal.unit_mm : 0.0;
    };
    arc.centre_u = path.from_mm[arc.u] + offset_mm(arc.u);
    arc.centre_v = path.from_mm[arc.v] + offset_mm(arc.v);
  }
  const auto angle_at = [&](const Vector3& p) { return std::atan2(p[arc.v] - arc.centre_v, p[arc.u] - arc.centre_u); };
  const auto radius_at = [&](const Vector3& p) { return std::hypot(p[arc.v] - arc.centre_v, p[arc.u] - arc.centre_u); };
  arc.radius_from = radius_at(path.from_mm);
  arc.radius_to = radius_at(path.to_mm);
  if (arc.radius_from < kSmallestRadius_mm || std::abs(arc.radius_from - arc.radius_to) > kArcMismatch_mm)
    return refuse(
        fmt::format("the start of the arc is {:.4f} mm from its centre, its end {:.4f} mm; expected the "
                    "same radius within {} mm",
                    arc.radius_from, arc.radius_to, kArcMismatch_mm));
  if (arc.radius_from > kFarthest_mm) return refuse("no machine moves on so large an arc");
  arc.angle = angle_at(path.from_mm);
  arc.sweep = angle_at(path.to_mm) - arc.angle;
  if (chord_mm < kSmallestRadius_mm) arc.sweep = 0.0;
  if (clockwise)
    arc.sweep -= arc.sweep >= 0.0 ? kTurn : 0.0;
  else
    arc.sweep += arc.sweep <= 0.0 ? kTurn : 0.0;
  return arc;
}

void AxisSense::arrive(double position_mm, double deadband_mm) {
  if (!extreme_mm) {
    extreme_mm = position_mm;
  } else if (approach != Approach::unknown) {
    approach = sensed_approach(approach, position_mm, deadband_mm, *extreme_mm);
  } else if (std::abs(position_mm - *extreme_mm) > deadband_mm) {
    approach = position_mm > *extreme_mm ? Approach::forward : Approach::reverse;
    extreme_mm = position_mm;
  }
}

std::optional<double> AxisSense::change_between(double from_mm, double to_mm, double deadband_mm) const {
  const auto changed = [&](double part) {
    AxisSense sense = *this;
    sense.arrive(std::lerp(from_mm, to_mm, part), deadband_mm);
    return sense.approach != approach;
  };
  if (!changed(1.0)) return std::nullopt;
  double before = 0.0, behind = 1.0;
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (before + behind);
    (changed(middle) ? behind : before) = middle;
  }
  return behind;
}

std::vector<double> steps_along(const NominalPath& path, const ProgramSettings& settings) {
  double step_mm = settings.sample_mm;
  if (path.arc)
    step_mm =
        std::min(step_mm, std::sqrt(8.0 / kSamplesOfSagitta * path.arc->radius_from * 1e-3 * settings.tolerance_um));
  const double steps = std::clamp(std::ceil(path.length_mm() / step_mm), 2.0, static_cast<double>(kMostSamples));
  std::vector<double> at = path.turns();
  for (std::size_t i = 1; i < static_cast<std::size_t>(steps); ++i) at.push_back(static_cast<double>(i) / steps);
  std::sort(at.begin(), at.end());
  at.erase(std::unique(at.begin(), at.end()), at.end());
  return at;
}

SensedPath sensed_along(const NominalPath& path, const std::vector<double>& steps, const std::vector<Vector3>& mean_mm,
                        PerAxis<AxisSense> sense, const PerAxis<double>& deadband_mm) {
  const double length_mm = path.length_mm();
  std::vector<PathSample> all{{0.0, {path.from_mm, approaches_of(sense)}}};
  for (std::size_t k = 1; k < steps.size(); ++k) {
    const double from = steps[k - 1], length = steps[k] - from;
    std::vector<double> at{steps[k]};
    for (std::size_t a = 0; a < kAxes; ++a)
      if (const auto part = sense[a].change_between(mean_mm[k - 1][a], mean_mm[k][a], deadband_mm[a])) {
        const double ramp_mm = std::max(2.0 * deadband_mm[a], kLeastDirectionChange_mm);
        const double change = std::max(from + *part * length, from + kLeastDirectionChange_mm / length_mm);
        at.push_back(std::min(change, steps[k]));
        at.push_back(std::max(from, change - ramp_mm / length_mm));
      }
    std::sort(at.begin(), at.end());
    for (const double s : at) {
      if (s <= all.back().s) continue;
      const Vector3 there_mm = sum_of(mean_mm[k - 1], sum_of(mean_mm[k], mean_mm[k - 1], -1.0), (s - from) / length);
      for (std::size_t a = 0; a < kAxes; ++a) sense[a].arrive(there_mm[a], deadband_mm[a]);
      all.push_back({s, {path.at(s), approaches_of(sense)}});
    }
  }
  return {std::move(all), sense};
}

std::vector<std::size_t> ends_of_pieces(const std::vector<Vector3>& points, const std::vector<double>& s,
                                        double tolerance_mm) {
  std::vector<std::size_t> ends;
  std::vector<std::pair<std::size_t, std::size_t>> open{{0, points.size() - 1}};
  while (!open.empty()) {
    const auto [a, b] = open.back();
    open.pop_back();
    std::size_t worst = a;
    double most_mm = tolerance_mm;
    for (std::size_t i = a + 1; i < b; ++i) {
      const double part = s[b] > s[a] ? (s[i] - s[a]) / (s[b] - s[a]) : 0.0;
      const Vector3 on_line = sum_of(points[a], sum_of(points[b], points[a], -1.0), part);
      const double off_mm = length_of(sum_of(points[i], on_line, -1.0));
      if (off_mm > most_mm) most_mm = off_mm, worst = i;
    }
    if (worst == a) {
      ends.push_back(b);
      continue;
    }
    open.emplace_back(worst, b);
    open.emplace_back(a, worst);
  }
  return ends;
}

}  // namespace ecs::controllers
