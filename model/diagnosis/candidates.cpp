#include "model/diagnosis/candidates.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "model/data/curve_basis.hpp"

namespace ecs::model {
namespace {

using enum EffectId;

EffectInstance instance(EffectId id, Axis axis, Sense sense) {
  EffectInstance effect;
  effect.id = id;
  effect.axis = axis;
  effect.sense = sense;
  return effect;
}

bool is_positioning_sense(Sense sense, Axis axis) { return !is_rotation(sense) && direction_of(sense) == axis; }

bool has(const Observations& data, Sense sense) {
  return std::find(data.sense.begin(), data.sense.end(), sense) != data.sense.end();
}

std::vector<Axis> moved_axes(const Observations& data, Sense sense) {
  std::vector<Axis> axes;
  for (const Axis a : kAllAxes)
    for (std::size_t k = 0; k < data.size(); ++k)
      if (data.sense[k] == sense && data.axis[k] == a) {
        axes.push_back(a);
        break;
      }
  return axes;
}

bool both_approaches(const Observations& data, Sense sense, Axis axis) {
  bool forward = false, reverse = false;
  for (std::size_t k = 0; k < data.size(); ++k) {
    if (data.sense[k] != sense || data.axis[k] != axis) continue;
    forward = forward || data.approach[k] > 0;
    reverse = reverse || data.approach[k] < 0;
  }
  return forward && reverse;
}

std::size_t places(const Observations& data, Sense sense, Axis axis) {
  std::vector<double> values;
  for (std::size_t k = 0; k < data.size(); ++k)
    if (data.sense[k] == sense) values.push_back(data.p_mm(k, axis));
  return distinct(std::move(values), 1e-6).size();
}

bool has_air(const Observations& data) {
  return data.sensors_degC.contains("t_air_degC") && !data.pressure_hPa.empty() && !data.humidity_pct.empty();
}

void add_along(const Observations& data, Sense sense, Axis axis, std::vector<EffectInstance>& out) {
  const std::size_t distinct_places = places(data, sense, axis);
  const bool positioning = is_positioning_sense(sense, axis);
  out.push_back(instance(scale, axis, sense));
  if (distinct_places >= 6) out.push_back(instance(progressive, axis, sense));
  if (distinct_places >= 6) out.push_back(instance(cyclic, axis, sense));
  if (distinct_places >= 8) out.push_back(instance(step, axis, sense));
  if (distinct_places >= 6) out.push_back(instance(sag, axis, sense));
  if (!is_rotation(sense))
    for (const KnownComponent& known : data.known) {
      if (moving_axis(known.code) != axis || !is_angular(known.code)) continue;
      EffectInstance line = instance(measurement_line, axis, sense);
      line.code = known.code;
      out.push_back(line);
    }
  if (data.sensors_degC.contains("t_material_degC")) out.push_back(instance(thermal_scale, axis, sense));
  if (positioning) out.push_back(instance(cosine, axis, sense));
  if (positioning && has_air(data)) out.push_back(instance(air_refraction, axis, sense));
  if (!data.time_s.empty()) out.push_back(instance(warm_up, axis, sense));
  if (!data.load_kg.empty()) out.push_back(instance(load, axis, sense));
}

void add_of_approach(const Observations& data, Sense sense, Axis axis, std::vector<EffectInstance>& out) {
  if (!both_approaches(data, sense, axis)) return;
  out.push_back(instance(backlash, axis, sense));
  if (places(data, sense, axis) >= 6) {
    out.push_back(instance(reversal_curve, axis, sense));
    for (const ApproachMode mode : {ApproachMode::forward, ApproachMode::reverse}) {
      out.push_back(instance(cyclic, axis, sense));
      out.back().approach = mode;
    }
  }
  if (!data.feed_mm_min.empty()) out.push_back(instance(servo_lag, axis, sense));
  if (!data.travel_since_reversal_mm.empty()) out.push_back(instance(reversal_spike, axis, sense));
}

void add_of_place(const Observations& data, Sense sense, std::vector<EffectInstance>& out) {
  const Axis axis = natural_axis(data, sense);
  out.push_back(instance(offset, axis, sense));
  for (const auto& [sensor, column] : data.sensors_degC) {
    EffectInstance drift = instance(thermal_drift, axis, sense);
    drift.sensor = sensor;
    out.push_back(drift);
  }
  if (!data.time_s.empty()) {
    out.push_back(instance(time_drift, axis, sense));
    if (varied_axes(data, sense).empty()) out.push_back(instance(warm_up, axis, sense));
  }
  if (!data.load_kg.empty() && varied_axes(data, sense).empty()) out.push_back(instance(load, axis, sense));
  if (has_air(data) && !is_rotation(sense)) out.push_back(instance(dead_path, axis, sense));
}

void add_levered(const Observations& data, std::vector<EffectInstance>& out) {
  std::set<Component> seen;
  for (const Term& term : data.terms) {
    if (!term.has_lever || !term.uses_coordinate) continue;
    if (!has(data, static_cast<Sense>(term.observed)) || !seen.insert(term.component).second) continue;
    EffectInstance effect;
    effect.id = is_squareness(term.component) ? squareness : angular;
    effect.axis = is_squareness(term.component) ? term.lever : moving_axis(term.component);
    effect.code = term.component;
    out.push_back(effect);
  }
}

void add_map_faults(const Observations& data, std::vector<EffectInstance>& out) {
  if (!data.map || std::find(data.compensated.begin(), data.compensated.end(), true) == data.compensated.end()) return;
  std::vector<EffectInstance> places;
  std::set<Component> components;
  std::set<Axis> axes;
  for (const laser::MapTable& table : data.map->tables) {
    components.insert(table.component);
    axes.insert(moving_axis(table.component));
  }
  for (const Component component : components) {
    EffectInstance one;
    one.axis = moving_axis(component);
    one.sense = sense_of(component);
    if (is_angular(component)) {
      one.sense = std::nullopt;
      one.code = component;
    }
    places.push_back(one);
  }
  for (const Axis axis : axes) {
    const auto of_axis = [&](Component c) { return moving_axis(c) == axis; };
    if (std::count_if(components.begin(), components.end(), of_axis) < 2) continue;  // it is that component
    EffectInstance one;
    one.axis = axis;
    places.push_back(one);
  }
  places.emplace_back();  // the whole map
  for (const EffectId id : {map_polarity, map_gain, map_shift, map_direction_swap})
    for (EffectInstance place : places) {
      place.id = id;
      out.push_back(place);
    }
}

}  // namespace

Axis natural_axis(const Observations& data, Sense sense) {
  const std::vector<Axis> moved = moved_axes(data, sense);
  const Axis own = direction_of(sense);
  if (moved.empty() || std::find(moved.begin(), moved.end(), own) != moved.end()) return own;
  return moved.front();
}

std::vector<Axis> varied_axes(const Observations& data, Sense sense) {
  std::vector<Axis> axes;
  for (const Axis a : kAllAxes)
    if (places(data, sense, a) >= 2) axes.push_back(a);
  return axes;
}

std::vector<EffectInstance> candidate_instances(const Observations& data) {
  std::vector<EffectInstance> out;
  for (const Sense sense : {Sense::EX, Sense::EY, Sense::EZ, Sense::EA, Sense::EB, Sense::EC}) {
    if (!has(data, sense)) continue;
    add_of_place(data, sense, out);
    for (const Axis axis : varied_axes(data, sense)) add_along(data, sense, axis, out);
    for (const Axis axis : moved_axes(data, sense)) add_of_approach(data, sense, axis, out);
  }
  add_levered(data, out);
  add_map_faults(data, out);
  return out;
}

std::vector<EffectInstance> usual_effects(const Observations& data) {
  std::vector<EffectInstance> usual;
  for (const Sense sense : {Sense::EX, Sense::EY, Sense::EZ, Sense::EA, Sense::EB, Sense::EC}) {
    if (!has(data, sense)) continue;
    usual.push_back(instance(offset, natural_axis(data, sense), sense));
    for (const Axis axis : moved_axes(data, sense)) {
      if (places(data, sense, axis) >= 3) usual.push_back(instance(scale, axis, sense));
      if (both_approaches(data, sense, axis)) usual.push_back(instance(backlash, axis, sense));
    }
  }
  return usual;
}

std::vector<std::string> untried_effects(const Observations& data) {
  std::vector<std::string> notes;
  const auto note = [&](bool lacking, const char* text) {
    if (lacking) notes.emplace_back(text);
  };
  note(data.time_s.empty(), "no time_s: warm_up and time_drift cannot be tried");
  note(data.sensors_degC.empty(), "no temperature sensor: thermal_scale and thermal_drift cannot be tried");
  note(!data.sensors_degC.empty() && !data.sensors_degC.contains("t_material_degC"),
       "no t_material_degC: thermal_scale cannot be tried");
  note(!has_air(data),
       "no t_air_degC, pressure_hPa and humidity_pct together: air_refraction and dead_path cannot be tried");
  note(data.feed_mm_min.empty(), "no feed_mm_min: servo_lag cannot be tried");
  note(data.load_kg.empty(), "no load_kg: load cannot be tried");
  note(data.travel_since_reversal_mm.empty(), "no travel_since_reversal_mm: reversal_spike cannot be tried");
  note(std::all_of(data.approach.begin(), data.approach.end(), [](int d) { return d == 0; }),
       "no approach: effects of approach cannot be tried");
  note(data.terms.count == 0, "no machine: angular and squareness cannot be tried");
  note(data.known.empty(), "no [[known]] component: measurement_line cannot be tried");
  return notes;
}

}  // namespace ecs::model
