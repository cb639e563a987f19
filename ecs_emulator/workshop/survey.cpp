#include "ecs_emulator/workshop/survey.hpp"

#include <algorithm>
#include <cmath>

#include "ecs_emulator/instruments/measurement.hpp"

namespace ecs::emulator {
namespace {

constexpr std::size_t kMostPoints = 200'000;

/// Coordinates of one axis in the order in which they are approached; the commanded place where there is no axis.
std::vector<double> places_of(const MachineTool& machine, Axis axis, const SurveyPlan& plan) {
  if (!machine.has(axis)) return {0.0};
  auto [first_mm, last_mm] = machine.axis(axis).facts().travel_mm;
  if (plan.approach == Approach::reverse) std::swap(first_mm, last_mm);
  return targets_between(first_mm, last_mm, plan.step_mm);
}

/// Approaches `target_mm` with every axis that has to turn back first going beyond.
bool approach(Simulation& simulation, const Vector3& target_mm, const SurveyPlan& plan) {
  const double onward = plan.approach == Approach::reverse ? -1.0 : 1.0;
  const Vector3 from_mm = simulation.machine().command_mm();
  Vector3 before_mm = from_mm;
  bool turns = false;
  for (std::size_t a = 0; a < kAxes; ++a) {
    if (!simulation.machine().has(static_cast<Axis>(a))) continue;
    const bool behind = (target_mm[a] - from_mm[a]) * onward >= plan.overrun_mm;
    const bool there =
        target_mm[a] == from_mm[a] && simulation.machine().axis(static_cast<Axis>(a)).approach() == plan.approach;
    if (behind || there) continue;
    before_mm[a] = target_mm[a] - onward * plan.overrun_mm;
    turns = true;
  }
  if (turns && !simulation.move_to(before_mm, 0.0)) return false;
  return simulation.move_to(target_mm, 0.0);
}

bool is_corner(const MachineTool& machine, const Vector3& position_mm) {
  for (const Axis a : kAllAxes) {
    if (!machine.has(a)) continue;
    const auto [low_mm, high_mm] = machine.axis(a).facts().travel_mm;
    const double p = position_mm[index_of(a)];
    if (p != low_mm && p != high_mm) return false;
  }
  return true;
}

}  // namespace

double SurveyPoint::length_um() const { return std::hypot(error_um[0], error_um[1], error_um[2]); }

Result<Survey> survey(Simulation& simulation, const SurveyPlan& plan) {
  const auto xs = places_of(simulation.machine(), Axis::X, plan);
  const auto ys = places_of(simulation.machine(), Axis::Y, plan);
  const auto zs = places_of(simulation.machine(), Axis::Z, plan);
  if (xs.empty() || ys.empty() || zs.empty()) return problem(ProblemKind::usage, "step: expected above 0 mm");
  if (xs.size() * ys.size() * zs.size() > kMostPoints)
    return problem(ProblemKind::usage, "step: expected a step that gives at most 200000 points");
  const auto stopped_early = problem(ProblemKind::refused, "survey: stopped before its end");
  const auto error_here = [&](const Vector3& target_mm) {
    return simulation.tool_at(simulation.machine().state(), target_mm, plan.scatter).error_um;
  };
  const Vector3 datum_mm = simulation.machine().datum_mm();
  if (!approach(simulation, datum_mm, plan)) return stopped_early;
  const Vector3 zero_um = error_here(datum_mm);
  Survey found;
  for (const double z : zs)
    for (const double y : ys)
      for (const double x : xs) {
        SurveyPoint point{{x, y, z}, {}};
        if (!approach(simulation, point.position_mm, plan)) return stopped_early;
        point.error_um = error_here(point.position_mm);
        for (std::size_t a = 0; a < kAxes; ++a) point.error_um[a] -= zero_um[a];
        found.grid.push_back(point);
        if (is_corner(simulation.machine(), point.position_mm)) found.corners.push_back(point);
      }
  return found;
}

const SurveyPoint& worst(const std::vector<SurveyPoint>& points) {
  return *std::max_element(points.begin(), points.end(),
                           [](const SurveyPoint& a, const SurveyPoint& b) { return a.length_um() < b.length_um(); });
}

double rms_um(const std::vector<SurveyPoint>& points) {
  double sum = 0.0;
  for (const SurveyPoint& point : points) sum += point.length_um() * point.length_um();
  return std::sqrt(sum / static_cast<double>(points.size()));
}

}  // namespace ecs::emulator
