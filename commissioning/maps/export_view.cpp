#include "commissioning/maps/export_view.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "base/json.hpp"
#include "base/paragraph.hpp"

namespace ecs::commissioning {
namespace {

constexpr std::array<std::string_view, kAxes + 1> kDirections{"X", "Y", "Z", "length"};

std::string tables_text(const ExportReport& report) {
  std::string text = fmt::format("{:<4} {:<37} {:>6} {:>6} {:>8} {:>8}  {}\n", "", "table", "points", "of", "largest",
                                 "off unit", "unit");
  for (const controllers::ExportedTable& table : report.made.tables) {
    text += fmt::format("{:<4} {:<37} {:>6} {:>6} {:>8.2f} {:>8.2f}  {}\n", table.component, table.what, table.points,
                        table.map_points == 0 ? std::string("-") : std::to_string(table.map_points), table.largest,
                        table.deviation, table.unit);
    if (std::abs(table.shift) >= 0.005)
      text += fmt::format("     shifted by {:.2f} {} to be zero at the reference position\n", table.shift, table.unit);
  }
  return text + "of: points in the map; off unit: largest difference from what our unit does\n";
}

std::string cell(const controllers::ResidualSize& size, std::size_t direction) {
  return fmt::format("{:>7.1f} /{:>7.1f}", size.largest_um[direction], size.rms_um[direction]);
}

std::string residual_text(const ExportReport& report) {
  std::string text = fmt::format("what is left, predicted from {}: largest / rms, um\n", report.work.errors_from);
  text += fmt::format("{:<10} {:<6}  {:>16}  {:>16}  {:>16}\n", "", "along", "not compensated", "whole map, unit",
                      "this export");
  for (const controllers::ResidualRow& row : report.residuals) {
    std::string where = row.where;
    for (std::size_t d = 0; d <= kAxes; ++d) {
      if (d < kAxes && !report.work.source.parameters.axis_present[d]) continue;
      text += fmt::format("{:<10} {:<6}  {:>16}  {:>16}  {:>16}\n", where, kDirections[d], cell(row.before, d),
                          cell(row.unit, d), cell(row.control, d));
      where.clear();
    }
  }
  text += "both approaches; counted from the reference point, as a work offset is\n";
  if (report.work.errors_from == "the map")
    text += paragraph(
        "From the map itself: what the map does not hold counts as zero, and what repeats badly is not in it. --model "
        "predicts from an error model.");
  return text;
}

std::string list_text(std::string_view heading, const std::vector<std::string>& lines) {
  if (lines.empty()) return {};
  std::string text = fmt::format("{}\n", heading);
  for (const std::string& line : lines) text += paragraph(line, 2, 4);
  return text;
}

/// A paragraph for each reason, in the order in which the reasons come up.
std::string left_behind_text(const std::vector<controllers::LeftBehind>& all) {
  std::vector<std::pair<std::string, std::string>> reasons;
  for (const controllers::LeftBehind& one : all) {
    auto at = std::find_if(reasons.begin(), reasons.end(), [&](const auto& r) { return r.first == one.why; });
    if (at == reasons.end()) at = reasons.insert(reasons.end(), {one.why, ""});
    at->second += fmt::format("{}{} {:.1f} {}", at->second.empty() ? "" : ", ", one.what, one.largest, one.unit);
  }
  if (reasons.empty()) return "no component of the map is left out\n";
  std::string text = "NOT CARRIED (largest values)\n";
  for (const auto& [why, what] : reasons) text += paragraph(fmt::format("{}: {}", why, what), 2, 4);
  return text;
}

Json left_behind_json(const controllers::LeftBehind& one) {
  return {{"what", one.what}, {"largest", number_or_null(one.largest)}, {"unit", one.unit}, {"why", one.why}};
}

Json residual_json(const controllers::ResidualSize& size, const PerAxis<bool>& present) {
  Json object = Json::object();
  for (std::size_t d = 0; d <= kAxes; ++d) {
    if (d < kAxes && !present[d]) continue;
    object[std::string(kDirections[d])] = {{"largest_um", number_or_null(size.largest_um[d])},
                                           {"rms_um", number_or_null(size.rms_um[d])}};
  }
  return object;
}

}  // namespace

std::string export_text(const ExportReport& report) {
  std::string text = fmt::format("{} from {}\n\n", report.control, report.work.map_name) + tables_text(report) + "\n";
  text += left_behind_text(report.made.not_carried);
  text += "\n" + residual_text(report) + "\n";
  text += list_text("to set in the control:", report.made.settings);
  for (const auto* notes : {&report.made.notes, &report.work.notes})
    for (const std::string& note : *notes) text += paragraph("note: " + note, 0, 6);
  text += to_text(report.written);
  if (report.written.empty()) text += fmt::format("nothing written: give {} to keep it\n", report.output_hint);
  return text;
}

Json json_of(const ExportReport& report) {
  Json tables = Json::array(), rows = Json::array(), files = Json::array(), left = Json::array();
  Json written = Json::array(), replaced = Json::array();
  for (const WrittenFile& file : report.written) {
    written.push_back(file.path);
    if (file.replaced) replaced.push_back(file.path);
  }
  for (const controllers::LeftBehind& one : report.made.not_carried) left.push_back(left_behind_json(one));
  const PerAxis<bool>& present = report.work.source.parameters.axis_present;
  for (const controllers::ExportedTable& table : report.made.tables)
    tables.push_back({{"component", table.component},
                      {"table", table.what},
                      {"points", table.points},
                      {"map_points", table.map_points},
                      {"largest", number_or_null(table.largest)},
                      {"deviation_from_unit", number_or_null(table.deviation)},
                      {"shift", number_or_null(table.shift)},
                      {"unit", table.unit}});
  for (const controllers::ResidualRow& row : report.residuals)
    rows.push_back({{"where", row.where},
                    {"places", row.places},
                    {"not_compensated", residual_json(row.before, present)},
                    {"whole_map", residual_json(row.unit, present)},
                    {"this_export", residual_json(row.control, present)}});
  for (const controllers::ExportFile& file : report.made.files)
    files.push_back({{"name", file.name}, {"bytes", file.content.size()}});
  std::vector<std::string> notes = report.made.notes;
  notes.insert(notes.end(), report.work.notes.begin(), report.work.notes.end());
  return {{"control", report.control},
          {"map", report.work.map_name},
          {"files", std::move(files)},
          {"written", std::move(written)},
          {"replaced", std::move(replaced)},
          {"tables", std::move(tables)},
          {"not_carried", std::move(left)},
          {"settings", report.made.settings},
          {"residual", {{"from", report.work.errors_from}, {"rows", std::move(rows)}}},
          {"notes", std::move(notes)}};
}

}  // namespace ecs::commissioning
