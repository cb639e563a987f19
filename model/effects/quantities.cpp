#include "model/effects/quantities.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "core/terms.hpp"
#include "laser/analysis/normalise.hpp"
#include "laser/csv_columns.hpp"
#include "model/data/curve_basis.hpp"
#include "model/data/sensor_history.hpp"

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

double acting_degC(const ReadingAt& at) {
  if (!at.late_degC.empty()) return at.late_degC[at.k];
  const double degC = sensor_degC(at.data, at.effect.sensor.empty() ? kMaterialSensor : at.effect.sensor, at.k);
  return at.effect.sensor2.empty() ? degC : degC - sensor_degC(at.data, at.effect.sensor2, at.k);
}

std::vector<double> late_degC(const Observations& data, const EffectInstance& effect, double lag_s) {
  std::vector<double> degC = followed_degC(data, effect.sensor.empty() ? kMaterialSensor : effect.sensor, lag_s);
  if (effect.sensor2.empty()) return degC;
  const std::vector<double> other_degC = followed_degC(data, effect.sensor2, lag_s);
  for (std::size_t k = 0; k < degC.size(); ++k) degC[k] -= other_degC[k];
  return degC;
}

std::vector<double> unknown_degC(const Observations& data, const EffectInstance& effect, double lag_s) {
  std::vector<double> unknown;
  for (const std::string& sensor :
       {effect.sensor.empty() ? std::string(kMaterialSensor) : effect.sensor, effect.sensor2}) {
    const std::vector<double> one = sensor.empty() ? std::vector<double>() : unknown_degC(data, sensor, lag_s);
    if (unknown.empty()) unknown.resize(one.size());
    for (std::size_t k = 0; k < one.size(); ++k) unknown[k] = std::hypot(unknown[k], one[k]);
  }
  return unknown;
}

double reference_degC(const Observations& data, std::string_view column) {
  const auto found = data.origin.sensors_degC.find(column);
  return found == data.origin.sensors_degC.end() ? 0.0 : found->second;
}

double speed_per_min(const Observations& data, std::size_t k) {
  const auto found = data.extras.find(laser::speed_column(data.rotary));
  return found == data.extras.end() ? kNotMeasured : found->second[k];
}

double reading_slope(const Observations& data, std::size_t k) {
  const auto found = data.extras.find(laser::kReadingSlopeColumn);
  return found == data.extras.end() || std::isnan(found->second[k]) ? 1.0 : found->second[k];
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

namespace {

/// Time constants tried: ten of them, at most a factor of 1.5 apart, about four of which are different trials.
constexpr double kShortestTimes = 50.0, kTrialsOfTime = 4.0;
/// Intervals of the readings in the shortest course: the first readings then show 39 and 63 % of it.
constexpr double kIntervalsOfCourse = 2.0;
constexpr std::size_t kTimes = 10;
/// Assumed for planning: a third of the time, no less than this [s]; well inside what a plan can show.
constexpr double kTimesAssumed = 3.0, kLeastTime_s = 1.0;
/// Temperatures that change less do not show a lag beside the noise of sensors, some 0.02 degC.
constexpr double kLeastChange_degC = 0.2;

/// For each reading, when the time began in which the machine was measured without a pause, whatever was read: a pause
/// is between runs, and longer than all runs took together, or a session of the line begins after it. In canonical
/// order time goes back with a new clock.
Column begin_without_pause_s(const Observations& data) {
  struct Run {
    std::tuple<Axis, Sense, int> number;
    double begin_s = 0.0, end_s = 0.0;
  };
  std::vector<Run> runs;
  std::vector<std::size_t> run_of(data.size());
  for (std::size_t k = 0; k < data.size(); ++k) {
    const double now_s = data.time_s[k];
    const std::tuple number{data.axis[k], data.sense[k], data.run[k]};
    if (!std::isnan(now_s) && (runs.empty() || runs.back().number != number || now_s < runs.back().end_s))
      runs.push_back({number, now_s, now_s});
    if (!std::isnan(now_s)) runs.back().end_s = now_s;
    run_of[k] = runs.size();
  }
  double all_s = 0.0;
  for (const Run& run : runs) all_s += run.end_s - run.begin_s;
  for (std::size_t i = 1; i < runs.size(); ++i) {
    const auto [axis, sense, run] = runs[i].number;
    const auto starts = data.sessions.find({axis, sense});
    const bool begins_session =
        starts != data.sessions.end() && std::ranges::find(starts->second, run) != starts->second.end();
    const double between_s = runs[i].begin_s - runs[i - 1].end_s;
    if (!begins_session && between_s >= 0.0 && between_s <= all_s) runs[i].begin_s = runs[i - 1].begin_s;
  }
  Column begin_of_s(data.size(), kNotMeasured);
  for (std::size_t k = 0; k < data.size(); ++k)
    if (run_of[k] > 0) begin_of_s[k] = runs[run_of[k] - 1].begin_s;
  return begin_of_s;
}

/// Greatest time constant that readings show. Without a sensor that is the longest stretch in which the machine was
/// measured without a pause until the effect was read last: what changes in a pause would pass for a longer one.
double longest_shown_s(const Observations& data, const EffectInstance& effect, const Acting& acting) {
  if (effect.traits().has_lag) return extent_of(data.time_s, acting).second;
  const auto set_up = data.extras.find("set_up");
  std::map<std::tuple<Axis, std::ptrdiff_t, double>, std::pair<double, double>> stretches;
  double longest_s = 0.0;
  const Column begin_of_s = begin_without_pause_s(data);
  for (const std::size_t k : acting.rows) {
    if (std::isnan(data.time_s[k])) continue;
    const auto starts = data.sessions.find({data.axis[k], data.sense[k]});
    const std::ptrdiff_t session =
        starts == data.sessions.end()
            ? 0
            : std::ranges::count_if(starts->second, [&](int start) { return start <= data.run[k]; });
    const double number = set_up == data.extras.end() || std::isnan(set_up->second[k]) ? 1.0 : set_up->second[k];
    auto& [begin_s, end_s] =
        stretches.try_emplace({data.axis[k], session, number}, begin_of_s[k], data.time_s[k]).first->second;
    begin_s = std::min(begin_s, begin_of_s[k]);
    end_s = std::max(end_s, data.time_s[k]);
    longest_s = std::max(longest_s, end_s - begin_s);
  }
  return longest_s;
}

/// Time between one reading and the next, median [s]; 0 for fewer than two readings.
double reading_interval_s(const Observations& data, const Acting& acting) {
  std::vector<double> times_s, intervals_s;
  for (const std::size_t k : acting.rows)
    if (!std::isnan(data.time_s[k])) times_s.push_back(data.time_s[k]);
  std::ranges::sort(times_s);
  for (std::size_t i = 1; i < times_s.size(); ++i)
    if (times_s[i] > times_s[i - 1]) intervals_s.push_back(times_s[i] - times_s[i - 1]);
  if (intervals_s.empty()) return 0.0;
  const auto middle = intervals_s.begin() + static_cast<std::ptrdiff_t>(intervals_s.size() / 2);
  std::nth_element(intervals_s.begin(), middle, intervals_s.end());
  return *middle;
}

/// Shortest time constant of which readings show the course; a shorter one is over before there are any.
double shortest_shown_s(const Observations& data, const Acting& acting) {
  return kIntervalsOfCourse * reading_interval_s(data, acting);
}

/// From the shortest to the longest time constant (docs/physics.md, 5).
ValueRange time_constant_limits(const Observations& data, const EffectInstance& effect, const Acting& acting, double) {
  const double last_s = longest_shown_s(data, effect, acting);
  double least_s = last_s / kShortestTimes;
  if (effect.traits().has_lag) least_s = std::max(least_s, shortest_shown_s(data, acting));
  return {std::min(least_s, last_s), last_s};
}

/// Of what the model does not have, no course is tried that one bad reading can imitate.
TriedValues tried_time_constants(const Observations& data, const EffectInstance& effect, const Acting& acting,
                                 const SearchExtent& extent) {
  TriedValues tried{.values = {0.0}};
  if (acting.rows.empty() || data.time_s.empty()) return tried;
  ValueRange limits = time_constant_limits(data, effect, acting, 0.0);
  if (!extent.is_of_model)
    limits.least = std::min(std::max(limits.least, shortest_shown_s(data, acting)), limits.greatest);
  tried.values.clear();
  if (limits.greatest > 0.0) tried.values = logarithmic(limits.least, limits.greatest, kTimes);
  tried.independent = kTrialsOfTime;
  return tried;
}

double assumed_time_constant(const Observations& plan, const EffectInstance&, const Acting& acting) {
  double last_s = 0.0;
  for (const std::size_t k : acting.rows)
    if (!plan.time_s.empty() && !std::isnan(plan.time_s[k])) last_s = std::max(last_s, plan.time_s[k]);
  return std::max(last_s / kTimesAssumed, kLeastTime_s);
}

/// Its temperature takes a course while it is measured.
bool changes_in_time(const Observations& data, const EffectInstance& effect) {
  if (data.time_s.empty()) return false;
  std::vector<double> degC = late_degC(data, effect, 0.0);
  std::erase_if(degC, [](double one) { return std::isnan(one); });
  if (degC.size() < 2) return false;
  const auto [least, greatest] = std::ranges::minmax_element(degC);
  if (*greatest - *least < kLeastChange_degC) return false;
  return takes_course(degC);
}

}  // namespace

SearchDefinition time_constants() {
  return {.tried = tried_time_constants, .assumed = assumed_time_constant, .limits = time_constant_limits};
}

ParameterDefinition lag_parameter() {
  return {.name = kLag, .unit = "s", .meaning = "time constant", .coding = Coding::searched, .optional = true};
}

std::vector<EffectInstance> at_once_and_late(const Site& site, const std::vector<EffectInstance>& effects) {
  std::vector<EffectInstance> all;
  for (const EffectInstance& effect : effects) {
    all.push_back(effect);
    all.back().parameters[std::string(kLag)] = 0.0;
    if (changes_in_time(site.data, effect)) all.push_back(effect);
  }
  return all;
}

std::optional<double> searched_value(const EffectInstance& effect) {
  const auto found = effect.fitted.find(std::string(effect.definition().searched_parameter()));
  return found == effect.fitted.end() ? std::nullopt : std::optional(found->second);
}

bool is_searched(const EffectInstance& effect) {
  const std::string name(effect.definition().searched_parameter());
  return !name.empty() && !effect.parameters.contains(name);
}

bool is_left_out(const EffectInstance& effect, std::string_view parameter, double value) {
  return std::ranges::any_of(effect.definition().parameters, [&](const ParameterDefinition& one) {
    return one.optional && one.name == parameter && one.neutral == value;
  });
}

void hold_optional(EffectInstance& effect) {
  for (const ParameterDefinition& parameter : effect.definition().parameters) {
    const std::string name(parameter.name);
    if (parameter.optional && !effect.parameters.contains(name) && !effect.fitted.contains(name))
      effect.parameters[name] = parameter.neutral;
  }
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
