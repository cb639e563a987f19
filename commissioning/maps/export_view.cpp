#include "commissioning/maps/export_view.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "base/answer_table.hpp"
#include "base/paragraph.hpp"

namespace ecs::commissioning {
namespace {

constexpr std::array<std::string_view, kAxes + 1> kDirections{"X", "Y", "Z", "length"};
constexpr double kShiftShown = 0.005;  ///< smaller ones would be shown as 0.00

Cell table_cell(const controllers::ExportedTable& t) {
  const bool shifted = std::abs(t.shift) >= kShiftShown;
  return record_cell(
      "{component:<4} {table:<37} {points:>6} {map_points:>6} {largest:>8} {deviation_from_unit:>8}  {unit}\n{shift}",
      {{"component", word_cell(t.component)},
       {"table", word_cell(t.what)},
       {"points", count_cell(t.points)},
       {"map_points", {t.map_points, t.map_points == 0 ? "-" : std::to_string(t.map_points)}},
       {"largest", number_cell(t.largest, 2)},
       {"deviation_from_unit", number_cell(t.deviation, 2)},
       {"shift",
        {number_or_null(t.shift),
         shifted ? fmt::format("     shifted by {:.2f} {} to be zero at the reference position\n", t.shift, t.unit)
                 : ""}},
       {"unit", word_cell(t.unit)}});
}

Cell tables_cell(const std::vector<controllers::ExportedTable>& tables) {
  Cell list = list_cell(tables, table_cell,
                        fmt::format("{:<4} {:<37} {:>6} {:>6} {:>8} {:>8}  {}\n", "", "table", "points", "of",
                                    "largest", "off unit", "unit"));
  list.text += "of: points in the map; off unit: largest difference from what our unit does\n";
  return list;
}

/// In the text a paragraph for each reason, in the order in which the reasons come up.
Cell not_carried_cell(const std::vector<controllers::LeftBehind>& all) {
  Cell list = list_cell(all, [](const controllers::LeftBehind& one) {
    return record_cell({}, {{"what", word_cell(one.what)},
                            {"largest", number_cell(one.largest, 1)},
                            {"unit", word_cell(one.unit)},
                            {"why", word_cell(one.why)}});
  });
  std::vector<std::pair<std::string, std::string>> reasons;
  for (const controllers::LeftBehind& one : all) {
    auto at = std::find_if(reasons.begin(), reasons.end(), [&](const auto& r) { return r.first == one.why; });
    if (at == reasons.end()) at = reasons.insert(reasons.end(), {one.why, ""});
    at->second += fmt::format("{}{} {:.1f} {}", at->second.empty() ? "" : ", ", one.what, one.largest, one.unit);
  }
  list.text = reasons.empty() ? "no component of the map is left out\n" : "NOT CARRIED (largest values)\n";
  for (const auto& [why, what] : reasons) list.text += paragraph(fmt::format("{}: {}", why, what), 2, 4);
  return list;
}

Cell size_cell(const controllers::ResidualSize& size, std::size_t direction) {
  return record_cell("{largest_um:>7} /{rms_um:>7}", {{"largest_um", number_cell(size.largest_um[direction], 1)},
                                                      {"rms_um", number_cell(size.rms_um[direction], 1)}});
}

/// By direction in JSON, a line for each direction in the text.
Cell residual_row_cell(const controllers::ResidualRow& row, const PerAxis<bool>& present) {
  Json before = Json::object(), unit = Json::object(), control = Json::object();
  std::string text, where = row.where;
  for (std::size_t d = 0; d <= kAxes; ++d) {
    if (d < kAxes && !present[d]) continue;
    const std::string direction(kDirections[d]);
    const Cell of_none = size_cell(row.before, d), of_map = size_cell(row.unit, d),
               of_export = size_cell(row.control, d);
    before[direction] = of_none.json;
    unit[direction] = of_map.json;
    control[direction] = of_export.json;
    text += fmt::format("{:<10} {:<6}  {:>16}  {:>16}  {:>16}\n", where, direction, of_none.text, of_map.text,
                        of_export.text);
    where.clear();
  }
  return {object_of({{"where", word_cell(row.where)},
                     {"places", {row.places, {}}},
                     {"not_compensated", {before, {}}},
                     {"whole_map", {unit, {}}},
                     {"this_export", {control, {}}}}),
          text};
}

Cell residual_cell(const ExportReport& report) {
  const PerAxis<bool>& present = report.work.source.parameters.axis_present;
  const Cell rows = list_cell(
      report.residuals, [&](const controllers::ResidualRow& row) { return residual_row_cell(row, present); },
      fmt::format("{:<10} {:<6}  {:>16}  {:>16}  {:>16}\n", "", "along", "not compensated", "whole map, unit",
                  "this export"));
  Cell cell = record_cell(
      "what is left, predicted from {from}: largest / rms, um\n{rows}both approaches; counted from the reference "
      "point, "
      "as a work offset is\n",
      {{"from", word_cell(report.work.errors_from)}, {"rows", rows}});
  if (report.work.errors_from == "the map")
    cell.text += paragraph(
        "From the map itself: what the map does not hold counts as zero, and what repeats badly is not in it. --model "
        "predicts from an error model.");
  return cell;
}

Cell settings_cell(const std::vector<std::string>& settings) {
  Cell cell{settings, settings.empty() ? "" : "to set in the control:\n"};
  for (const std::string& line : settings) cell.text += paragraph(line, 2, 4);
  return cell;
}

}  // namespace

Cell written_files_cell(const std::vector<WrittenFile>& files) {
  return list_cell(files, [](const WrittenFile& file) {
    return Cell{file.path, fmt::format("{}: {}\n", file.replaced ? "replaced" : "written", file.path)};
  });
}

Cell replaced_files_cell(const std::vector<WrittenFile>& files) {
  Cell cell{Json::array(), {}};
  for (const WrittenFile& file : files)
    if (file.replaced) cell.json.push_back(file.path);
  return cell;
}

Cell export_cell(const ExportReport& report) {
  std::vector<std::string> notes = report.made.notes;
  notes.insert(notes.end(), report.work.notes.begin(), report.work.notes.end());
  Cell written = written_files_cell(report.written);
  if (report.written.empty()) written.text = fmt::format("nothing written: give {} to keep it\n", report.output_hint);
  return record_cell(
      "{control} from {map}\n\n{tables}\n{not_carried}\n{residual}\n{settings}{notes}{written}",
      {{"control", word_cell(report.control)},
       {"map", word_cell(report.work.map_name)},
       {"files",
        list_cell(
            report.made.files,
            [](const controllers::ExportFile& file) {
              return record_cell({}, {{"name", word_cell(file.name)}, {"bytes", count_cell(file.content.size())}});
            })},
       {"written", written},
       {"replaced", replaced_files_cell(report.written)},
       {"tables", tables_cell(report.made.tables)},
       {"not_carried", not_carried_cell(report.made.not_carried)},
       {"settings", settings_cell(report.made.settings)},
       {"residual", residual_cell(report)},
       {"notes", paragraphs_cell(notes, "note: ")}});
}

}  // namespace ecs::commissioning
