#include "model/fit/compiled_model.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/terms.hpp"
#include "model/effects/artefact_place.hpp"
#include "model/effects/definition.hpp"
#include "model/effects/quantities.hpp"
#include "model/fit/compiled_rotary.hpp"
#include "model/fit/fit.hpp"

namespace ecs::model {
namespace {

/// The component that a table of this effect belongs to; nothing if no single table can carry it.
std::optional<Component> table_of_effect(const EffectInstance& effect) {
  if (effect.definition().carrier != Carrier::error_map) return std::nullopt;
  if (effect.definition().has_lever()) return effect.code;
  if (!effect.axis || !effect.sense) return std::nullopt;
  return curve_of(*effect.sense, *effect.axis);
}

/// What the effect adds to a component along its axis at these positions; of a rotation the angle itself.
Result<std::vector<double>> along_axis(const Model& fitted, const EffectInstance& effect, Component component,
                                       const params::Machine& machine, const std::vector<double>& grid, int approach) {
  std::vector<double> values;
  for (const ComponentTerm& term : components_of(effect.definition())) {
    if (term.component != component) continue;
    const double datum_mm = machine.axes[index_of(moving_axis(component))]->datum_mm;
    for (const double p : grid) values.push_back(*given_or_fitted(effect, term.parameter) * (p - datum_mm) / 1000.0);
    return values;
  }
  if (effect.definition().place == Place::rotation) {
    if (effect.curve.empty())
      return problem(ProblemKind::bad_input,
                     fmt::format("{}: has no curve; fit the model to data first", to_text(effect)));
    const laser::MapTable curve{Component::EXX, Approach::unknown, effect.curve.p_mm, effect.curve.value};
    for (const double p : grid) values.push_back(laser::compensation_at(curve, p));
    return values;
  }
  laser::MeasurementSet set;
  for (const double p : grid) {
    laser::Reading reading;
    reading.axis = *effect.axis;
    reading.sense = *effect.sense;
    reading.position_mm[index_of(*effect.axis)] = p;
    reading.approach = static_cast<Approach>(approach);
    reading.row = static_cast<int>(set.readings.size()) + 1;
    set.readings.push_back(reading);
  }
  Model alone = fitted;
  alone.effects = {effect};
  const Observations at = observations_of(set, alone, machine);
  ECS_TRY(predicted_values, predicted(alone, at));
  values.resize(grid.size());
  for (std::size_t k = 0; k < at.size(); ++k) values[static_cast<std::size_t>(at.row[k] - 1)] = predicted_values[k];
  return values;
}

/// An effect that varies by this many times what the table with it does is cancelled by others: the readings do not
/// determine it (docs/model.md, "A map from a model").
constexpr double kMostOfTable = 100.0, kLeastRange_um = 0.1;  // below, it is no error of a machine

double range_of(const std::vector<double>& values) {
  const auto [least, greatest] = std::ranges::minmax_element(values);
  return values.empty() ? 0.0 : *greatest - *least;
}

/// A constant: it shifts the zero of a table, which counts from the reference position anyway.
bool is_zero(const EffectInstance& effect) { return effect.traits().is_usual && effect.traits().shows_at_zero; }

/// A table takes effects that collide with one another only, for their sum is determined.
std::vector<Problem> undetermined_beside_others(const Model& fitted,
                                                const std::vector<const EffectInstance*>& carried) {
  std::vector<Problem> problems;
  for (const EffectInstance* effect : carried) {
    if (!effect->undetermined || is_zero(*effect)) continue;
    std::vector<std::string> outside = *effect->undetermined;
    std::erase_if(outside, [&](const std::string& name) {
      const auto is_named = [&](const EffectInstance& one) { return to_text(one) == name; };
      return std::ranges::none_of(fitted.effects, is_named) ||
             std::ranges::any_of(carried, [&](const EffectInstance* one) { return is_named(*one); });
    });
    if (outside.empty()) continue;
    problems.push_back(
        problem(ProblemKind::refused,
                fmt::format("{}: the fitted readings cannot distinguish it from {}, which no map can compensate; make "
                            "the measurement that separates them (ecs model next), or remove one of them and fit again",
                            to_text(*effect), fmt::join(outside, ", ")))
            .value());
  }
  return problems;
}

/// What a row follows, and where it is zero. @pre is_carried(effect, machine)
Result<ThermalRow> followed(const EffectInstance& effect, const LiveTerm& term, const Model& fitted,
                            const params::Machine& machine) {
  ThermalRow row;
  row.law = term.law;
  if (effect.traits().has_lag) row.lag_s = given_or_fitted(effect, kLag).value_or(0.0);
  const auto input = [&](std::string_view sensor) { return static_cast<std::uint8_t>(*machine.input_of(sensor)); };
  switch (term.source) {
    case LiveSource::material:
      row.source = input(kMaterialSensor);
      break;
    case LiveSource::difference:
      row.source = input(effect.sensor);
      row.minus = input(effect.sensor2);
      row.reference = 0.0;
      break;
    case LiveSource::sensor: {
      row.source = input(effect.sensor);
      const auto first = fitted.origin ? fitted.origin->sensors_degC.find(effect.sensor)
                                       : std::map<std::string, double, std::less<>>::const_iterator{};
      if (!fitted.origin || first == fitted.origin->sensors_degC.end())
        return problem(ProblemKind::refused,
                       fmt::format("the model does not state the temperature of {} at its origin: fit it to data "
                                   "(`ecs model fit`)",
                                   effect.sensor));
      row.reference = first->second;
      break;
    }
    case LiveSource::motion: {
      const Axis axis = *live_motion_of(effect, machine);
      row.source = static_cast<std::uint8_t>(kMotionOfX + index_of(axis));
      row.reference = *machine.full_duty_mm_min[index_of(axis)];
      row.lag_s = given_or_fitted(effect, "tau_s").value_or(0.0);
      break;
    }
    case LiveSource::load:
      row.source = static_cast<std::uint8_t>(kLoadInput);
      row.reference = 0.0;
      break;
  }
  return row;
}

/// The effect as rows of the unit: compensation, so minus its coefficients. @return why it cannot be, or nothing
std::optional<std::string> add_live_rows(const EffectInstance& effect, const Model& fitted,
                                         const params::Machine& machine, CompiledModel& out) {
  if (!effect.sense) return "it has no direction";
  const Axis axis = effect.axis.value_or(direction_of(*effect.sense));
  std::vector<ThermalRow> rows;
  for (const LiveTerm& term : effect.definition().live) {
    const auto size = given_or_fitted(effect, term.parameter);
    if (!size || *size == 0.0) continue;
    auto row = followed(effect, term, fitted, machine);
    if (!row) return row.error().message;
    row->component = curve_of(*effect.sense, axis);
    row->coefficient = -*size;
    row->origin_mm = machine.axes[index_of(axis)] ? machine.axes[index_of(axis)]->datum_mm : 0.0;
    if (!sound(*row)) return "its sizes are beyond the ranges of the unit's rows";
    rows.push_back(*row);
  }
  if (rows.empty()) return "its sizes are not known: fit the model to data";
  auto& header = out.map.header;
  for (const ThermalRow& row : rows) {
    for (const std::uint8_t input : {row.source, row.minus})
      if (input < kTemperatureInputs &&
          std::ranges::find(header.inputs, input, &laser::NamedInput::input) == header.inputs.end())
        header.inputs.push_back({input, machine.inputs[input]});
    header.thermal.push_back(row);
    const std::string late = effect.traits().has_lag && row.lag_s > 0.0
                                 ? fmt::format(", followed with a time constant of {:.4g} s", row.lag_s)
                                 : std::string();
    out.carried.push_back(fmt::format("{}: thermal row {} {}, {}{}", to_text(effect), name_of(row.component),
                                      name_of(row.law), laser::source_text(header, row.source), late));
  }
  return std::nullopt;
}

using EffectsOfTables = std::map<Component, std::vector<const EffectInstance*>>;

/// The sizes of the effect that belong to a component: squareness at once, the others as part of their tables.
void add_components(const EffectInstance& effect, const params::Machine& machine, CompiledModel& out,
                    EffectsOfTables& tables) {
  std::vector<std::string> places;
  for (const ComponentTerm& term : components_of(effect.definition())) {
    const double size = given_or_fitted(effect, term.parameter).value_or(0.0);
    if (size == 0.0 || (!is_squareness(term.component) && !machine.axes[index_of(moving_axis(term.component))]))
      continue;
    if (is_squareness(term.component)) {
      out.squareness[index_of(term.component)] += size;
      double& largest = out.largest[to_text(effect)];
      largest = std::max(largest, std::abs(size));
    } else {
      tables[term.component].push_back(&effect);
    }
    places.push_back(fmt::format("{} {:.3g} um/m", name_of(term.component), size));
  }
  out.carried.push_back(
      fmt::format("{}: {} in tables and the unit's parameters", to_text(effect), fmt::join(places, ", ")));
}

bool differs_by_approach(const EffectInstance& effect) {
  return effect.traits().of_approach || effect.approach != ApproachMode::both;
}

}  // namespace

std::vector<double> table_positions(const params::MachineAxis& axis, double increment_mm) {
  std::vector<double> grid;
  const auto count =
      static_cast<std::size_t>(std::floor((axis.travel_mm[1] - axis.travel_mm[0]) / increment_mm + 1e-9));
  for (std::size_t i = 0; i <= count; ++i) grid.push_back(axis.travel_mm[0] + increment_mm * static_cast<double>(i));
  if (axis.travel_mm[1] - grid.back() > 1e-6) grid.push_back(axis.travel_mm[1]);
  return grid;
}

Result<CompiledModel> compiled(const Model& fitted, const params::Machine& machine, double increment_mm) {
  if (!(increment_mm > 0.0))
    return problem(ProblemKind::usage, fmt::format("expected an increment above 0 mm, got {}", increment_mm));
  if (auto missing = problems_without_values(fitted); !missing.empty())
    return tl::unexpected(folded(std::move(missing)));
  CompiledModel out;
  EffectsOfTables tables;
  std::vector<const EffectInstance*> carried, rotary;
  for (const EffectInstance& effect : fitted.effects) {
    if (effect.undetermined && effect.undetermined->empty()) {
      out.not_carried.push_back(fmt::format("{}: the fitted readings do not determine it", to_text(effect)));
      continue;
    }
    if (!components_of(effect.definition()).empty() && is_carried(effect, machine)) {
      add_components(effect, machine, out, tables);
      carried.push_back(&effect);
      continue;
    }
    if (is_rotary_error(effect) && is_carried(effect, machine)) {
      rotary.push_back(&effect);
      carried.push_back(&effect);
      continue;
    }
    const auto component = table_of_effect(effect);
    if (effect.definition().place == Place::squareness && effect.code) {
      const auto value = effect.parameters.contains("um_per_m") ? effect.parameters : effect.fitted;
      if (const auto found = value.find("um_per_m"); found != value.end()) {
        out.squareness[index_of(*effect.code)] += found->second;
        carried.push_back(&effect);
        out.largest[to_text(effect)] = std::abs(found->second);
        out.carried.push_back(fmt::format("{}: {:.3g} um/m in the unit's parameters", to_text(effect), found->second));
        continue;
      }
    }
    if (effect.definition().carrier == Carrier::inputs && is_carried(effect, machine)) {
      if (const auto why = add_live_rows(effect, fitted, machine, out))
        out.not_carried.push_back(fmt::format("{}: {}", to_text(effect), *why));
      else
        carried.push_back(&effect);
      continue;
    }
    if (component && machine.axes[index_of(moving_axis(*component))] && is_carried(effect, machine)) {
      tables[*component].push_back(&effect);
      carried.push_back(&effect);
      out.carried.push_back(fmt::format("{}: table {}", to_text(effect), name_of(*component)));
    } else {
      out.not_carried.push_back(fmt::format("{}: {}", to_text(effect), how_compensated(effect, machine)));
    }
  }
  out.map.header.machine = machine.name;
  out.map.header.configuration = machine.configuration;
  std::vector<Problem> problems = undetermined_beside_others(fitted, carried);
  if (auto added = add_rotary_axes(out, fitted, machine, rotary); !added) problems.push_back(added.error());
  for (const auto& [component, effects] : tables) {
    const params::MachineAxis& axis = *machine.axes[index_of(moving_axis(component))];
    const std::vector<double> grid = table_positions(axis, increment_mm);
    const bool two = std::ranges::any_of(effects, [](const EffectInstance* e) { return differs_by_approach(*e); });
    std::vector<std::string> names;
    for (const EffectInstance* effect : effects) names.push_back(to_text(*effect));
    for (const Approach approach :
         two ? std::vector<Approach>{Approach::forward, Approach::reverse} : std::vector<Approach>{Approach::unknown}) {
      laser::MapTable table{component, approach, grid, std::vector<double>(grid.size(), 0.0)};
      std::vector<double> ranges;
      for (const EffectInstance* effect : effects) {
        const auto values = along_axis(fitted, *effect, component, machine, grid, two ? static_cast<int>(approach) : 1);
        if (!values) {
          problems.push_back(values.error());
          break;
        }
        for (std::size_t i = 0; i < grid.size(); ++i) table.compensation[i] -= (*values)[i];
        double& largest = out.largest[to_text(*effect)];
        for (const double value : *values) largest = std::max(largest, std::abs(value));
        ranges.push_back(range_of(*values));
      }
      const auto most = std::ranges::max_element(ranges);
      if (most != ranges.end() && *most > kMostOfTable * std::max(range_of(table.compensation), kLeastRange_um))
        problems.push_back(problem(ProblemKind::refused,
                                   fmt::format("{} varies by {:.3g} um in a table that varies by {:.3g} um: effects of "
                                               "the model cancel each other; remove one of them and fit again",
                                               to_text(*effects[static_cast<std::size_t>(most - ranges.begin())]),
                                               *most, range_of(table.compensation)))
                               .value());
      out.map.tables.push_back(std::move(table));
    }
    out.map.header.processing.push_back(
        fmt::format("{} compiled from the model: {}", name_of(component), fmt::join(names, " + ")));
    for (const LadderStep& step : fitted.history)
      if (std::ranges::find(names, step.effect) != names.end())
        out.map.header.processing.push_back(fmt::format("{} fitted to {}", step.effect, step.data));
  }
  if (!problems.empty()) return tl::unexpected(folded(std::move(problems)));
  return out;
}

namespace {

using laser::MapTable;

/// Rows of the physical machine that a unit leaves out, because its measured curves hold them.
std::vector<Term> own_lever_rows(const params::Machine& machine) {
  std::vector<Term> rows;
  const auto chain = params::chain_of(machine);
  if (!chain) return rows;
  const auto physical = terms_of(*chain, Convention::iso, CurveKind::carriage);
  const auto measured = terms_of(*chain, Convention::iso, CurveKind::measured);
  if (!physical || !measured) return rows;
  for (const Term& row : *physical)
    if (row.has_lever && row.uses_coordinate && std::ranges::find(*measured, row) == measured->end())
      rows.push_back(row);
  return rows;
}

bool has_table(const laser::ErrorMap& map, Component component) {
  return std::ranges::any_of(map.tables, [&](const MapTable& table) { return table.component == component; });
}

void sort_tables(laser::ErrorMap& map) {
  std::ranges::stable_sort(map.tables, [](const MapTable& a, const MapTable& b) {
    return index_of(a.component) != index_of(b.component) ? index_of(a.component) < index_of(b.component)
                                                          : a.approach > b.approach;
  });
}

}  // namespace

std::vector<OwnLever> add_own_levers(CompiledModel& compiled, const Model& fitted, const params::Machine& machine,
                                     double increment_mm) {
  std::vector<OwnLever> added;
  const MeasurementLines lines = params::measurement_lines_of(machine);
  for (const Term& row : own_lever_rows(machine))
    for (const EffectInstance& effect : fitted.effects) {
      if (effect.definition().place != Place::rotation || effect.code != row.component || effect.curve.empty())
        continue;
      const Axis axis = moving_axis(row.component);
      if (!machine.axes[index_of(axis)]) continue;
      const Component target = curve_of(static_cast<Sense>(row.observed), axis);
      if (!has_table(compiled.map, target)) {
        const auto grid = table_positions(*machine.axes[index_of(axis)], increment_mm);
        compiled.map.tables.push_back({target, Approach::unknown, grid, std::vector<double>(grid.size(), 0.0)});
      }
      const MapTable angle{row.component, Approach::unknown, effect.curve.p_mm, effect.curve.value};
      for (MapTable& table : compiled.map.tables) {
        if (table.component != target) continue;
        for (std::size_t i = 0; i < table.position_mm.size(); ++i) {
          const double lever_m = (table.position_mm[i] - lines[index_of(axis)][index_of(row.lever)]) / 1000.0;
          table.compensation[i] -= row.sign * lever_m * laser::compensation_at(angle, table.position_mm[i]);
        }
      }
      added.push_back({target, to_text(effect)});
      compiled.carried.push_back(
          fmt::format("{} over {} itself: table {}", to_text(effect), letter_of(axis), name_of(target)));
      compiled.map.header.processing.push_back(
          fmt::format("{} includes {} over {} itself", name_of(target), to_text(effect), letter_of(axis)));
    }
  sort_tables(compiled.map);
  return added;
}

}  // namespace ecs::model
