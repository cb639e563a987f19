#include "model/effects/quantities.hpp"

#include <algorithm>
#include <cmath>

#include "core/terms.hpp"
#include "laser/analysis/normalise.hpp"
#include "model/data/curve_basis.hpp"

namespace ecs::model {
namespace {

/// A lever below this is the rounding of a file: no rotation of a machine moves a reading through a micrometre.
constexpr double kLeastLever_mm = 1e-3;

/// Compensation of a component at a position; the mean of both tables where the approach is not known.
double value_of(const laser::ErrorMap& map, Component component, double position_mm, int approach) {
  const auto from = [&](Approach d) {
    const laser::MapTable* table = laser::table_of(map, component, d);
    return table == nullptr || table->position_mm.empty() ? 0.0 : laser::compensation_at(*table, position_mm);
  };
  if (approach != 0) return from(approach > 0 ? Approach::forward : Approach::reverse);
  return 0.5 * (from(Approach::forward) + from(Approach::reverse));
}

bool chosen_by(const EffectInstance& effect, Component component) {
  if (effect.code) return component == *effect.code;
  if (effect.axis && moving_axis(component) != *effect.axis) return false;
  return !effect.sense || sense_of(component) == *effect.sense;
}

/// Σ sign · lever [m] of a rotation in a reading, as the unit computes it: without the levers along its own axis.
double unit_lever_m(const Observations& data, std::size_t k, Component code) {
  double sum_mm = 0.0;
  for (const Term& term : data.terms) {
    if (term.component != code || !term.has_lever || !term.uses_coordinate) continue;
    if (term.lever == moving_axis(code)) continue;
    if (index_of(term.observed) != static_cast<std::size_t>(data.sense[k])) continue;
    sum_mm += term.sign * (data.position_mm[k][index_of(term.lever)] -
                           data.lines[index_of(moving_axis(code))][index_of(term.lever)]);
  }
  return sum_mm / 1000.0;
}

}  // namespace

double sensor_degC(const Observations& data, std::string_view column, std::size_t k) {
  const auto found = data.sensors_degC.find(column);
  return found == data.sensors_degC.end() ? kNotMeasured : cell(found->second, k);
}

double reference_degC(const Observations& data, std::string_view column) {
  const auto found = data.origin.sensors_degC.find(column);
  return found == data.origin.sensors_degC.end() ? 0.0 : found->second;
}

double speed_per_min(const Observations& data, std::size_t k) {
  const auto found = data.extras.find(laser::speed_column(data.rotary));
  return found == data.extras.end() ? kNotMeasured : found->second[k];
}

double air_deviation_ppm(const Observations& data, std::size_t k) {
  const laser::BeamAir air{sensor_degC(data, "t_air_degC", k), cell(data.pressure_hPa, k), cell(data.humidity_pct, k)};
  const bool measured = !std::isnan(air.temperature_degC + air.pressure_hPa + air.humidity_pct);
  if (!measured) return kNotMeasured;
  const double deviation_ppm = laser::refractive_index_deviation_ppm(air);
  const auto& reference = data.origin.air;
  if (!reference || *reference == Origin::Air{}) return deviation_ppm;
  return deviation_ppm -
         laser::refractive_index_deviation_ppm({reference->degC, reference->pressure_hPa, reference->humidity_pct});
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
  return std::abs(sum_mm) < kLeastLever_mm ? 0.0 : sum_mm / 1000.0;
}

bool is_own_motion(const Observations& data, std::size_t k, Axis axis) { return data.approach_of(k, axis) != 0; }

double map_compensation(const Observations& data, std::size_t k, const EffectInstance& effect, double shift_mm,
                        int as_approach) {
  double sum = 0.0;
  Component last = Component::A0Z;
  for (const laser::MapTable& table : data.map->tables) {
    if (table.component == last || is_squareness(table.component) || !chosen_by(effect, table.component)) continue;
    last = table.component;
    const Axis axis = moving_axis(table.component);
    const Sense sense = sense_of(table.component);
    double factor = sense == data.sense[k] ? 1.0 : 0.0;
    if (is_rotation(sense) && !is_rotation(data.sense[k])) factor = unit_lever_m(data, k, table.component);
    if (factor == 0.0) continue;
    const int approach = axis == data.axis[k] ? as_approach : 0;
    sum += factor * value_of(*data.map, table.component, data.position_mm[k][index_of(axis)] + shift_mm, approach);
  }
  return sum;
}

double map_compensation(const ReadingAt& at) {
  return map_compensation(at.data, at.k, at.effect, 0.0, at.data.approach[at.k]);
}

double side_of_artefact(const Observations& data, std::size_t k) {
  const auto found = data.extras.find("reversed");
  return found == data.extras.end() ? kNotMeasured : 1.0 - 2.0 * cell(found->second, k);
}

double side_of_artefact(const ReadingAt& at) { return side_of_artefact(at.data, at.k); }

bool first_set_up(const Observations& data, std::size_t k) {
  const auto found = data.extras.find("set_up");
  const double set_up = found == data.extras.end() ? 1.0 : cell(found->second, k);
  return std::isnan(set_up) || set_up == 1.0;
}

namespace {

/// Positions closer than this [mm] are one target: targets differ by more, and rounding of arithmetic is far below.
constexpr double kSameTarget_mm = 1e-5;

}  // namespace

std::vector<double> logarithmic(double least, double greatest, std::size_t count) {
  std::vector<double> values;
  for (std::size_t i = 0; i < count; ++i)
    values.push_back(least * std::pow(greatest / least, static_cast<double>(i) / static_cast<double>(count - 1)));
  return values;
}

std::vector<double> acting_positions(const Observations& data, const Acting& acting, Axis axis) {
  std::vector<double> p;
  for (const std::size_t k : acting.rows) p.push_back(data.p_mm(k, axis));
  return distinct(std::move(p), kSameTarget_mm);
}

std::pair<double, double> acting_range(const Observations& data, const Acting& acting, Axis axis) {
  double least = 1e300, greatest = -1e300;
  for (const std::size_t k : acting.rows) {
    least = std::min(least, data.p_mm(k, axis));
    greatest = std::max(greatest, data.p_mm(k, axis));
  }
  return {least, greatest};
}

std::pair<double, double> extent_of(const Column& column, const Acting& acting) {
  double least = 1e300, greatest = 0.0;
  for (const std::size_t k : acting.rows) {
    greatest = std::max(greatest, column[k]);
    if (column[k] > 0.0) least = std::min(least, column[k]);
  }
  return {std::min(least, greatest), greatest};
}

TriedValues tried_values(const Observations& data, const EffectInstance& effect, const Acting& acting,
                         const SearchExtent& extent) {
  const EffectDefinition& definition = effect.definition();
  const auto held = effect.parameters.find(std::string(definition.searched_parameter()));
  if (held != effect.parameters.end()) return {{held->second}, {}, 1.0};
  if (definition.search.tried == nullptr) return {{0.0}, {}, 1.0};
  return definition.search.tried(data, effect, acting, extent);
}

}  // namespace ecs::model
