#include "commissioning/maps/view.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "base/json.hpp"

namespace ecs::app {
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

std::string start_text(const laser::MapTable& table) {
  return table.position_mm.empty() ? "-" : fmt::format("{:.6g}", table.position_mm.front());
}

}  // namespace

std::string_view word_for(Approach approach) {
  if (approach == Approach::unknown) return "both";
  return approach == Approach::forward ? "forward" : "reverse";
}

std::string tables_text(const std::vector<laser::MapTable>& tables) {
  std::string text = fmt::format("{:<4} {:<8} {:>12} {:>14} {:>7} {:>11} {:>11} {}\n", "", "approach", "start [mm]",
                                 "increment [mm]", "points", "smallest", "largest", "unit");
  for (const laser::MapTable& table : tables) {
    const auto step = increment_mm(table);
    const Extremes e = extremes_of(table);
    text += fmt::format("{:<4} {:<8} {:>12} {:>14} {:>7} {:>11.2f} {:>11.2f} {}\n", name_of(table.component),
                        word_for(table.approach), start_text(table), step ? fmt::format("{:.6g}", *step) : "varies",
                        table.position_mm.size(), e.least, e.most, unit_of(table.component));
  }
  return text;
}

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

Json json_of(const laser::MapTable& table, bool with_values) {
  const Extremes e = extremes_of(table);
  Json object{{"component", name_of(table.component)},
              {"approach", word_for(table.approach)},
              {"unit", unit_of(table.component)},
              {"start_mm", table.position_mm.empty() ? Json(nullptr) : number_or_null(table.position_mm.front())},
              {"increment_mm", number_or_null(increment_mm(table))},
              {"points", table.position_mm.size()},
              {"min", number_or_null(e.least)},
              {"max", number_or_null(e.most)}};
  if (with_values) {
    object["position_mm"] = table.position_mm;
    object["compensation"] = table.compensation;
  }
  return object;
}

Json json_of(const laser::MapHeader& header) {
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

Json json_of(const std::vector<laser::MapFinding>& findings) {
  Json out = Json::array();
  for (const laser::MapFinding& f : findings) out.push_back({{"objection", f.objection}, {"message", f.message}});
  return out;
}

}  // namespace ecs::app
