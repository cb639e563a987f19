#include "ecs_emulator/errors/rotary_errors.hpp"

#include <fmt/format.h>

#include "ecs_emulator/effects/definition.hpp"

namespace ecs::emulator {
namespace {

/// A rotary axis as one of its effects sees it.
class TurnConditions final : public Conditions {
 public:
  TurnConditions(double angle_deg, Approach side, double at_s) {
    p_mm = angle_deg;
    approach = side == Approach::reverse ? -1.0 : 1.0;
    time_s = at_s;
  }
  [[nodiscard]] double material_degC() const override { return 20.0; }
  [[nodiscard]] double degC(const std::string& /*sensor*/) const override { return 20.0; }
  [[nodiscard]] double first_degC(const std::string& /*sensor*/) const override { return 20.0; }
};

double value_of_motion(const RotaryMotion& one, Variables& variables, const RotaryState& state) {
  const double angle_deg = state.angle_deg[one.axis];
  const Approach side = state.approach[one.axis];
  if (one.curve) {
    variables.p = angle_deg;
    variables.d = side == Approach::reverse ? -1.0 : 1.0;
    return one.curve->value(variables);
  }
  const PlacedEffect& effect = *one.effect;
  if (effect.approach != Approach::unknown && effect.approach != side) return 0.0;
  return effect.kind->value(effect, TurnConditions(angle_deg, side, state.time_s));
}

}  // namespace

RotaryValues values_of(const RotaryParts& parts, Variables& variables, const RotaryState& state) {
  RotaryValues values;
  values.location = parts.location;
  variables.t = state.time_s;
  for (const RotaryMotion& one : parts.motions)
    values.motion[one.axis][static_cast<std::size_t>(one.sense)] += value_of_motion(one, variables, state);
  return values;
}

std::string rotary_name(std::size_t axis, Sense sense) { return fmt::format("{}{}", name_of(sense), "ABC"[axis]); }

std::string location_name(std::size_t axis, std::size_t letter) {
  return fmt::format("{}O{}", "XYZABC"[letter], "ABC"[axis]);
}

}  // namespace ecs::emulator
