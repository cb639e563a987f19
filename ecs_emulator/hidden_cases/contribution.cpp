#include "ecs_emulator/hidden_cases/contribution.hpp"

#include "base/units.hpp"
#include "ecs_emulator/effects/definition.hpp"
#include "ecs_emulator/scene/refraction.hpp"

namespace ecs::emulator {
namespace {

/// A stop as the effect sees it.
class StopConditions final : public Conditions {
 public:
  StopConditions(const Scene& scene, const PlacedEffect& effect, const Stop& stop)
      : scene_(scene), effect_(effect), stop_(stop) {
    p_mm = scene.p_mm(stop, effect.axis.value_or(Axis::X));
    approach = stop.approach;
    if (!effect.curve.empty()) curve = value_at(effect.curve, p_mm);
    time_s = stop.time_s;
    feed_mm_min = stop.feed_mm_min;
    load_kg = stop.load_kg;
    travel_since_reversal_mm = stop.travel_since_reversal_mm;
  }
  [[nodiscard]] double material_degC() const override { return scene_.degC("t_material_degC", stop_, 20.0); }
  [[nodiscard]] double degC(const std::string& sensor) const override { return scene_.degC(sensor, stop_, 0.0); }
  [[nodiscard]] double first_degC(const std::string& sensor) const override {
    return scene_.degC(sensor, scene_.stops.front(), 0.0);
  }
  [[nodiscard]] double missing_refraction() const override { return emulator::missing_refraction(scene_, stop_); }
  [[nodiscard]] double known_value() const override {
    for (const KnownCurve& known : scene_.known)
      if (known.code == *effect_.code)
        return between_points(known.p_mm, known.value, stop_.position_mm[index_of(moving_axis(known.code))]);
    return 0.0;
  }

 private:
  const Scene& scene_;
  const PlacedEffect& effect_;
  const Stop& stop_;
};

/// The fault that concerns a curve of the map, if any does.
bool concerns(const PlacedEffect& fault, Axis axis, Sense sense) {
  return fault.kind->seat == Seat::unit && (!fault.axis || *fault.axis == axis) &&
         (!fault.sense || *fault.sense == sense);
}

double faulty_value(const Scene& scene, const std::vector<PlacedEffect>& effects, const Stop& stop, Axis axis,
                    Sense sense) {
  MapReading reading{stop.position_mm[index_of(axis)], axis == stop.axis ? stop.approach : 0, 1.0};
  for (const PlacedEffect& fault : effects)
    if (concerns(fault, axis, sense)) fault.kind->spoil(fault, reading);
  return reading.gain * table_value(scene.map, axis, sense, reading.position_mm, reading.approach);
}

}  // namespace

double amount(const Scene& scene, const PlacedEffect& effect, const Stop& stop) {
  return acts_on(effect, stop) ? effect.kind->value(effect, StopConditions(scene, effect, stop)) : 0.0;
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
  const std::vector<PlacedEffect> parts = parts_of(effect);
  for (std::size_t k = 0; k < sum.size(); ++k) {
    const Stop& stop = scene.stops[k];
    switch (effect.kind->seat) {
      case Seat::machine:
        for (const PlacedEffect& part : parts)
          sum[k] += amount(scene, part, stop) * share_in(scene, carrier_of(part), stop);
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
