#include "model/regression/needs.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "model/data/curve_basis.hpp"
#include "model/effects/quantities.hpp"

namespace ecs::model {
namespace {

constexpr std::string_view kMaterial = "t_material_degC";

/// A condition varies inside runs where it does so by this share of its range over all; levels of runs closer than this
/// share, or than this number of its unit (degC, ppm of the index of air), are one: sensors tell no more. Choices.
constexpr double kInsideRuns = 0.05, kOneLevel = 0.05, kOneLevelOfUnit = 0.05;
/// This many levels follow a line by more than chance even where they coincide with runs (docs/physics.md).
constexpr std::size_t kFewestLevels = 4;

struct NeedFacts {
  Need need;
  std::string_view what;     ///< as a note about the whole data set names it
  std::string_view columns;  ///< as a note about rows names it; "": the sensors of the instance
  bool (*lacking)(const Observations& data);
  double (*cell)(const Observations& data, std::size_t k, const EffectInstance& effect);  ///< NaN: lacks it
};

bool has_air(const Observations& data) {
  return data.sensors_degC.contains("t_air_degC") && !data.pressure_hPa.empty() && !data.humidity_pct.empty();
}

/// "the columns pressure_hPa and humidity_pct"
std::string air_lacking(const Observations& data) {
  std::vector<std::string_view> names;
  if (!data.sensors_degC.contains("t_air_degC")) names.emplace_back("t_air_degC");
  if (data.pressure_hPa.empty()) names.emplace_back("pressure_hPa");
  if (data.humidity_pct.empty()) names.emplace_back("humidity_pct");
  if (names.size() == 3) return "the columns t_air_degC, pressure_hPa and humidity_pct";
  return fmt::format("the {} {}", names.size() == 1 ? "column" : "columns", fmt::join(names, " and "));
}

using Data = const Observations&;
using Effect = const EffectInstance&;

constexpr std::string_view kMachineFile = "a machine file";

/// In the order of the notes.
constexpr NeedFacts kNeeds[] = {
    {Need::time, "the column time_s", "time_s", [](Data data) { return data.time_s.empty(); },
     [](Data data, std::size_t k, Effect) { return cell(data.time_s, k); }},
    {Need::sensor, "a temperature sensor (a column such as t_bed_degC)", "",
     [](Data data) { return data.sensors_degC.empty(); },
     [](Data data, std::size_t k, Effect effect) { return sensor_degC(data, effect.sensor, k); }},
    {Need::two_sensors, "a second temperature sensor", "", [](Data data) { return data.sensors_degC.size() < 2; },
     [](Data data, std::size_t k, Effect effect) {
       return sensor_degC(data, effect.sensor, k) - sensor_degC(data, effect.sensor2, k);
     }},
    {Need::material_temperature, "the column t_material_degC", kMaterial,
     [](Data data) { return !data.sensors_degC.contains(kMaterial); },
     [](Data data, std::size_t k, Effect) { return sensor_degC(data, kMaterial, k); }},
    {Need::air, "the columns t_air_degC, pressure_hPa and humidity_pct", "t_air_degC, pressure_hPa, humidity_pct",
     [](Data data) { return !has_air(data); },
     [](Data data, std::size_t k, Effect) { return air_deviation_ppm(data, k); }},
    {Need::feed, "the column feed_mm_min", "feed_mm_min", [](Data data) { return data.feed_mm_min.empty(); },
     [](Data data, std::size_t k, Effect) { return cell(data.feed_mm_min, k); }},
    {Need::speed, "the column speed_mm_min or speed_deg_min", "speed_mm_min or speed_deg_min",
     [](Data data) { return !data.extras.contains(laser::speed_column(data.rotary)); },
     [](Data data, std::size_t k, Effect) { return speed_per_min(data, k); }},
    {Need::load, "the column load_kg", "load_kg", [](Data data) { return data.load_kg.empty(); },
     [](Data data, std::size_t k, Effect) { return cell(data.load_kg, k); }},
    {Need::travel_since_reversal, "the column travel_since_reversal_mm", "travel_since_reversal_mm",
     [](Data data) { return data.travel_since_reversal_mm.empty(); },
     [](Data data, std::size_t k, Effect) { return cell(data.travel_since_reversal_mm, k); }},
    {Need::time_since_reversal, "a circle whose file states feed_mm_min", kTimeSinceReversalColumn,
     [](Data data) { return !data.extras.contains(kTimeSinceReversalColumn); },
     [](Data data, std::size_t k, Effect) {
       const auto found = data.extras.find(kTimeSinceReversalColumn);
       return found == data.extras.end() ? kNotMeasured : found->second[k];
     }},
    {Need::reversed, "the column \"reversed\"", "reversed", [](Data data) { return !data.extras.contains("reversed"); },
     [](Data data, std::size_t k, Effect) { return side_of_artefact(data, k); }},
    {Need::known, "an angular error that was measured separately, entered in the model file as [[known]]",
     "the known component", [](Data data) { return data.known.empty(); },
     [](Data data, std::size_t, Effect effect) {
       return effect.code ? known_value(data, *effect.code, 0.0) : kNotMeasured;
     }},
};

const NeedFacts& facts_of(Need need) {
  return *std::find_if(std::begin(kNeeds), std::end(kNeeds),
                       [&](const NeedFacts& facts) { return facts.need == need; });
}

/// Its note is part of the one about any sensor where there is none.
bool of_sensors(Need need) { return need == Need::two_sensors || need == Need::material_temperature; }

/// Adds "load cannot be tried: it needs the column load_kg"; nothing where no effect of the library is concerned.
template <class Chosen>
void note(const Observations& data, std::string_view what, const Chosen& chosen, std::vector<std::string>& notes) {
  std::vector<std::string_view> names;
  for (const EffectDefinition& definition : effect_library())
    if (chosen(definition) && (!data.rotary || definition.traits.on_rotary_axes)) names.push_back(definition.id);
  std::string list;
  for (std::size_t i = 0; i < names.size(); ++i)
    list += fmt::format("{}{}", i == 0 ? "" : i + 1 == names.size() ? " and " : ", ", names[i]);
  if (!names.empty())
    notes.push_back(fmt::format("{} cannot be tried: {} {}", list, names.size() == 1 ? "it needs" : "they need", what));
}

}  // namespace

bool lacks_needs(const Observations& data, const EffectDefinition& definition) {
  return std::ranges::any_of(definition.needs, [&](Need need) { return facts_of(need).lacking(data); });
}

std::string_view what_is_lacking(const Observations& data, const EffectDefinition& definition) {
  for (const NeedFacts& facts : kNeeds)
    if (definition.has_need(facts.need) && facts.lacking(data)) return facts.what;
  return definition.has_lever() && data.terms.count == 0 ? kMachineFile : "";
}

bool has_needs(const Observations& data, std::size_t k, const EffectInstance& effect) {
  const auto& needed = effect.definition().needs;
  return std::ranges::none_of(needed, [&](Need need) { return std::isnan(facts_of(need).cell(data, k, effect)); });
}

bool follows_reversal(const EffectDefinition& definition) {
  return definition.has_need(Need::travel_since_reversal) || definition.has_need(Need::time_since_reversal);
}

std::string needed_columns(const EffectInstance& effect) {
  std::string columns;
  for (const Need need : effect.definition().needs) {
    const std::string_view named = facts_of(need).columns;
    columns += fmt::format("{}{}", columns.empty() ? "" : ", ", named.empty() ? sensors_text(effect) : named);
  }
  return columns;
}

bool may_be_tied_to_runs(const EffectDefinition& definition) {
  return std::ranges::any_of(definition.turns_into, [](const Becomes& b) { return b.limit == Limit::tied_to_runs; });
}

bool is_tied_to_runs(const Observations& data, const EffectInstance& effect) {
  if (!may_be_tied_to_runs(effect.definition())) return false;
  const auto& needed = effect.definition().needs;
  return std::ranges::none_of(needed, [&](Need need) {
    std::map<int, std::pair<double, double>> runs;  // least and greatest value
    for (std::size_t k = 0; k < data.size(); ++k) {
      const double value = facts_of(need).cell(data, k, effect);
      if (std::isnan(value) || (effect.traits().until_new_set_up && !first_set_up(data, k))) continue;
      auto& run = runs.try_emplace(data.run[k], value, value).first->second;
      run = {std::min(run.first, value), std::max(run.second, value)};
    }
    if (runs.size() < 2) return true;  // no runs that it could coincide with
    double least = runs.begin()->second.first, greatest = runs.begin()->second.second, inside = 0.0;
    std::vector<double> levels;
    for (const auto& each : runs) {
      least = std::min(least, each.second.first);
      greatest = std::max(greatest, each.second.second);
      inside = std::max(inside, each.second.second - each.second.first);
      levels.push_back(0.5 * (each.second.first + each.second.second));
    }
    const double range = greatest - least;
    const std::size_t count = distinct(levels, std::max(kOneLevel * range, kOneLevelOfUnit)).size();
    return inside > kInsideRuns * range || count < 2 || count >= kFewestLevels;
  });
}

bool EffectDefinition::has_need(Need need) const { return std::ranges::find(needs, need) != needs.end(); }

namespace {

/// "t_bed_degC follows the runs: ...", once a sensor; air likewise.
void add_tied_to_runs(const Observations& data, std::vector<std::string>& notes) {
  std::map<std::string, std::vector<std::string_view>> effects_of;  // by column
  for (const EffectDefinition& definition : effect_library()) {
    if (lacks_needs(data, definition) || definition.has_need(Need::two_sensors)) continue;
    std::vector<std::string> sensors{""};
    if (definition.has_need(Need::sensor)) {
      sensors.clear();
      for (const auto& each : data.sensors_degC) sensors.push_back(each.first);
    }
    for (const std::string& sensor : sensors) {
      EffectInstance effect;
      effect.id = &definition;
      effect.sensor = sensor;
      if (is_tied_to_runs(data, effect)) effects_of[needed_columns(effect)].push_back(definition.id);
    }
  }
  for (const auto& [columns, effects] : effects_of)
    notes.push_back(
        fmt::format("{} changes only from run to run, with fewer than {} levels: {} cannot be distinguished from the "
                    "offset of a run",
                    columns, kFewestLevels, fmt::join(effects, " and ")));
}

/// Readings that an artefact gives: a translation across the axis that moves.
bool has_readings_across(const Observations& data) {
  for (std::size_t k = 0; k < data.size(); ++k)
    if (!is_rotation(data.sense[k]) && direction_of(data.sense[k]) != data.axis[k]) return true;
  return false;
}

bool has_circle(const Observations& all) {
  return std::ranges::any_of(all.paths, [](const Path& path) { return path.kind == PathKind::circle; });
}

}  // namespace

std::vector<std::string> untried_effects(const Observations& all) {
  const Observations& data = all.motions();
  std::vector<std::string> notes;
  for (const NeedFacts& facts : kNeeds) {
    if (facts.need == Need::known || facts.need == Need::speed || !facts.lacking(data)) continue;
    if (of_sensors(facts.need) && data.sensors_degC.empty()) continue;
    if (facts.need == Need::reversed && !has_readings_across(data)) continue;
    if (facts.need == Need::time_since_reversal && !has_circle(all)) continue;
    const auto concerned = [&](const EffectDefinition& definition) {
      return facts.need == Need::sensor ? definition.has_need(Need::sensor) || definition.has_need(Need::two_sensors) ||
                                              definition.has_need(Need::material_temperature)
                                        : definition.has_need(facts.need);
    };
    note(data, facts.need == Need::air ? air_lacking(data) : std::string(facts.what), concerned, notes);
  }
  if (data.time_s.empty() && data.size() > 0)
    notes.emplace_back(
        "the column time_s is missing: the tests of the residual use the order of the rows (row) instead");
  add_tied_to_runs(data, notes);
  if (std::ranges::all_of(data.approach, [](int d) { return d == 0; }))
    notes.emplace_back("effects of the approach cannot be tried: they need readings of a known approach");
  if (data.terms.count == 0)
    note(
        data, kMachineFile, [](const EffectDefinition& definition) { return definition.has_lever(); }, notes);
  if (data.known.empty())
    note(
        data, facts_of(Need::known).what,
        [](const EffectDefinition& definition) { return definition.has_need(Need::known); }, notes);
  const auto compensated = static_cast<std::size_t>(std::ranges::count(data.compensated, true));
  if (!data.map && compensated > 0) {
    note(
        data, "the map that was active while readings were compensated (compensated = 1): [map] in the model file",
        [](const EffectDefinition& definition) { return definition.place == Place::map; }, notes);
    if (compensated < data.size())
      notes.push_back(
          fmt::format("{} of the {} readings were taken with compensation: without [map] in the model file they "
                      "are treated as errors of the machine like the others. State it there, or give both kinds alone",
                      compensated, data.size()));
  }
  return notes;
}

}  // namespace ecs::model
