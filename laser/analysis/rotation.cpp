// Rotations from two translations.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/units.hpp"
#include "laser/analysis/curve_side.hpp"
#include "laser/analysis/process.hpp"
#include "laser/groups.hpp"

namespace ecs::laser {
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
    return problem(ProblemKind::refused, "the two lines hold different errors: expected the same axis and sense");
  if (is_rotation(first.sense))
    return problem(ProblemKind::refused,
                   fmt::format("expected translations EX, EY or EZ, found {}", ecs::name_of(first.sense)));
  ECS_TRY(lever, lever_of(first, second));
  const Axis observed = direction_of(first.sense);
  if (lever == observed)
    return problem(ProblemKind::refused,
                   fmt::format("the lines differ along {}, the direction of the readings: no rotation acts there",
                               letter_of(lever)));
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
                   fmt::format("the two lines have {} targets in common, expected two or more", result.points.size()));
  if (result.points.size() < first.points.size())
    result.notes.push_back(fmt::format("{} targets outside the other line's travel are left out",
                                       first.points.size() - result.points.size()));
  result.notes.emplace_back("the angle's own zero stands where the two lines were set to zero");
  return result;
}

}  // namespace ecs::laser
