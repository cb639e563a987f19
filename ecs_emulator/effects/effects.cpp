#include "ecs_emulator/effects/effects.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/units.hpp"

namespace ecs::emulator {
namespace {

constexpr std::string_view kFaultOfTheMap =
    "a fault of the unit's map: give the unit such a map, or polarity and gain in its parameters";

/// The straightness of either axis of the plane in the direction of the other.
std::vector<PlacedEffect> two_slopes(const PlacedEffect& effect) {
  const auto next = [](Axis a) { return static_cast<Axis>((index_of(a) + 1) % kAxes); };
  const Axis one = next(direction_of(*effect.sense)), other = next(one);
  PlacedEffect first = effect, second = effect;
  first.sense = static_cast<Sense>(index_of(one));
  first.axis = other;
  first.parameters["um_per_m"] = -effect.parameter("um_per_m");
  second.sense = static_cast<Sense>(index_of(other));
  second.axis = one;
  return {first, second};
}

}  // namespace

const std::vector<EffectDefinition>& effects() {
  using Effect = const PlacedEffect&;
  using At = const Conditions&;
  static const std::vector<EffectDefinition> kAll{
      // A constant: c.
      {.id = "offset", .parameters = {{"um", "um"}}, .value = [](Effect e, At) { return e.parameter("um"); }},
      // A wrong scale: k·p.
      {.id = "scale",
       .parameters = {{"um_per_m", "um/m"}},
       .needs_axis = true,
       .value = [](Effect e, At at) { return e.parameter("um_per_m") * (at.p_mm / kMmPerM); }},
      // A smooth curve over the travel, without mean and slope: s(p).
      {.id = "progressive", .curve = true, .needs_axis = true, .value = [](Effect, At at) { return at.curve; }},
      // A wave of a screw or scale, two harmonics: A·sin(2πp/P + φ) + A₂·sin(4πp/P + φ₂); both approaches or one.
      {.id = "cyclic",
       .parameters = {{.name = "period_mm", .unit = "mm", .positive = true},
                      {"amplitude_um", "um"},
                      {.name = "phase_rad", .unit = "rad", .optional = true},
                      {.name = "amplitude2_um", .unit = "um", .optional = true},
                      {.name = "phase2_rad", .unit = "rad", .optional = true}},
       .needs_axis = true,
       .value =
           [](Effect e, At at) {
             const double turn = 2.0 * std::numbers::pi * at.p_mm / e.parameter("period_mm");
             return e.parameter("amplitude_um") * std::sin(turn + e.parameter("phase_rad")) +
                    e.parameter("amplitude2_um") * std::sin(2.0 * turn + e.parameter("phase2_rad"));
           }},
      // Lost motion: b·d/2, of the axis that moves.
      {.id = "backlash",
       .parameters = {{"um", "um"}},
       .needs_axis = true,
       .value = [](Effect e, At at) { return e.parameter("um") * at.approach / 2.0; }},
      // Lost motion that changes along the travel: s(p)·d/2, without mean and slope.
      {.id = "reversal_curve",
       .curve = true,
       .needs_axis = true,
       .value = [](Effect, At at) { return at.curve * at.approach / 2.0; }},
      // A joint of a scale or rail: h where p > p₀.
      {.id = "step",
       .parameters = {{"height_um", "um"}, {"position_mm", "mm"}},
       .needs_axis = true,
       .value = [](Effect e, At at) { return at.p_mm > e.parameter("position_mm") ? e.parameter("height_um") : 0.0; }},
      // A ram that comes out and bends: k₂e² + k₃e³, e = |p|.
      {.id = "sag",
       .parameters = {{.name = "k2", .unit = "um/m^2", .optional = true},
                      {.name = "k3", .unit = "um/m^3", .optional = true}},
       .needs_axis = true,
       .value =
           [](Effect e, At at) {
             const double extension_m = std::abs(at.p_mm) / kMmPerM;
             return (e.parameter("k2") + e.parameter("k3") * extension_m) * extension_m * extension_m;
           }},
      // A rotation of a carriage, EAX … ECZ, seen through its lever arms: ε(p)·L.
      {.id = "angular",
       .curve = true,
       .placed_by = PlacedBy::code_of_rotation,
       .value = [](Effect, At at) { return at.curve; }},
      // Two axes out of square, C0Y, B0Z, A0Z: a constant angle, seen through its lever arms.
      {.id = "squareness",
       .parameters = {{"um_per_m", "um/m"}},
       .placed_by = PlacedBy::code_of_squareness,
       .value = [](Effect e, At) { return e.parameter("um_per_m"); }},
      // A map measured on another line than it is used on: lever × a component measured separately (Abbe).
      {.id = "measurement_line",
       .parameters = {{"lever_mm", "mm"}},
       .elsewhere = "depends on the position at which the map was measured, not on the machine: measure with the other "
                    "axes parked elsewhere (parked_mm of the plan)"},
      // Expansion of scale and workpiece: k·p·(T − 20 °C), T of the material.
      {.id = "thermal_scale",
       .parameters = {{"um_per_m_degC", "um/(m degC)"}},
       .of_material = true,
       .needs_axis = true,
       .value = [](Effect e,
                   At at) { return e.parameter("um_per_m_degC") * (at.p_mm / kMmPerM) * (at.material_degC - 20.0); }},
      // A zero that follows a temperature of the machine: c·(T − T₀), T₀ at time 0.
      {.id = "thermal_drift",
       .parameters = {{"um_per_degC", "um/degC"}},
       .sensors = 1,
       .value = [](Effect e, At at) { return e.parameter("um_per_degC") * (at.degC[0] - at.first_degC); }},
      // A machine that warms itself, without a sensor that sees it: (c + c₁·p)·(1 − e^(−t/τ)) (ISO 230-3:2020, 7).
      {.id = "warm_up",
       .parameters = {{.name = "tau_s", .unit = "s", .positive = true},
                      {.name = "c_um", .unit = "um", .optional = true},
                      {.name = "c_um_per_m", .unit = "um/m", .optional = true}},
       .value =
           [](Effect e, At at) {
             return (e.parameter("c_um") + e.parameter("c_um_per_m") * (at.p_mm / kMmPerM)) *
                    (1.0 - std::exp(-at.time_s / e.parameter("tau_s")));
           }},
      // A zero that creeps with time: c·t. In an errors file a fixture.
      {.id = "time_drift",
       .parameters = {{"um_per_h", "um/h"}},
       .value = [](Effect e, At at) { return e.parameter("um_per_h") * at.time_s / 3600.0; }},
      // Air that the laser does not correct, or not wholly: p·Δn (1: not at all).
      {.id = "air_refraction",
       .parameters = {{"factor", "1"}},
       .elsewhere = "an effect of the instrument: the air is set in [air] of this file, its correction by "
                    "air_compensation in [emulator.laser] of the machine file"},
      // Air between interferometer and reflector at zero that is not corrected: L·Δn.
      {.id = "dead_path",
       .parameters = {{"length_m", "m"}},
       .elsewhere = "an effect of the instrument: set dead_path_m in [emulator.laser] of the machine file"},
      // A beam at an angle to the axis: −p·φ²/2, always short.
      {.id = "cosine",
       .parameters = {{"angle_mrad", "mrad"}},
       .elsewhere = "an effect of the instrument: set misalignment_mrad in [emulator.laser] of the machine file"},
      // A drive that stays behind by its feed: c·feed·d.
      {.id = "servo_lag",
       .parameters = {{"um_per_m_min", "um/(m/min)"}},
       .needs_axis = true,
       .value = [](Effect e, At at) { return e.parameter("um_per_m_min") * at.feed_mm_min / kMmPerM * at.approach; }},
      // A machine that yields under the workpiece: (c + c₁·p)·m.
      {.id = "load",
       .parameters = {{.name = "um_per_kg", .unit = "um/kg", .optional = true},
                      {.name = "um_per_kg_m", .unit = "um/(kg m)", .optional = true}},
       .value =
           [](Effect e, At at) {
             return at.load_kg * (e.parameter("um_per_kg") + e.parameter("um_per_kg_m") * (at.p_mm / kMmPerM));
           }},
      // A transient after each reversal: c·d·e^(−u/u₀), u = travel since the reversal.
      {.id = "reversal_spike",
       .parameters = {{"c_um", "um"}, {.name = "u0_mm", .unit = "mm", .positive = true}},
       .needs_axis = true,
       .value =
           [](Effect e, At at) {
             return e.parameter("c_um") * at.approach * std::exp(-at.travel_since_reversal_mm / e.parameter("u0_mm"));
           }},
      // The unit applies its map with the wrong sign: −2 × the map.
      {.id = "map_polarity", .parameters = {{"fraction", "1"}}, .elsewhere = kFaultOfTheMap},
      // The unit applies its map too large or too small: (g − 1) × the map.
      {.id = "map_gain", .parameters = {{"gain", "1"}}, .elsewhere = kFaultOfTheMap},
      // The unit applies its map at the wrong place, after a wrong reference: map(p + Δ) − map(p).
      {.id = "map_shift", .parameters = {{"shift_mm", "mm"}}, .elsewhere = kFaultOfTheMap},
      // The unit has its tables for forward and reverse exchanged.
      {.id = "map_direction_swap", .elsewhere = kFaultOfTheMap},
      // A column or bed that bends because one side is warmer than the other: c·p²·(T₁ − T₂), across the axis. A
      // temperature that changes linearly over the height h bends it with the curvature α·ΔT/h, so that c = α/(2h).
      {.id = "thermal_bend",
       .parameters = {{"um_per_m2_degC", "um/(m^2 degC)"}},
       .sensors = 2,
       .needs_axis = true,
       .straightness = true,
       .value =
           [](Effect e, At at) {
             const double p_m = at.p_mm / kMmPerM;
             return e.parameter("um_per_m2_degC") * p_m * p_m * (at.degC[0] - at.degC[1]);
           }},
      // An artefact set up turned by the angle c about an axis: in the plane XY (EC) EX −c·y, EY +c·x, and cyclically.
      {.id = "set_up_rotation",
       .parameters = {{"um_per_m", "um/m"}},
       .placed_by = PlacedBy::code_of_set_up,
       .value = [](Effect e, At at) { return e.parameter("um_per_m") * (at.p_mm / kMmPerM); },
       .parts = two_slopes},
  };
  return kAll;
}

const EffectDefinition* effect_named(std::string_view id) {
  const auto found = std::find_if(effects().begin(), effects().end(), [id](const auto& one) { return one.id == id; });
  return found == effects().end() ? nullptr : &*found;
}

double PlacedEffect::parameter(std::string_view name) const {
  const auto found = parameters.find(name);
  return found == parameters.end() ? 0.0 : found->second;
}

std::string name_of(const PlacedEffect& effect) {
  std::string text(effect.kind->id);
  if (effect.axis) text += std::string(":") + letter_of(*effect.axis);
  if (effect.code && effect.kind->placed_by != PlacedBy::sense) return text + ":" + std::string(name_of(*effect.code));
  if (effect.sense) text += ":" + std::string(name_of(*effect.sense));
  return text;
}

std::vector<PlacedEffect> parts_of(const PlacedEffect& effect) {
  return effect.kind->parts == nullptr ? std::vector{effect} : effect.kind->parts(effect);
}

Component carrier_of(const PlacedEffect& effect) {
  const PlacedBy by = effect.kind->placed_by;
  const bool coded = by == PlacedBy::code_of_rotation || by == PlacedBy::code_of_squareness;
  return coded ? *effect.code : curve_of(*effect.sense, *effect.axis);
}

}  // namespace ecs::emulator
