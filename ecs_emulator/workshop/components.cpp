#include "ecs_emulator/workshop/components.hpp"

#include <cmath>

#include <fmt/format.h>

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

}  // namespace

Result<AxisComponents> components_along(const Simulation& simulation, const PerAxis<std::vector<double>>& places_mm) {
  ComponentSurvey survey(simulation);
  const Vector3 datum_mm = simulation.machine().datum_mm();
  AxisComponents out;
  for (const Axis axis : kAllAxes) {
    if (!simulation.machine().has(axis)) continue;
    for (const double position_mm : places_mm[index_of(axis)]) {
      if (const auto mixed = survey.mixed(axis, position_mm))
        return problem(ProblemKind::refused,
                       fmt::format("{} depends on where another axis stands as well: its error is no function of {} "
                                   "alone; `ecs-emulator survey` drives to every place",
                                   name_of(*mixed), letter_of(axis)));
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

}  // namespace ecs::emulator
