#include "ecs_emulator/effects/formula.hpp"

#include <cmath>
#include <numbers>

#include "base/units.hpp"

namespace ecs::emulator {
namespace {

double cyclic(const PlacedEffect& e, double p_mm) {
  const double turn = 2.0 * std::numbers::pi * p_mm / e.parameter("period_mm");
  return e.parameter("amplitude_um") * std::sin(turn + e.parameter("phase_rad")) +
         e.parameter("amplitude2_um") * std::sin(2.0 * turn + e.parameter("phase2_rad"));
}

double sag(const PlacedEffect& e, double p_mm) {
  const double extension_m = std::abs(p_mm) / kMmPerM;
  return (e.parameter("k2") + e.parameter("k3") * extension_m) * extension_m * extension_m;
}

}  // namespace

double machine_effect(const PlacedEffect& e, const EffectPoint& at) {
  const double p_m = at.p_mm / kMmPerM;
  const double d = at.approach;
  switch (e.kind) {
    case EffectKind::offset:
      return e.parameter("um");
    case EffectKind::scale:
      return e.parameter("um_per_m") * p_m;
    case EffectKind::progressive:
    case EffectKind::angular:
      return at.curve;
    case EffectKind::cyclic:
      return cyclic(e, at.p_mm);
    case EffectKind::backlash:
      return e.parameter("um") * d / 2.0;
    case EffectKind::reversal_curve:
      return at.curve * d / 2.0;
    case EffectKind::step:
      return at.p_mm > e.parameter("position_mm") ? e.parameter("height_um") : 0.0;
    case EffectKind::sag:
      return sag(e, at.p_mm);
    case EffectKind::squareness:
      return e.parameter("um_per_m");
    case EffectKind::thermal_scale:
      return e.parameter("um_per_m_degC") * p_m * (at.material_degC - 20.0);
    case EffectKind::thermal_drift:
      return e.parameter("um_per_degC") * at.sensor_rise_degC;
    case EffectKind::warm_up:
      return (e.parameter("c_um") + e.parameter("c_um_per_m") * p_m) *
             (1.0 - std::exp(-at.time_s / e.parameter("tau_s")));
    case EffectKind::time_drift:
      return e.parameter("um_per_h") * at.time_s / 3600.0;
    case EffectKind::servo_lag:
      return e.parameter("um_per_m_min") * at.feed_mm_min / kMmPerM * d;
    case EffectKind::load:
      return at.load_kg * (e.parameter("um_per_kg") + e.parameter("um_per_kg_m") * p_m);
    case EffectKind::reversal_spike:
      return e.parameter("c_um") * d * std::exp(-at.travel_since_reversal_mm / e.parameter("u0_mm"));
    default:
      return 0.0;
  }
}

}  // namespace ecs::emulator
