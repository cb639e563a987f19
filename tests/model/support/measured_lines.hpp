// Small measurement sets made by hand for the tests of model/: one or more lines, runs both ways, known noise.
#pragma once

#include <algorithm>
#include <functional>
#include <random>

#include "base/random.hpp"
#include "laser/measurement_set.hpp"
#include "model/diagnosis/diagnose.hpp"
#include "model/effects/quantities.hpp"
#include "model/regression/candidates.hpp"
#include "params/machine.hpp"

/// The effects of the library by the names that tests use.
namespace ecs::model::test::effects {

inline const EffectId offset = effect_named("offset");
inline const EffectId scale = effect_named("scale");
inline const EffectId progressive = effect_named("progressive");
inline const EffectId cyclic = effect_named("cyclic");
inline const EffectId backlash = effect_named("backlash");
inline const EffectId reversal_curve = effect_named("reversal_curve");
inline const EffectId step = effect_named("step");
inline const EffectId sag = effect_named("sag");
inline const EffectId angular = effect_named("angular");
inline const EffectId squareness = effect_named("squareness");
inline const EffectId measurement_line = effect_named("measurement_line");
inline const EffectId thermal_scale = effect_named("thermal_scale");
inline const EffectId thermal_drift = effect_named("thermal_drift");
inline const EffectId warm_up = effect_named("warm_up");
inline const EffectId time_drift = effect_named("time_drift");
inline const EffectId air_refraction = effect_named("air_refraction");
inline const EffectId dead_path = effect_named("dead_path");
inline const EffectId cosine = effect_named("cosine");
inline const EffectId servo_lag = effect_named("servo_lag");
inline const EffectId delay = effect_named("delay");
inline const EffectId load = effect_named("load");
inline const EffectId reversal_spike = effect_named("reversal_spike");
inline const EffectId friction = effect_named("friction");
inline const EffectId map_polarity = effect_named("map_polarity");
inline const EffectId map_gain = effect_named("map_gain");
inline const EffectId map_shift = effect_named("map_shift");
inline const EffectId map_direction_swap = effect_named("map_direction_swap");
inline const EffectId user = effect_named("user");

}  // namespace ecs::model::test::effects

namespace ecs::model::test {

using laser::Reading;

struct Plan {
  Axis axis = Axis::X;
  Sense sense = Sense::EX;
  double from_mm = 0.0, step_mm = 25.0;
  int targets = 41;
  int runs = 3;
  bool both_ways = true;
  Vector3 parked_mm{};
};

using Truth = std::function<double(const Reading&)>;

inline constexpr double kNoise_um = 0.3;
inline double nothing(const Reading&) { return 0.0; }

/// Readings every 10 s, runs 200 s apart; normal noise.
inline void measure(laser::MeasurementSet& set, const Plan& plan, double noise_um, const Truth& truth,
                    unsigned seed = 1) {
  std::mt19937_64 random(seed);
  NormalDraws normal;
  double t = set.readings.empty() ? 0.0 : *set.readings.back().time_s + 100.0;
  for (int run = 1; run <= plan.runs; ++run) {
    for (const int d : plan.both_ways ? std::vector<int>{1, -1} : std::vector<int>{1}) {
      for (int i = 0; i < plan.targets; ++i) {
        const int place = d > 0 ? i : plan.targets - 1 - i;
        Reading r{.row = static_cast<int>(set.readings.size()) + 1,
                  .axis = plan.axis,
                  .position_mm = plan.parked_mm,
                  .sense = plan.sense};
        // a little uneven, as ISO 230-2 asks
        r.position_mm[index_of(plan.axis)] =
            plan.from_mm + plan.step_mm * place + 0.17 * plan.step_mm * std::sin(3.0 * place);
        r.approach = static_cast<Approach>(d);
        r.run = run;
        r.time_s = t += 10.0;
        r.sensors_degC["t_material_degC"] = 20.5 + 0.8 * std::sin(t / 3000.0);
        r.error = truth(r) + noise_um * normal(random);
        set.readings.push_back(r);
      }
    }
    t += 200.0;
  }
}

inline laser::MeasurementSet measured(const Plan& plan, double noise_um, const Truth& truth, unsigned seed = 1) {
  laser::MeasurementSet set;
  measure(set, plan, noise_um, truth, seed);
  return set;
}

/// One session; `conditions` changes every reading before the truth is asked.
inline laser::MeasurementSet session(const Plan& plan, const Truth& truth,
                                     const std::function<void(Reading&)>& conditions) {
  auto set = measured(plan, 0.0, nothing);
  std::mt19937_64 random(11);
  NormalDraws noise(0.0, kNoise_um);
  for (auto& r : set.readings) {
    r.sensors_degC.clear();
    conditions(r);
    r.error = truth(r) + noise(random);
  }
  return set;
}

inline EffectInstance effect(EffectId id, Axis axis, Sense sense) {
  EffectInstance one{.id = id, .axis = axis, .sense = sense};
  hold_optional(one);
  return one;
}

/// Offset and scale of one line.
inline Model straight(Axis axis = Axis::X, Sense sense = Sense::EX) {
  Model model;
  model.effects = {effect(effects::offset, axis, sense), effect(effects::scale, axis, sense)};
  return model;
}

inline params::Machine mill(const char* configuration = "TXYZ") {
  params::Machine machine{.name = "test mill", .configuration = configuration};
  for (const Axis a : kAllAxes) {
    params::MachineAxis axis{.travel_mm = {0.0, 1000.0}, .screw_pitch_mm = 10.0};
    for (const Axis other : kAllAxes)
      if (other != a) axis.measurement_line_mm[index_of(other)] = 0.0;
    machine.axes[index_of(a)] = axis;
  }
  return machine;
}

inline double p(const Reading& r, Axis a = Axis::X) { return r.position_mm[index_of(a)]; }
inline double d(const Reading& r) { return static_cast<double>(static_cast<int>(r.approach)); }

inline Diagnosis diagnosed(const Model& model, const laser::MeasurementSet& set) {
  auto result = diagnose(model, observations_of(set, model, mill()));
  return result ? *result : Diagnosis{};
}

/// As `ecs model new` makes it of these readings.
inline Model usual_model(const laser::MeasurementSet& set, const std::optional<params::Machine>& machine = {}) {
  Model model;
  model.effects = usual_effects(observations_of(set, model, machine));
  return model;
}

inline laser::ErrorMap wavy_map() {
  laser::MapTable table{Component::EXX, Approach::unknown, {}, {}};
  for (int i = 0; i <= 40; ++i) {
    table.position_mm.push_back(25.0 * i);
    table.compensation.push_back(3.0 * std::sin(0.17 * i) + 0.2 * i);
  }
  return {{}, {table}};
}

/// The cause, or one that these data cannot separate from it.
inline bool stands_for(const Candidate& candidate, const std::string& place) {
  const auto& group = candidate.indistinguishable_from;
  return to_text(candidate.effect) == place || std::find(group.begin(), group.end(), place) != group.end();
}

inline std::size_t count_named(const Diagnosis& diagnosis) {
  return static_cast<std::size_t>(
      std::ranges::count_if(diagnosis.candidates, [](const Candidate& candidate) { return candidate.named; }));
}

}  // namespace ecs::model::test
