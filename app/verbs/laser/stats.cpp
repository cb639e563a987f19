// `ecs laser stats`: accuracy and repeatability by ISO 230-2 of every measurement line in the files.

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/verbs/laser/import_arguments.hpp"
#include "base/answer_table.hpp"
#include "commissioning/measurements/fields.hpp"
#include "commissioning/measurements/quantities.hpp"
#include "laser/analysis/iso230.hpp"

namespace ecs::app {
namespace {

struct StatsArguments : VerbArguments {
  const std::vector<std::string>& files = texts("FILE", "measurement files", Need::required);
  ImportOptions import{*this};
};

Json target_json(const laser::Iso230Target& t) {
  return {{"position_mm", number_or_null(t.position_mm)},
          {"n_forward", t.n_forward},
          {"n_reverse", t.n_reverse},
          {"mean_forward", number_or_null(t.mean_forward)},
          {"mean_reverse", number_or_null(t.mean_reverse)},
          {"mean", number_or_null(t.mean)},
          {"s_forward", number_or_null(t.s_forward)},
          {"s_reverse", number_or_null(t.s_reverse)},
          {"s_undirected", number_or_null(t.s_undirected)},
          {"B", number_or_null(t.B)},
          {"R_forward", number_or_null(t.R_forward)},
          {"R_reverse", number_or_null(t.R_reverse)},
          {"R", number_or_null(t.R)}};
}

Cell quantity_cell(std::string_view symbol, const std::optional<double>& value, std::string_view unit,
                   std::string_view name) {
  return {number_or_null(value),
          fmt::format("  {:<8} {:>12} {:<5} {}\n", symbol, number_cell(value, 3).text, unit, name)};
}

Cell iso230_cell(const laser::Iso230& iso, const std::string& file) {
  const auto unit = laser::unit_of(iso.sense);
  std::string layout =
      "{file}: {component} ({sense} along {axis}), parked at {parked_mm} mm, {count} targets, compensated: "
      "{compensated}\n";
  AnswerFields fields{{"file", word_cell(file)}};
  append(fields, measured_line_fields({iso.axis, iso.sense, iso.parked_mm, iso.compensated, {}}));
  for (const LaserQuantity& q : kLaserQuantities) {
    fields.push_back({q.key, quantity_cell(q.symbol, iso.*q.value, unit, q.name)});
    layout += fmt::format("{{{}}}", q.key);
  }
  append(fields, {{"range", quantity_cell("range", iso.range, unit, "largest minus smallest reading")},
                  {"merge_tolerance_mm", {number_or_null(iso.merge_tolerance_mm), {}}},
                  {"targets", list_cell(iso.targets,
                                        [](const auto& target) {
                                          return Cell{target_json(target), {}};
                                        })},
                  {"count", shown_cell(fmt::format("{}", iso.targets.size()))},
                  {"notes", lines_cell(iso.notes, "  note: ")}});
  return record_cell(layout + "{range}{notes}", fields);
}

Result<Outcome> stats(VerbContext& context, const StatsArguments& arguments) {
  Cell lines{Json::array(), {}};
  for (const std::string& file : arguments.files) {
    const auto imported = read_with_notes(context, file, arguments.import);
    if (!imported) return tl::unexpected(imported.error());
    if (imported->set.readings.empty())
      return tl::unexpected(Problem{ProblemKind::bad_input, "expected readings, found none", file, 0, 0, {}});
    const auto all = laser::iso230_of(imported->set);
    if (!all) return tl::unexpected(all.error());
    for (const laser::Iso230& iso : *all) {
      if (!lines.text.empty()) lines.text += "\n";
      lines.add(iso230_cell(iso, file));
    }
  }
  return outcome_of(record_cell("{lines}", {{"lines", lines}}));
}

}  // namespace

extern const VerbDefinition kLaserStats = verb<StatsArguments>(
    "laser stats", "accuracy and repeatability by ISO 230-2, the 3-sigma band, the conditions not met",
    "ecs laser stats x_axis.csv y_axis.rtl --json", stats);

}  // namespace ecs::app
