// The map of a fitted model as text and JSON.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/answer_table.hpp"
#include "base/paragraph.hpp"
#include "base/text.hpp"
#include "commissioning/maps/findings.hpp"
#include "commissioning/maps/from_model.hpp"
#include "commissioning/maps/view.hpp"
#include "commissioning/unit/map_checks.hpp"

namespace ecs::commissioning {
namespace {

std::size_t points_in(const std::vector<laser::MapTable>& tables, Component component) {
  for (const laser::MapTable& table : tables)
    if (table.component == component) return table.position_mm.size();
  return 0;
}

Cell component_cell(const MapFromModel& b, Component component, const std::vector<std::string>& effects) {
  return record_cell("{component:<4} {description:<38} {unit:<4} {largest:>8} {points:>6}\n{effects}",
                     {{"component", word_cell(name_of(component))},
                      {"description", word_cell(laser::description_of(component))},
                      {"unit", word_cell(unit_of(component))},
                      {"effects", {effects, paragraph(fmt::format("from {}", fmt::join(effects, " + ")), 5, 10)}},
                      {"largest", number_cell(largest_in(b.compiled.map.tables, component), 2)},
                      {"points", count_cell(points_in(b.compiled.map.tables, component))}});
}

Cell components_cell(const MapFromModel& b) {
  Cell list{Json::array(), fmt::format("{:<4} {:<38} {:<4} {:>8} {:>6}\n", "", "component", "unit", "most", "n")};
  for (const auto& [component, effects] : b.effects)
    if (!is_squareness(component)) list.add(component_cell(b, component, effects));
  return list;
}

Cell squareness_of(const MapFromModel& b, const FromModelArguments& arguments) {
  std::vector<std::pair<Component, double>> values;
  for (const auto& each : b.effects)
    if (is_squareness(each.first)) values.emplace_back(each.first, b.compiled.squareness[index_of(each.first)]);
  return squareness_cell(values, "of the model", arguments.params_out);
}

std::string declared_text(const MapFromModel& b) {
  std::string text;
  for (const laser::DeclaredZero& zero : b.compiled.map.header.declared_zero)
    text += paragraph(fmt::format("{} declared zero: {}", name_of(zero.component), zero.reason), 0, 5);
  return text;
}

}  // namespace

Cell from_model_cell(const MapFromModel& b, const FromModelArguments& arguments) {
  return record_cell(
      "{components}most: largest compensation; n: points per table, every {increment_mm} mm\n{squareness}{not_carried}"
      "{declared}{notes}{findings}{verdict}{map}{params_out}",
      {{"map", written_cell("map", arguments.output, "nothing written: give -o map.csv to keep it\n")},
       {"params_out", written_cell("parameters", arguments.params_out)},
       {"model", word_cell(arguments.model)},
       {"increment_mm", {number_or_null(b.increment_mm), shortest(b.increment_mm)}},
       {"complete", yes_cell(b.complete(), "", "")},
       {"carried", lines_cell(b.compiled.carried, "")},
       {"not_carried", paragraphs_cell(b.compiled.not_carried, "NOT CARRIED: ")},
       {"components", components_cell(b)},
       {"squareness", squareness_of(b, arguments)},
       {"declared", shown_cell(declared_text(b))},
       {"missing", lines_cell(objections_in(b.findings), "")},
       {"findings", findings_cell(b.findings)},
       {"verdict",
        shown_cell(verdict_text(b.findings, !made_for_two_machines(b.compiled.map.header, b.identity).empty()))},
       {"notes", paragraphs_cell(b.notes, "note: ")},
       {"header", header_cell(b.compiled.map.header)}});
}

}  // namespace ecs::commissioning
