// The map of a fitted model as text and JSON.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/json.hpp"
#include "base/paragraph.hpp"
#include "base/text.hpp"
#include "commissioning/maps/findings.hpp"
#include "commissioning/maps/from_model.hpp"
#include "commissioning/maps/view.hpp"

namespace ecs::commissioning {
namespace {

std::size_t points_in(const std::vector<laser::MapTable>& tables, Component component) {
  for (const laser::MapTable& table : tables)
    if (table.component == component) return table.position_mm.size();
  return 0;
}

std::string components_text(const MapFromModel& b) {
  std::string text = fmt::format("{:<4} {:<38} {:<4} {:>8} {:>6}\n", "", "component", "unit", "most", "n");
  for (const auto& [component, effects] : b.effects) {
    if (is_squareness(component)) continue;
    text += fmt::format("{:<4} {:<38} {:<4} {:>8.2f} {:>6}\n", name_of(component), laser::description_of(component),
                        unit_of(component), largest_in(b.compiled.map.tables, component),
                        points_in(b.compiled.map.tables, component));
    text += paragraph(fmt::format("from {}", fmt::join(effects, " + ")), 5, 10);
  }
  return text + fmt::format("most: largest compensation; n: points per table, every {} mm\n", shortest(b.increment_mm));
}

std::string squareness_text(const MapFromModel& b, const FromModelArguments& arguments) {
  std::string text;
  for (const auto& each : b.effects)
    if (is_squareness(each.first))
      text += fmt::format("  compensation.squareness.{}_um_per_m = {:.4f}\n", name_of(each.first),
                          b.compiled.squareness[index_of(each.first)]);
  if (text.empty()) return text;
  if (!arguments.params_out.empty())
    return fmt::format("squareness of the model, in {}:\n{}", arguments.params_out, text);
  return "squareness of the model; without --params-out add these to the parameters by hand:\n" + text;
}

}  // namespace

std::string from_model_text(const MapFromModel& b, const FromModelArguments& arguments) {
  std::string text = components_text(b) + squareness_text(b, arguments);
  for (const std::string& one : b.compiled.not_carried) text += paragraph("NOT CARRIED: " + one, 0, 13);
  for (const laser::DeclaredZero& zero : b.compiled.map.header.declared_zero)
    text += paragraph(fmt::format("{} declared zero: {}", name_of(zero.component), zero.reason), 0, 5);
  for (const std::string& note : b.notes) text += paragraph("note: " + note, 0, 6);
  text += findings_text(b.findings) + verdict_text(b.findings);
  text += arguments.output.empty() ? "nothing written: give -o map.csv to keep it\n"
                                   : fmt::format("map written to {}\n", arguments.output);
  if (!arguments.params_out.empty()) text += fmt::format("parameters written to {}\n", arguments.params_out);
  return text;
}

Json from_model_json(const MapFromModel& b, const FromModelArguments& arguments) {
  Json components = Json::array(), squareness = Json::object(), missing = Json::array();
  for (const auto& [component, effects] : b.effects) {
    if (is_squareness(component)) {
      squareness[fmt::format("{}_um_per_m", name_of(component))] =
          number_or_null(b.compiled.squareness[index_of(component)]);
      continue;
    }
    components.push_back({{"component", name_of(component)},
                          {"description", laser::description_of(component)},
                          {"unit", unit_of(component)},
                          {"effects", effects},
                          {"largest", number_or_null(largest_in(b.compiled.map.tables, component))},
                          {"points", points_in(b.compiled.map.tables, component)}});
  }
  for (const laser::MapFinding& finding : b.findings)
    if (finding.objection) missing.push_back(finding.message);
  return {{"map", text_or_null(arguments.output)},
          {"params_out", text_or_null(arguments.params_out)},
          {"model", arguments.model},
          {"increment_mm", number_or_null(b.increment_mm)},
          {"complete", b.complete()},
          {"carried", b.compiled.carried},
          {"not_carried", b.compiled.not_carried},
          {"components", std::move(components)},
          {"squareness", std::move(squareness)},
          {"missing", std::move(missing)},
          {"findings", findings_json(b.findings)},
          {"notes", b.notes},
          {"header", header_json(b.compiled.map.header)}};
}

}  // namespace ecs::commissioning
