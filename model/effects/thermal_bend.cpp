// A column or bed bent by a temperature difference between its sides: a beam with a gradient across it takes the form
// of a circle, c·p²·(T1 − T2) (Timoshenko 1925), across the moving axis; both temperatures
// may be followed late.
#include <algorithm>
#include <cmath>

#include "model/effects/definition.hpp"
#include "model/effects/quantities.hpp"

namespace ecs::model::effects {
namespace {

/// A difference that varies less is that of two sensors, not of two sides: it would be `sag` under another name.
constexpr double kLeastVariation_degC = 0.1;

bool difference_varies(const Observations& data, const Column& one, const Column& other) {
  double least = 1e300, greatest = -1e300;
  for (std::size_t k = 0; k < data.size(); ++k) {
    const double difference = cell(one, k) - cell(other, k);
    if (std::isnan(difference)) continue;
    least = std::min(least, difference);
    greatest = std::max(greatest, difference);
  }
  return greatest - least >= kLeastVariation_degC;
}

/// Every pair of sensors once, by name; the sign is in the coefficient.
std::vector<EffectInstance> pairs_of_sensors(const Site& site) {
  std::vector<EffectInstance> all;
  if (is_rotation(site.sense) || site.is_positioning()) return all;
  const auto& sensors = site.data.sensors_degC;
  for (auto one = sensors.begin(); one != sensors.end(); ++one)
    for (auto other = std::next(one); other != sensors.end(); ++other) {
      if (!difference_varies(site.data, one->second, other->second)) continue;
      all.push_back(site.once().front());
      all.back().sensor = one->first;
      all.back().sensor2 = other->first;
    }
  return at_once_and_late(site, all);
}

}  // namespace

EffectDefinition thermal_bend() {
  return {
      .id = "thermal_bend",
      .title = "Thermal bending",
      .formula = "c p^2 (T1 - T2), across the axis",
      .cause = "column or bed bent by a temperature difference between its sides",
      .tells_apart = "a parabola across the axis that follows the difference of two sensors",
      .check =
          "measure the temperature of both sides of the column or bed and check for motors, coolant, sun or draught; "
          "mount a level on it while they change",
      .headline = "bending of {readings} by {um_per_m2_degC} of temperature difference between {sensor} and {sensor2}",
      .parameters = {lag_parameter(), {"um_per_m2_degC", "um/m2/degC", "bending"}},
      .carrier = Carrier::inputs,
      .live = {{"um_per_m2_degC", ThermalLaw::bending, LiveSource::difference}},
      .how = "a thermal row of the map that follows the difference of its two sensors",
      .separated_by = {25,
                       "Repeat the {axis} line with the difference between the two sensors changed by 2 degC or more: "
                       "one side warmed, or shaded."},
      .turns_into = {{Limit::tied_to_runs, "sag"},
                     {Limit::at_least, "thermal_bend"},
                     {Limit::at_greatest, "thermal_bend"}},
      .traits = {.has_lag = true, .of_condition = true, .one_per_axis = true},
      .needs = {Need::two_sensors},
      .preference = 75,
      .columns = [](const ReadingAt& at, std::span<double> row) { row[0] = at.p_m() * at.p_m() * acting_degC(at); },
      .search = time_constants(),
      .along_axis = pairs_of_sensors,
  };
}

}  // namespace ecs::model::effects
