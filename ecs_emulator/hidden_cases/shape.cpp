#include <algorithm>
#include <cmath>
#include <numbers>

#include "ecs_emulator/hidden_cases/choice.hpp"
#include "ecs_emulator/random/draw.hpp"

namespace ecs::emulator {
namespace {

constexpr std::size_t kCurveFunctions = 10;  ///< degrees of freedom of a smooth curve, mean and slope apart

/// The places that a curve of this effect runs over.
const std::vector<double>& places_under(const Ground& ground, const PlacedEffect& effect) {
  if (effect.sense) return ground.cover(*effect.sense, *effect.axis).places_mm;
  const std::vector<double>* most = &ground.cover(ground.senses.front(), *effect.axis).places_mm;
  for (const Sense s : ground.senses)
    if (ground.cover(s, *effect.axis).places_mm.size() > most->size()) most = &ground.cover(s, *effect.axis).places_mm;
  return *most;
}

/// Up to degree 5: nearer the ends a polynomial of higher degree turns faster than a curve of ten degrees of freedom.
SmoothCurve draw_curve(Random& random, const std::vector<double>& places) {
  SmoothCurve curve;
  curve.from_mm = places.front();
  curve.to_mm = places.back();
  const int most = std::clamp(static_cast<int>(places.size()) / 2 - 1, 1, 4);
  const int count = whole(random, std::min(2, most), most);
  const double roughness = between(random, 0.4, 1.2);
  for (int k = 0; k < count; ++k) curve.waves.push_back(random.normal() * std::pow(k + 1.0, -roughness));
  return curve;
}

/// Takes mean and slope over the readings on which the effect acts out of its curve (least squares).
void take_out_line(const Scene& scene, PlacedEffect& effect) {
  double n = 0.0, sx = 0.0, sxx = 0.0, sv = 0.0, sxv = 0.0;
  const double centre_mm = 0.5 * (effect.curve.from_mm + effect.curve.to_mm);
  const double half_mm = 0.5 * (effect.curve.to_mm - effect.curve.from_mm);
  for (const Stop& stop : scene.stops) {
    if (!acts_on(effect, stop)) continue;
    const double x = (scene.p_mm(stop, *effect.axis) - centre_mm) / half_mm;
    const double v = value_at(effect.curve, scene.p_mm(stop, *effect.axis));
    n += 1.0;
    sx += x;
    sxx += x * x;
    sv += v;
    sxv += x * v;
  }
  const double slope = (n * sxv - sx * sv) / (n * sxx - sx * sx);
  effect.curve.slope = -slope;
  effect.curve.mean = -(sv - slope * sx) / n;
}

/// A period that the machine's facts suggest, or any.
double draw_period_mm(Random& random, const Scene& scene, Axis axis) {
  const auto pitch = scene.machine.axes[index_of(axis)]->screw_pitch_mm;
  if (pitch && chance(random, 0.7)) return *pitch * one(random, std::vector{1.0, 1.0, 1.0, 1.0, 2.0, 0.5});
  return rounded(log_between(random, 4.0, 40.0), 1000.0);
}

/// The shortest period that the targets show without taking it for another.
bool period_shows(const Scene& scene, const std::vector<double>& places, double period_mm) {
  const double length_mm = places.back() - places.front();
  const double step_mm = length_mm / static_cast<double>(places.size() - 1);
  if (length_mm < 3.0 * period_mm) return false;
  return scene.even_grid ? period_mm > 2.5 * step_mm : places.size() >= 16;
}

bool draw_cyclic(Random& random, const Scene& scene, const Ground& ground, PlacedEffect& e) {
  const auto& cover = ground.cover(*e.sense, *e.axis);
  const double period_mm = draw_period_mm(random, scene, *e.axis);
  if (!period_shows(scene, cover.places_mm, period_mm)) return false;
  e.parameters = {{"period_mm", period_mm},
                  {"amplitude_um", 1.4},
                  {"phase_rad", rounded(between(random, 0.0, 2.0 * std::numbers::pi), 1000.0)},
                  {"amplitude2_um", 0.0},
                  {"phase2_rad", 0.0}};
  if (period_shows(scene, cover.places_mm, period_mm / 2.0) && chance(random, 0.4)) {
    e.parameters["amplitude2_um"] = 1.4 * between(random, 0.2, 0.7);
    e.parameters["phase2_rad"] = rounded(between(random, 0.0, 2.0 * std::numbers::pi), 1000.0);
  }
  if (cover.both_ways && scene.shown.approach && chance(random, 0.3))
    e.approach = chance(random, 0.5) ? Approach::forward : Approach::reverse;
  return true;
}

/// Between two targets, not near the ends.
bool draw_step(Random& random, const std::vector<double>& places, PlacedEffect& e) {
  const int count = static_cast<int>(places.size());
  if (count < 8) return false;
  const auto k = static_cast<std::size_t>(whole(random, count / 5, count - 2 - count / 5));
  e.parameters = {{"height_um", 2.0}, {"position_mm", rounded(between(random, places[k], places[k + 1]), 1000.0)}};
  return e.parameters["position_mm"] > places[k] && e.parameters["position_mm"] < places[k + 1];
}

bool draw_map_fault(Random& random, PlacedEffect& e) {
  if (e.kind == EffectKind::map_gain)
    e.parameters["gain"] = one(random, std::vector{0.0, 0.5, 0.8, 1.25, 1.5, 2.0, 10.0});
  if (e.kind == EffectKind::map_polarity) e.parameters["fraction"] = 1.0;
  if (e.kind == EffectKind::map_shift)
    e.parameters["shift_mm"] = rounded(sign_of_chance(random) * log_between(random, 5.0, 60.0), 10.0);
  return true;
}

}  // namespace

std::optional<PlacedEffect> with_shape(Random& random, const Scene& scene, const Ground& ground, PlacedEffect e) {
  const double duration_s = scene.stops.back().time_s;
  const double sign = sign_of_chance(random);
  bool drawn = true;
  switch (e.kind) {
    case EffectKind::offset:
    case EffectKind::backlash:
      e.parameters["um"] = sign * 2.0;
      break;
    case EffectKind::scale:
    case EffectKind::squareness:
      e.parameters["um_per_m"] = sign;
      break;
    case EffectKind::progressive:
    case EffectKind::reversal_curve:
      e.curve = draw_curve(random, places_under(ground, e));
      take_out_line(scene, e);
      break;
    case EffectKind::angular:
      e.curve = draw_curve(random, places_under(ground, e));
      e.curve.mean = random.normal();
      e.curve.slope = random.normal();
      break;
    case EffectKind::cyclic:
      drawn = draw_cyclic(random, scene, ground, e);
      break;
    case EffectKind::step:
      drawn = draw_step(random, places_under(ground, e), e);
      if (drawn) e.parameters["height_um"] *= sign;
      break;
    case EffectKind::sag:
      e.parameters = {{"k2", sign},
                      {"k3", chance(random, 0.5) ? sign_of_chance(random) * between(random, 0.2, 1.0) : 0.0}};
      break;
    case EffectKind::measurement_line:
      e.parameters["lever_mm"] = sign * 300.0;
      break;
    case EffectKind::thermal_scale:
      e.parameters["um_per_m_degC"] = sign;
      break;
    case EffectKind::thermal_drift:
      e.parameters["um_per_degC"] = sign;
      break;
    case EffectKind::warm_up:
      e.parameters = {{"tau_s", rounded(duration_s * between(random, 0.12, 0.45), 1.0)},
                      {"c_um", chance(random, 0.75) ? sign : 0.0},
                      {"c_um_per_m", 0.0}};
      if (e.parameters["c_um"] == 0.0 || chance(random, 0.3)) e.parameters["c_um_per_m"] = sign_of_chance(random) * 1.5;
      break;
    case EffectKind::time_drift:
      e.parameters["um_per_h"] = sign;
      break;
    case EffectKind::air_refraction:
      e.parameters["factor"] = chance(random, 0.7) ? 1.0 : rounded(between(random, 0.3, 1.2), 100.0);
      break;
    case EffectKind::dead_path:
      e.parameters["length_m"] = rounded(log_between(random, 0.2, 5.0), 1000.0);
      break;
    case EffectKind::cosine:
      e.parameters["angle_mrad"] = 1.5;
      break;
    case EffectKind::servo_lag:
      e.parameters["um_per_m_min"] = sign;
      break;
    case EffectKind::load:
      e.parameters = {{"um_per_kg", sign * 0.01},
                      {"um_per_kg_m", chance(random, 0.5) ? sign_of_chance(random) * 0.01 : 0.0}};
      break;
    case EffectKind::reversal_spike: {
      const auto& places = places_under(ground, e);
      const double step_mm = (places.back() - places.front()) / static_cast<double>(places.size() - 1);
      e.parameters = {{"c_um", 2.0 * sign}, {"u0_mm", rounded(step_mm * between(random, 0.7, 3.0) + 3.0, 100.0)}};
      break;
    }
    default:
      drawn = draw_map_fault(random, e);
  }
  if (!drawn) return std::nullopt;
  return e;
}

std::vector<PlacedEffect> unit_effects(const Ground& ground, const PlacedEffect& effect) {
  std::vector<PlacedEffect> units;
  PlacedEffect unit = effect;
  const auto only = [&](std::initializer_list<std::pair<const char*, double>> values) {
    unit.parameters = effect.parameters;
    for (const auto& [name, value] : values) unit.parameters[name] = value;
    units.push_back(unit);
  };
  if (is_map_fault(effect.kind)) return {effect};
  switch (effect.kind) {
    case EffectKind::cyclic:
      for (const double phase : {0.0, std::numbers::pi / 2.0}) {
        only({{"amplitude_um", 1.0}, {"phase_rad", phase}, {"amplitude2_um", 0.0}});
        only({{"amplitude_um", 0.0}, {"amplitude2_um", 1.0}, {"phase2_rad", phase}});
      }
      return units;
    case EffectKind::sag:
      only({{"k2", 1.0}, {"k3", 0.0}});
      only({{"k2", 0.0}, {"k3", 1.0}});
      return units;
    case EffectKind::warm_up:
      only({{"c_um", 1.0}, {"c_um_per_m", 0.0}});
      only({{"c_um", 0.0}, {"c_um_per_m", 1.0}});
      return units;
    case EffectKind::load:
      only({{"um_per_kg", 1.0}, {"um_per_kg_m", 0.0}});
      only({{"um_per_kg", 0.0}, {"um_per_kg_m", 1.0}});
      return units;
    case EffectKind::step:
      only({{"height_um", 1.0}});
      return units;
    case EffectKind::reversal_spike:
      only({{"c_um", 1.0}});
      return units;
    case EffectKind::progressive:
    case EffectKind::reversal_curve:
    case EffectKind::angular: {
      const auto& places = places_under(ground, effect);
      const bool whole_curve = effect.kind == EffectKind::angular;
      unit.curve = {places.front(), std::max(places.back(), places.front() + 1.0), 0.0, 0.0, {}};
      if (whole_curve) {
        unit.curve.mean = 1.0;
        units.push_back(unit);
        unit.curve.mean = 0.0;
        unit.curve.slope = 1.0;
        if (places.size() > 1) units.push_back(unit);
        unit.curve.slope = 0.0;
      }
      const std::size_t count = std::min(kCurveFunctions, places.size() > 2 ? places.size() - 2 : 0);
      for (std::size_t k = 0; k < count; ++k) {
        unit.curve.waves.assign(k + 1, 0.0);
        unit.curve.waves[k] = 1.0;
        units.push_back(unit);
      }
      return units;
    }
    default:
      break;
  }
  static constexpr std::array<std::pair<EffectKind, const char*>, 12> kSizes{
      {{EffectKind::offset, "um"},
       {EffectKind::scale, "um_per_m"},
       {EffectKind::backlash, "um"},
       {EffectKind::squareness, "um_per_m"},
       {EffectKind::measurement_line, "lever_mm"},
       {EffectKind::thermal_scale, "um_per_m_degC"},
       {EffectKind::thermal_drift, "um_per_degC"},
       {EffectKind::time_drift, "um_per_h"},
       {EffectKind::air_refraction, "factor"},
       {EffectKind::dead_path, "length_m"},
       {EffectKind::cosine, "angle_mrad"},
       {EffectKind::servo_lag, "um_per_m_min"}}};
  for (const auto& [kind, name] : kSizes)
    if (kind == effect.kind) only({{name, 1.0}});
  return units;
}

void draw_map(Random& random, Scene& scene, const Ground& ground, bool two_tables) {
  for (const Sense s : ground.senses) {
    for (const Axis a : kAllAxes) {
      const auto& cover = ground.cover(s, a);
      if (!cover.moved || is_rotation(s)) continue;
      PlacedEffect shape;
      shape.curve = draw_curve(random, cover.places_mm);
      shape.curve.slope = random.normal();
      SmoothCurve difference = draw_curve(random, cover.places_mm);
      difference.mean = random.normal();
      UnitTable table{a, s, two_tables ? Approach::forward : Approach::unknown, {}, {}};
      UnitTable reverse{a, s, Approach::reverse, {}, {}};
      const double from_mm = cover.places_mm.front();
      const double to_mm = cover.places_mm.back();
      const int count = whole(random, 12, 60);
      for (int k = 0; k <= count; ++k) {
        const double p_mm = from_mm + (to_mm - from_mm) * k / count;
        table.p_mm.push_back(rounded(p_mm + scene.datum_mm[index_of(a)], 1000.0));
        const double half = two_tables ? 0.5 * value_at(difference, p_mm) : 0.0;
        table.value.push_back(value_at(shape.curve, p_mm) + half);
        reverse.value.push_back(value_at(shape.curve, p_mm) - half);
      }
      reverse.p_mm = table.p_mm;
      scene.map.push_back(table);
      if (two_tables) scene.map.push_back(reverse);
    }
  }
  scene.shown.compensated = chance(random, 0.6);
}

void draw_known(Random& random, Scene& scene, const Ground& ground) {
  std::vector<Axis> moved;
  for (const Sense s : ground.senses)
    for (const Axis a : kAllAxes)
      if (ground.cover(s, a).moved && ground.cover(s, a).places_mm.size() >= 8) moved.push_back(a);
  if (moved.empty()) return;
  const Axis axis = one(random, moved);
  const Component code = curve_of(static_cast<Sense>(3 + whole(random, 0, 2)), axis);
  const auto& travel = scene.machine.axes[index_of(axis)]->travel_mm;
  SmoothCurve curve =
      draw_curve(random, {travel[0], 0.8 * travel[0] + 0.2 * travel[1], 0.5 * (travel[0] + travel[1]),
                          0.3 * travel[0] + 0.7 * travel[1], 0.2 * travel[0] + 0.8 * travel[1],
                          0.1 * travel[0] + 0.9 * travel[1], 0.05 * travel[0] + 0.95 * travel[1],
                          0.15 * travel[0] + 0.85 * travel[1], 0.4 * travel[0] + 0.6 * travel[1], travel[1]});
  curve.slope = random.normal();
  KnownCurve known{code, {}, {}};
  const int count = whole(random, 15, 50);
  for (int k = 0; k <= count; ++k) {
    known.p_mm.push_back(rounded(travel[0] + (travel[1] - travel[0]) * k / count, 100.0));
    known.value.push_back(rounded(15.0 * value_at(curve, known.p_mm.back()), 1000.0));
  }
  scene.known.push_back(known);
}

}  // namespace ecs::emulator
