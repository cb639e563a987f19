#include "model/effects/quantities.hpp"

#include <cmath>

#include "laser/analysis/refraction.hpp"

namespace ecs::model {

double sensor_degC(const Observations& data, std::string_view column, std::size_t k) {
  const auto found = data.sensors_degC.find(column);
  return found == data.sensors_degC.end() ? kNotMeasured : cell(found->second, k);
}

double first_degC(const Observations& data, std::string_view column) {
  const auto found = data.sensors_degC.find(column);
  if (found == data.sensors_degC.end()) return 0.0;
  for (const double value : found->second)
    if (!std::isnan(value)) return value;
  return kNotMeasured;
}

double air_deviation_ppm(const Observations& data, std::size_t k) {
  const laser::BeamAir air{sensor_degC(data, "t_air_degC", k), cell(data.pressure_hPa, k), cell(data.humidity_pct, k)};
  const bool measured = !std::isnan(air.temperature_degC + air.pressure_hPa + air.humidity_pct);
  return measured ? laser::refractive_index_deviation_ppm(air) : kNotMeasured;
}

double known_value(const Observations& data, Component code, double position_mm) {
  for (const KnownComponent& known : data.known) {
    if (known.code != code || known.p_mm.empty()) continue;
    const laser::MapTable table{code, Approach::unknown, known.p_mm, known.value};
    return laser::compensation_at(table, position_mm);
  }
  return kNotMeasured;
}

double lever_m(const Observations& data, std::size_t k, Component code) {
  if (is_rotation(data.sense[k])) return 0.0;
  double sum_mm = 0.0;
  for (const Term& term : data.terms) {
    if (term.component != code || !term.has_lever || !term.uses_coordinate) continue;
    if (index_of(term.observed) != static_cast<std::size_t>(data.sense[k])) continue;
    const double lever_mm = is_squareness(code) ? data.p_mm(k, term.lever)
                                                : data.position_mm[k][index_of(term.lever)] -
                                                      data.lines[index_of(moving_axis(code))][index_of(term.lever)];
    sum_mm += term.sign * lever_mm;
  }
  return sum_mm / 1000.0;
}

bool is_own_motion(const Observations& data, std::size_t k, Axis axis) {
  return data.axis[k] == axis && data.approach[k] != 0;
}

}  // namespace ecs::model
