#include "laser/analysis/curve.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace ecs::laser {
namespace {

constexpr double kSameTarget_mm = 1e-3;

bool has_condition(const Exclusion& e) { return e.row || e.run || e.axis || e.sense || e.approach || e.target_mm; }

template <class T>
bool fits(const std::optional<T>& wanted, const T& found) {
  return !wanted || *wanted == found;
}

bool fits(const Exclusion& e, const Reading& reading) {
  return has_condition(e) && fits(e.row, reading.row) && fits(e.run, reading.run) && fits(e.axis, reading.axis) &&
         fits(e.sense, reading.sense) && fits(e.approach, reading.approach) &&
         (!e.target_mm || std::abs(*e.target_mm - target_mm(reading)) <= kSameTarget_mm);
}

std::optional<double> squared_error(int count, std::optional<double> deviation) {
  if (!deviation || count < 1) return std::nullopt;
  return *deviation * *deviation / count;
}

CurvePoint point_of(const TargetReadings& target, bool approach_known) {
  const auto& forward = approach_known ? target.forward : target.undirected;
  const auto& reverse = approach_known ? target.reverse : target.undirected;
  return {target.position_mm,
          mean_of(forward),
          mean_of(reverse),
          static_cast<int>(forward.size()),
          static_cast<int>(reverse.size()),
          deviation_of(forward),
          deviation_of(reverse)};
}

}  // namespace

std::optional<double> mean_of(const CurvePoint& point) {
  if (point.forward && point.reverse) return (*point.forward + *point.reverse) / 2.0;
  return point.forward ? point.forward : point.reverse;
}

std::optional<double> mean_std_error(const CurvePoint& point, bool approach_known) {
  const auto forward = squared_error(point.forward_count, point.forward_std);
  const auto reverse = squared_error(point.reverse_count, point.reverse_std);
  if ((point.forward && !forward) || (point.reverse && !reverse) || (!forward && !reverse)) return std::nullopt;
  if (!forward || !reverse || !approach_known) return std::sqrt(forward ? *forward : *reverse);
  return std::sqrt(*forward + *reverse) / 2.0;
}

std::vector<MeanPoint> mean_points(const Curve& curve) {
  const auto both =
      std::ranges::count_if(curve.points, [](const CurvePoint& point) { return point.forward && point.reverse; });
  std::vector<MeanPoint> means;
  for (const CurvePoint& point : curve.points)
    if (const auto mean = mean_of(point); mean && (both < 2 || (point.forward && point.reverse)))
      means.push_back({point.position_mm, *mean, mean_std_error(point, curve.approach_known)});
  return means;
}

Selection selected(const MeasurementSet& set, const std::vector<Exclusion>& exclusions) {
  Selection selection{set, std::vector<std::size_t>(exclusions.size(), 0), {}};
  std::erase_if(selection.chosen.readings, [&](const Reading& reading) {
    bool out = false;
    for (std::size_t i = 0; i < exclusions.size(); ++i) {
      if (!fits(exclusions[i], reading)) continue;
      ++selection.left_out[i];
      out = true;
    }
    return out;
  });
  for (std::size_t i = 0; i < exclusions.size(); ++i)
    if (selection.left_out[i] == 0) selection.notes.push_back(fmt::format("exclusion {} fits no reading", i + 1));
  return selection;
}

Result<Curve> averaged(const MeasurementSet& set, const Group& group, std::optional<double> tolerance_mm) {
  if (group.readings.empty()) return problem(ProblemKind::refused, "expected readings to average, found none");
  if (tolerance_mm && !(*tolerance_mm >= 0.0))
    return problem(ProblemKind::usage, "expected a tolerance of 0 mm or more for targets");
  Curve curve;
  curve.axis = group.axis;
  curve.sense = group.sense;
  curve.parked_mm = group.parked_mm;
  curve.merge_tolerance_mm = tolerance_mm.value_or(target_tolerance_mm(set, group));
  curve.approach_known = has_known_approach(set, group);
  std::size_t left_out = 0;
  for (const TargetReadings& target : targets_of(set, group, curve.merge_tolerance_mm)) {
    if (curve.approach_known) left_out += target.undirected.size();
    const CurvePoint point = point_of(target, curve.approach_known);
    if (point.forward || point.reverse) curve.points.push_back(point);
  }
  if (left_out > 0)
    curve.notes.push_back(fmt::format("{} reading{} of unknown approach {} ignored", left_out, left_out == 1 ? "" : "s",
                                      left_out == 1 ? "is" : "are"));
  if (!curve.approach_known) curve.notes.emplace_back("approach unknown: forward and reverse are the same");
  return curve;
}

std::vector<SidePoint> side_of(const Curve& curve, Side side) {
  std::vector<SidePoint> points;
  for (const CurvePoint& p : curve.points) {
    if (side == Side::forward && p.forward)
      points.push_back({p.position_mm, *p.forward, p.forward_count, p.forward_std});
    if (side == Side::reverse && p.reverse)
      points.push_back({p.position_mm, *p.reverse, p.reverse_count, p.reverse_std});
  }
  return points;
}

void set_side(CurvePoint& point, Side side, const std::optional<SidePoint>& value) {
  const bool forward = side == Side::forward;
  (forward ? point.forward : point.reverse) = value ? std::optional(value->value) : std::nullopt;
  (forward ? point.forward_count : point.reverse_count) = value ? value->count : 0;
  (forward ? point.forward_std : point.reverse_std) = value ? value->std : std::nullopt;
}

std::optional<SidePoint> point_at(const std::vector<SidePoint>& side, double position_mm, double tolerance_mm,
                                  bool hold) {
  if (side.empty()) return std::nullopt;
  const auto above = std::lower_bound(side.begin(), side.end(), position_mm,
                                      [](const SidePoint& point, double p) { return point.position_mm < p; });
  for (const auto near : {above, above == side.begin() ? above : std::prev(above)}) {
    if (near == side.end() || std::abs(near->position_mm - position_mm) > tolerance_mm) continue;
    SidePoint found = *near;
    found.position_mm = position_mm;
    return found;
  }
  if (above == side.begin() || above == side.end()) {
    if (!hold) return std::nullopt;
    SidePoint end = above == side.end() ? side.back() : side.front();
    end.position_mm = position_mm;
    return end;
  }
  const SidePoint& high = *above;
  const SidePoint& low = *std::prev(above);
  const double share = (position_mm - low.position_mm) / (high.position_mm - low.position_mm);
  SidePoint between{position_mm, std::lerp(low.value, high.value, share), std::min(low.count, high.count),
                    std::nullopt};
  if (low.std && high.std) between.std = std::lerp(*low.std, *high.std, share);
  return between;
}

}  // namespace ecs::laser
