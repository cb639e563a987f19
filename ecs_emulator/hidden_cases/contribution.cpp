#include "ecs_emulator/hidden_cases/contribution.hpp"

#include <algorithm>
#include <cmath>

#include "base/units.hpp"
#include "ecs_emulator/effects/formula.hpp"

namespace ecs::emulator {
namespace {

double known_value(const Scene& scene, Component code, double position_mm) {
  for (const KnownCurve& known : scene.known)
    if (known.code == code) return between_points(known.p_mm, known.value, position_mm);
  return 0.0;
}

double degC_of(const Scene& scene, const std::string& column, const Stop& stop, double otherwise) {
  const auto place = scene.sensor(column);
  return place ? stop.weather.degC[*place] : otherwise;
}

/// The stop as the formula of a machine's effect sees it.
EffectPoint point_of(const Scene& scene, const PlacedEffect& e, const Stop& stop, double p_mm) {
  EffectPoint at;
  at.p_mm = p_mm;
  at.approach = stop.approach;
  if (!e.curve.empty()) at.curve = value_at(e.curve, p_mm);
  if (e.kind == EffectKind::thermal_scale) at.material_degC = degC_of(scene, "t_material_degC", stop, 20.0);
  if (e.kind == EffectKind::thermal_drift)
    at.sensor_rise_degC = degC_of(scene, e.sensor, stop, 0.0) - degC_of(scene, e.sensor, scene.stops.front(), 0.0);
  at.time_s = stop.time_s;
  at.feed_mm_min = stop.feed_mm_min;
  at.load_kg = stop.load_kg;
  at.travel_since_reversal_mm = stop.travel_since_reversal_mm;
  return at;
}

/// The fault that concerns a curve of the map, if any does.
bool concerns(const PlacedEffect& fault, Axis axis, Sense sense) {
  return is_map_fault(fault.kind) && (!fault.axis || *fault.axis == axis) && (!fault.sense || *fault.sense == sense);
}

double faulty_value(const Scene& scene, const std::vector<PlacedEffect>& effects, const Stop& stop, Axis axis,
                    Sense sense) {
  double position_mm = stop.position_mm[index_of(axis)];
  int approach = axis == stop.axis ? stop.approach : 0;
  double gain = 1.0;
  for (const PlacedEffect& fault : effects) {
    if (!concerns(fault, axis, sense)) continue;
    if (fault.kind == EffectKind::map_polarity) gain = -gain;
    if (fault.kind == EffectKind::map_gain) gain *= fault.parameter("gain");
    if (fault.kind == EffectKind::map_shift) position_mm += fault.parameter("shift_mm");
    if (fault.kind == EffectKind::map_direction_swap) approach = -approach;
  }
  return gain * table_value(scene.map, axis, sense, position_mm, approach);
}

}  // namespace

std::optional<std::size_t> Scene::sensor(const std::string& column) const {
  const auto found = std::find(sensors.begin(), sensors.end(), column);
  if (found == sensors.end()) return std::nullopt;
  return static_cast<std::size_t>(found - sensors.begin());
}

double between_points(const std::vector<double>& x, const std::vector<double>& value, double at) {
  if (at <= x.front()) return value.front();
  if (at >= x.back()) return value.back();
  const auto above = static_cast<std::size_t>(std::upper_bound(x.begin(), x.end(), at) - x.begin());
  return std::lerp(value[above - 1], value[above], (at - x[above - 1]) / (x[above] - x[above - 1]));
}

double refractivity(double air_degC, double pressure_hPa, double humidity_pct) {
  constexpr double kWavenumber2 = 1.0 / (0.6329908 * 0.6329908);  // um^-2
  const double standard = 1e-8 * (8342.54 + 2406147.0 / (130.0 - kWavenumber2) + 15998.0 / (38.9 - kWavenumber2));
  const double pressure_Pa = pressure_hPa * 100.0;
  const double dry = standard * pressure_Pa / 96095.43 * (1.0 + 1e-8 * (0.601 - 0.00972 * air_degC) * pressure_Pa) /
                     (1.0 + 0.003661 * air_degC);
  const double saturated_Pa = 611.2 * std::exp(17.62 * air_degC / (243.12 + air_degC));
  return dry - 0.01 * humidity_pct * saturated_Pa * (3.7345 - 0.0401 * kWavenumber2) * 1e-10;
}

double missing_refraction(const Scene& scene, const Stop& stop) {
  return refractivity(degC_of(scene, "t_air_degC", stop, 20.0), stop.weather.pressure_hPa, stop.weather.humidity_pct) -
         refractivity(20.0, 1013.25, 50.0);
}

Seat seat_of(EffectKind kind) {
  if (is_map_fault(kind)) return Seat::unit;
  const bool instrument = kind == EffectKind::time_drift || kind == EffectKind::air_refraction ||
                          kind == EffectKind::dead_path || kind == EffectKind::cosine;
  return instrument ? Seat::instrument : Seat::machine;
}

Component component_of(const PlacedEffect& effect) {
  if (effect.kind == EffectKind::angular || effect.kind == EffectKind::squareness) return *effect.code;
  return curve_of(*effect.sense, *effect.axis);
}

bool acts_on(const PlacedEffect& e, const Stop& stop) {
  if (e.sense && *e.sense != stop.sense) return false;
  if (!is_map_fault(e.kind) && (is_of_approach(e.kind) || e.approach != Approach::unknown) && *e.axis != stop.axis)
    return false;
  return e.approach == Approach::unknown || static_cast<int>(e.approach) == stop.approach;
}

double amount(const Scene& scene, const PlacedEffect& e, const Stop& stop) {
  if (!acts_on(e, stop)) return 0.0;
  const Axis along = e.kind == EffectKind::measurement_line ? moving_axis(*e.code) : e.axis.value_or(Axis::X);
  const double p_mm = scene.p_mm(stop, along);
  switch (e.kind) {
    case EffectKind::measurement_line:
      return e.parameter("lever_mm") / kMmPerM * known_value(scene, *e.code, stop.position_mm[index_of(along)]);
    case EffectKind::air_refraction:
      return e.parameter("factor") * p_mm * 1e3 * missing_refraction(scene, stop);
    case EffectKind::dead_path:
      return e.parameter("length_m") * 1e6 * missing_refraction(scene, stop);
    case EffectKind::cosine:
      return -p_mm / kMmPerM * e.parameter("angle_mrad") * e.parameter("angle_mrad") / 2.0;
    default:
      return machine_effect(e, point_of(scene, e, stop, p_mm));
  }
}

double share_in(const Scene& scene, Component component, const Stop& stop) {
  const Axis direction = direction_of(stop.sense);
  const bool as_it_is = is_rotation(stop.sense) || !(is_angular(component) || is_squareness(component));
  if (as_it_is) return !is_squareness(component) && sense_of(component) == stop.sense ? 1.0 : 0.0;
  double share = 0.0;
  for (const Term& term : scene.terms) {
    if (term.component != component || term.observed != direction) continue;
    if (!term.uses_coordinate) continue;
    double lever_mm = stop.position_mm[index_of(term.lever)];
    if (!is_squareness(component)) lever_mm -= scene.lines_mm[index_of(moving_axis(component))][index_of(term.lever)];
    share += term.sign * lever_mm / kMmPerM;
  }
  return share;
}

double table_value(const UnitMap& map, Axis axis, Sense sense, double position_mm, int approach) {
  for (const UnitTable& table : map) {
    if (table.axis != axis || table.sense != sense) continue;
    if (table.approach == Approach::unknown || approach == 0 || static_cast<int>(table.approach) == approach)
      return between_points(table.p_mm, table.value, position_mm);
  }
  return 0.0;
}

double unit_compensation(const Scene& scene, const std::vector<PlacedEffect>& effects, const Stop& stop) {
  double sum = 0.0;
  for (std::size_t i = 0; i < scene.map.size(); ++i) {
    const UnitTable& table = scene.map[i];
    const bool again = i > 0 && scene.map[i - 1].axis == table.axis && scene.map[i - 1].sense == table.sense;
    if (again) continue;  // the reverse table of the same curve
    const double share = share_in(scene, curve_of(table.sense, table.axis), stop);
    if (share != 0.0) sum += share * faulty_value(scene, effects, stop, table.axis, table.sense);
  }
  return sum;
}

std::vector<double> contribution(const Scene& scene, const PlacedEffect& effect) {
  std::vector<double> sum(scene.stops.size());
  for (std::size_t k = 0; k < sum.size(); ++k) {
    const Stop& stop = scene.stops[k];
    switch (seat_of(effect.kind)) {
      case Seat::machine:
        sum[k] = amount(scene, effect, stop) * share_in(scene, component_of(effect), stop);
        break;
      case Seat::instrument:
        sum[k] = amount(scene, effect, stop);
        break;
      case Seat::unit:
        sum[k] = unit_compensation(scene, {effect}, stop) - unit_compensation(scene, {}, stop);
        break;
    }
  }
  return sum;
}

}  // namespace ecs::emulator
