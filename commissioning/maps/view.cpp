#include "commissioning/maps/view.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "base/answer_table.hpp"

namespace ecs::commissioning {
namespace {

constexpr double kSameIncrement_mm = 1e-6;

std::optional<double> increment_mm(const laser::MapTable& table) {
  const auto& p = table.position_mm;
  if (p.size() < 2) return std::nullopt;
  const double step_mm = (p.back() - p.front()) / static_cast<double>(p.size() - 1);
  for (std::size_t i = 1; i < p.size(); ++i)
    if (std::abs(p[i] - p[i - 1] - step_mm) > kSameIncrement_mm) return std::nullopt;
  return step_mm;
}

struct Extremes {
  double least = 0.0;
  double most = 0.0;
};
Extremes extremes_of(const laser::MapTable& table) {
  if (table.compensation.empty()) return {};
  const auto [least, most] = std::minmax_element(table.compensation.begin(), table.compensation.end());
  return {*least, *most};
}

Cell start_cell(const laser::MapTable& table) {
  if (table.position_mm.empty()) return {nullptr, "-"};
  return {number_or_null(table.position_mm.front()), fmt::format("{:.6g}", table.position_mm.front())};
}

Cell increment_cell(const laser::MapTable& table) {
  const auto step = increment_mm(table);
  return {number_or_null(step), step ? fmt::format("{:.6g}", *step) : "varies"};
}

const AnswerTable<laser::MapTable>& map_tables() {
  using Row = laser::MapTable;
  static const AnswerTable<Row> table(
      "{component:<4} {approach:<8} {start_mm:>12} {increment_mm:>14} {points:>7} {min:>11} {max:>11} {unit}",
      {{"component", "", [](const Row& t) { return word_cell(name_of(t.component)); }},
       {"approach", "approach", [](const Row& t) { return word_cell(word_for(t.approach)); }},
       {"unit", "unit", [](const Row& t) { return word_cell(unit_of(t.component)); }},
       {"start_mm", "start [mm]", start_cell},
       {"increment_mm", "increment [mm]", increment_cell},
       {"points", "points", [](const Row& t) { return count_cell(t.position_mm.size()); }},
       {"min", "smallest", [](const Row& t) { return number_cell(extremes_of(t).least, 2); }},
       {"max", "largest", [](const Row& t) { return number_cell(extremes_of(t).most, 2); }}});
  return table;
}

}  // namespace

std::string_view word_for(Approach approach) {
  if (approach == Approach::unknown) return "both";
  return approach == Approach::forward ? "forward" : "reverse";
}

std::string tables_text(const std::vector<laser::MapTable>& tables) { return map_tables().text(tables); }

std::string header_view(const laser::MapHeader& header) {
  const std::string text = laser::header_text(header);
  return text.empty() ? "no header\n" : text;
}

std::string findings_text(const std::vector<laser::MapFinding>& findings) {
  std::string text;
  for (const laser::MapFinding& finding : findings)
    text += fmt::format("{}: {}\n", finding.objection ? "objection" : "remark", finding.message);
  return text;
}

Json table_json(const laser::MapTable& table, bool with_values) {
  Json object = map_tables().object(table);
  if (with_values) {
    object["position_mm"] = table.position_mm;
    object["compensation"] = table.compensation;
  }
  return object;
}

Json header_json(const laser::MapHeader& header) {
  Json object{{"customer", text_or_null(header.customer)},
              {"machine", text_or_null(header.machine)},
              {"serial_number", text_or_null(header.serial_number)},
              {"date", text_or_null(header.date)},
              {"engineer", text_or_null(header.engineer)},
              {"configuration", text_or_null(header.configuration)},
              {"sources", Json::array()},
              {"declared_zero", Json::array()},
              {"processing", header.processing}};
  for (const laser::SourceFile& s : header.sources)
    object["sources"].push_back({{"component", s.component}, {"name", s.name}, {"sha256", s.sha256}});
  for (const laser::DeclaredZero& z : header.declared_zero)
    object["declared_zero"].push_back({{"component", name_of(z.component)}, {"reason", z.reason}});
  return object;
}

Json findings_json(const std::vector<laser::MapFinding>& findings) {
  Json out = Json::array();
  for (const laser::MapFinding& f : findings) out.push_back({{"objection", f.objection}, {"message", f.message}});
  return out;
}

}  // namespace ecs::commissioning
