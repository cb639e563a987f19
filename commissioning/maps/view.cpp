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

Cell table_cell(const laser::MapTable& table) {
  const auto& p = table.position_mm;
  const auto step_mm = increment_mm(table);
  const Extremes extremes = extremes_of(table);
  return record_cell(
      "{component:<4} {approach:<8} {start_mm:>12} {increment_mm:>14} {points:>7} {min:>11} {max:>11} {unit}\n",
      {{"component", word_cell(name_of(table.component))},
       {"approach", word_cell(word_for(table.approach))},
       {"unit", word_cell(unit_of(table.component))},
       {"start_mm", p.empty() ? null_cell("-") : Cell{number_or_null(p.front()), fmt::format("{:.6g}", p.front())}},
       {"increment_mm", {number_or_null(step_mm), step_mm ? fmt::format("{:.6g}", *step_mm) : "varies"}},
       {"points", count_cell(p.size())},
       {"min", number_cell(extremes.least, 2)},
       {"max", number_cell(extremes.most, 2)}});
}

}  // namespace

std::string_view word_for(Approach approach) {
  if (approach == Approach::unknown) return "both";
  return approach == Approach::forward ? "forward" : "reverse";
}

std::string tables_text(const std::vector<laser::MapTable>& tables) {
  std::string text = "     approach   start [mm] increment [mm]  points    smallest     largest unit\n";
  for (const laser::MapTable& table : tables) text += table_cell(table).text;
  return text;
}

std::string header_view(const laser::MapHeader& header) {
  const std::string text = laser::header_text(header);
  return text.empty() ? "no header\n" : text;
}

Json table_json(const laser::MapTable& table, bool with_values) {
  Json object = table_cell(table).json;
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

Cell findings_cell(const std::vector<laser::MapFinding>& findings) {
  return list_cell(findings, [](const laser::MapFinding& finding) {
    return record_cell("{objection}: {message}\n", {{"objection", yes_cell(finding.objection, "objection", "remark")},
                                                    {"message", word_cell(finding.message)}});
  });
}

std::vector<std::string> objections_in(const std::vector<laser::MapFinding>& findings) {
  std::vector<std::string> messages;
  for (const laser::MapFinding& finding : findings)
    if (finding.objection) messages.push_back(finding.message);
  return messages;
}

Cell squareness_cell(const std::vector<std::pair<Component, double>>& values, std::string_view begin) {
  Cell cell{Json::object(), {}};
  for (const auto& [component, um_per_m] : values) {
    const std::string key = fmt::format("{}_um_per_m", name_of(component));
    cell.json[key] = number_or_null(um_per_m);
    cell.text += fmt::format("{}compensation.squareness.{} = {:.4f}\n", begin, key, um_per_m);
  }
  return cell;
}

Cell squareness_cell(const std::vector<std::pair<Component, double>>& values, std::string_view origin,
                     const std::string& params_out) {
  Cell cell = squareness_cell(values, "  ");
  if (values.empty()) return cell;
  cell.text = (params_out.empty() ? fmt::format("squareness {}; without --params-out add these to the parameters by "
                                                "hand:\n",
                                                origin)
                                  : fmt::format("squareness {}, in {}:\n", origin, params_out)) +
              cell.text;
  return cell;
}

Cell written_cell(std::string_view what, const std::string& file, std::string_view otherwise) {
  if (file.empty()) return null_cell(otherwise);
  return {file, fmt::format("{} written to {}\n", what, file)};
}

}  // namespace ecs::commissioning
