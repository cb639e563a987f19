#include "model/fit/map_own_levers.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/terms.hpp"
#include "model/effects/definition.hpp"

namespace ecs::model {
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
    if (row.has_lever && row.uses_coordinate && std::find(measured->begin(), measured->end(), row) == measured->end())
      rows.push_back(row);
  return rows;
}

bool has_table(const laser::ErrorMap& map, Component component) {
  return std::any_of(map.tables.begin(), map.tables.end(),
                     [&](const MapTable& table) { return table.component == component; });
}

void sort_tables(laser::ErrorMap& map) {
  std::stable_sort(map.tables.begin(), map.tables.end(), [](const MapTable& a, const MapTable& b) {
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
          fmt::format("{} holds {} over {} itself", name_of(target), to_text(effect), letter_of(axis)));
    }
  sort_tables(compiled.map);
  return added;
}

}  // namespace ecs::model
