#include "commissioning/investigation/level.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/units.hpp"
#include "model/effects/definition.hpp"
#include "model/fit/fit.hpp"

namespace ecs::commissioning {
namespace {

constexpr int kPlaces = 101;
constexpr const char* kSlope = "um_per_m";

bool is_slope(const model::EffectInstance& effect) {
  const model::EffectTraits& traits = effect.traits();
  return !effect.is_user() && traits.is_usual && !traits.of_approach && !traits.shows_at_zero;
}

/// Places along the line from both sides, the other axes where the effects count from.
laser::MeasurementSet places_of(const InvestigatedLine& line, const params::MachineAxis& axis) {
  laser::MeasurementSet set;
  for (const Approach approach : {Approach::forward, Approach::reverse})
    for (int i = 0; i < kPlaces; ++i) {
      laser::Reading reading;
      reading.axis = line.axis;
      reading.sense = line.sense;
      for (const Axis a : kAllAxes)
        reading.position_mm[index_of(a)] = axis.measurement_line_mm[index_of(a)].value_or(0.0);
      reading.position_mm[index_of(line.axis)] = std::lerp(axis.travel_mm[0], axis.travel_mm[1], i / (kPlaces - 1.0));
      reading.approach = approach;
      reading.row = static_cast<int>(set.readings.size()) + 1;
      set.readings.push_back(reading);
    }
  return set;
}

}  // namespace

Result<void> make_level(model::Model& model, const InvestigatedLine& line, const params::Machine& machine) {
  const auto& axis = machine.axes[index_of(line.axis)];
  const auto of_line = [&](const model::EffectInstance& effect) {
    return effect.axis == line.axis && effect.sense == line.sense && is_carried(effect, machine);
  };
  const auto slope = std::find_if(model.effects.begin(), model.effects.end(), [&](const model::EffectInstance& effect) {
    return of_line(effect) && is_slope(effect) && !effect.parameters.contains(kSlope) && effect.fitted.contains(kSlope);
  });
  if (!axis || slope == model.effects.end()) return {};
  model::Model curve = model;
  std::erase_if(curve.effects, [&](const model::EffectInstance& effect) { return !of_line(effect); });
  const laser::MeasurementSet set = places_of(line, *axis);
  const model::Observations at = model::observations_of(set, curve, machine);
  ECS_TRY(values, model::predicted(curve, at));
  const double middle_mm = 0.5 * (axis->travel_mm[0] + axis->travel_mm[1]);
  double moment = 0.0, inertia = 0.0;
  for (std::size_t k = 0; k < at.size(); ++k) {
    const double arm_mm = at.position_mm[k][index_of(line.axis)] - middle_mm;
    moment += arm_mm * values[k];
    inertia += arm_mm * arm_mm;
  }
  if (inertia > 0.0) slope->fitted[kSlope] -= moment / inertia * kMmPerM;
  return {};
}

}  // namespace ecs::commissioning
