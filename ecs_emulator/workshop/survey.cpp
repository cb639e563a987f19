#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <utility>

#include "ecs_emulator/instruments/measurement.hpp"
#include "ecs_emulator/workshop/procedures.hpp"

namespace ecs::emulator {
namespace {

constexpr double kSame = 1e-6;  ///< um, um/m

class ComponentSurvey {
 public:
  explicit ComponentSurvey(const Simulation& simulation) : simulation_(simulation) {
    state_ = simulation.machine().state();
    state_.position_mm = simulation.machine().datum_mm();
    state_.feed_mm_min = 0.0;
  }

  /// The components of an axis at that position, having arrived by that approach.
  [[nodiscard]] ComponentValues at(Axis axis, double position_mm, Approach approach, const Vector3& others_mm) {
    state_.position_mm = others_mm;
    state_.position_mm[index_of(axis)] = position_mm;
    state_.approach = {approach, approach, approach};
    return simulation_.errors().at(state_, simulation_.heat());
  }

  /// A component of the axis that changes as another axis moves; nothing: there is none.
  [[nodiscard]] std::optional<Component> mixed(Axis axis, double position_mm) {
    const Vector3 datum_mm = simulation_.machine().datum_mm();
    const ComponentValues expected = at(axis, position_mm, Approach::forward, datum_mm);
    for (const double part : {0.0, 0.37, 1.0}) {
      Vector3 others_mm = datum_mm;
      for (const Axis other : kAllAxes)
        if (simulation_.machine().has(other)) {
          const auto [low_mm, high_mm] = simulation_.machine().travel_mm()[index_of(other)];
          others_mm[index_of(other)] = std::lerp(low_mm, high_mm, part);
        }
      const ComponentValues found = at(axis, position_mm, Approach::forward, others_mm);
      for (std::size_t c = 6 * index_of(axis); c < 6 * index_of(axis) + 6; ++c)
        if (std::abs(found[c] - expected[c]) > kSame) return static_cast<Component>(c);
    }
    return std::nullopt;
  }

 private:
  const Simulation& simulation_;
  MachineState state_;
};

/// Components that are not 0, added to those known.
void add_components(const ComponentValues& values, std::set<Component>& into) {
  for (std::size_t c = 0; c < kComponents; ++c)
    if (std::abs(values[c]) > kSame) into.insert(static_cast<Component>(c));
}

/// Two hours of work: every axis there and back over its travel, the spindle turning.
Heat after_work(const Simulation& simulation) {
  constexpr double kHours = 2.0, kSpeed_mm_s = 150.0, kSpeed_rpm = 3000.0;
  const auto& travel_mm = simulation.machine().travel_mm();
  Heat heat(simulation.errors().heat(), travel_mm, 0);
  heat.spindle(kSpeed_rpm);
  const auto place_at = [&](double time_s) {
    Vector3 place_mm = simulation.machine().datum_mm();
    for (const Axis axis : kAllAxes)
      if (simulation.machine().has(axis)) {
        const auto [low_mm, high_mm] = travel_mm[index_of(axis)];
        const double way_mm = std::fmod(kSpeed_mm_s * time_s, 2.0 * (high_mm - low_mm));
        place_mm[index_of(axis)] = low_mm + std::min(way_mm, 2.0 * (high_mm - low_mm) - way_mm);
      }
    return place_mm;
  };
  for (double time_s = 1.0; time_s <= kHours * 3600.0; time_s += 1.0) {
    heat.moved(place_at(time_s - 1.0), place_at(time_s), 1.0);
    heat.advance(time_s);
  }
  return heat;
}

}  // namespace

std::vector<LeftOut> left_out(const Simulation& simulation) {
  constexpr int kPlaces = 21;
  constexpr double kWorked_s = 7200.0, kFeed_mm_min = 1000.0, kLoad_kg = 500.0, kTravel_mm = 1000.0;
  const TrueErrors& errors = simulation.errors();
  const Heat warm = after_work(simulation);
  std::set<Component> scatter, heat, load, feed, travel;
  add_components(errors.reading_scatter(), scatter);
  MachineState state = simulation.machine().state();
  state.feed_mm_min = 0.0;
  const auto changes = [&](const std::function<void(MachineState&)>& change, const Heat& then,
                           std::set<Component>& in) {
    MachineState other = state;
    change(other);
    ComponentValues difference = errors.at(other, then);
    const ComponentValues here = errors.at(state, simulation.heat());
    for (std::size_t c = 0; c < kComponents; ++c) difference[c] -= here[c];
    add_components(difference, in);
  };
  for (const Axis axis : kAllAxes) {
    if (!simulation.machine().has(axis)) continue;
    const auto [low_mm, high_mm] = simulation.machine().travel_mm()[index_of(axis)];
    for (const Approach approach : {Approach::forward, Approach::reverse})
      for (int i = 0; i < kPlaces; ++i) {
        state.position_mm = simulation.machine().datum_mm();
        state.position_mm[index_of(axis)] = std::lerp(low_mm, high_mm, i / (kPlaces - 1.0));
        state.approach = {approach, approach, approach};
        add_components(errors.pass_scatter(state, simulation.machine().travel_mm(), 1), scatter);
        changes([](MachineState& s) { s.time_s += kWorked_s; }, warm, heat);
        changes([](MachineState& s) { s.load_kg += kLoad_kg; }, simulation.heat(), load);
        changes([](MachineState& s) { s.feed_mm_min = kFeed_mm_min; }, simulation.heat(), feed);
        changes(
            [](MachineState& s) {
              s.travel_since_reversal_mm = {kTravel_mm, kTravel_mm, kTravel_mm};
            },
            simulation.heat(), travel);
      }
  }
  std::vector<LeftOut> out;
  for (const auto& [cause, components] :
       {std::pair("scatter", &scatter), std::pair("time and heat", &heat), std::pair("load", &load),
        std::pair("feed", &feed), std::pair("travel since the reversal", &travel)})
    if (!components->empty()) out.push_back({cause, {components->begin(), components->end()}});
  return out;
}

Result<AxisComponents> components_along(const Simulation& simulation, const PerAxis<std::vector<double>>& places_mm) {
  ComponentSurvey survey(simulation);
  const Vector3 datum_mm = simulation.machine().datum_mm();
  AxisComponents out;
  for (const Axis axis : kAllAxes) {
    if (!simulation.machine().has(axis)) continue;
    for (const double position_mm : places_mm[index_of(axis)]) {
      if (const auto mixed = survey.mixed(axis, position_mm))
        return problem(ProblemKind::refused,
                       "{} also depends on the position of another axis: its error is not a function of {} "
                       "alone; use `ecs-emulator survey`, which moves to every position",
                       name_of(*mixed), letter_of(axis));
      for (const Approach approach : {Approach::forward, Approach::reverse}) {
        const ComponentValues values = survey.at(axis, position_mm, approach, datum_mm);
        auto& into = approach == Approach::forward ? out.forward : out.reverse;
        for (std::size_t c = 6 * index_of(axis); c < 6 * index_of(axis) + 6; ++c) into[c].push_back(values[c]);
        for (std::size_t c = kCurves; c < kComponents; ++c) out.squareness[c] = values[c];
      }
    }
  }
  return out;
}

RotaryComponents rotary_components(const Simulation& simulation, const PerAxis<std::vector<double>>& angles_deg) {
  RotaryComponents out;
  RotaryState state;
  out.location = simulation.errors().rotary_at(state).location;
  for (const Approach approach : {Approach::forward, Approach::reverse}) {
    state.approach = {approach, approach, approach};
    auto& into = approach == Approach::forward ? out.forward : out.reverse;
    for (std::size_t r = 0; r < kAxes; ++r)
      for (const double angle_deg : angles_deg[r]) {
        state.angle_deg[r] = angle_deg;
        const RotaryValues values = simulation.errors().rotary_at(state);
        for (std::size_t s = 0; s < values.motion[r].size(); ++s) into[r][s].push_back(values.motion[r][s]);
      }
  }
  return out;
}

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
