// Every component: its curves before and after, ISO 230-2 of both, how it was measured and what was taken away.
#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/report/sections.hpp"
#include "commissioning/measurements/fields.hpp"
#include "laser/map/recipe.hpp"

namespace ecs::app {
namespace {

struct Quantity {
  const char* symbol;
  std::optional<double> laser::Iso230::*value;
};
constexpr Quantity kQuantities[] = {{"A", &laser::Iso230::A},
                                    {"A↑", &laser::Iso230::A_forward},
                                    {"A↓", &laser::Iso230::A_reverse},
                                    {"E", &laser::Iso230::E},
                                    {"E↑", &laser::Iso230::E_forward},
                                    {"E↓", &laser::Iso230::E_reverse},
                                    {"M", &laser::Iso230::M},
                                    {"R", &laser::Iso230::R},
                                    {"R↑", &laser::Iso230::R_forward},
                                    {"R↓", &laser::Iso230::R_reverse},
                                    {"B", &laser::Iso230::B},
                                    {"B\u0304", &laser::Iso230::B_mean},
                                    {"±3s", &laser::Iso230::three_sigma_band},
                                    {"6s", &laser::Iso230::non_repeatability}};

std::vector<Markup> iso_cells(const MeasuredPhase& phase, std::string_view name, int decimals) {
  std::vector<Markup> cells{text(name), element("strong", cell(phase.readings.band, decimals))};
  for (const Quantity& q : kQuantities) cells.push_back(cell(phase.iso.*(q.value), decimals));
  return cells;
}

std::optional<double> ratio_of(const std::optional<double>& before, const std::optional<double>& after) {
  if (!before || !after || *after <= 0.0) return std::nullopt;
  return *before / *after;
}

std::vector<Markup> ratio_cells(const TableRow& row) {
  std::vector<Markup> cells{text("ratio"), cell(row.ratio(), 1)};
  for (const Quantity& q : kQuantities)
    cells.push_back(std::string_view(q.symbol) == "B\u0304"
                        ? text("")
                        : cell(ratio_of(row.before->iso.*(q.value), row.after->iso.*(q.value)), 1));
  return cells;
}

Markup iso_table(const TableRow& row) {
  std::vector<TableColumn> columns{{std::string(unit_text(laser::unit_of(row.planned.sense)))}, {"band", true}};
  for (const Quantity& q : kQuantities) columns.push_back({q.symbol, true});
  TableMarkup table(columns, "iso");
  const int decimals = decimals_of(row);
  if (row.before) table.row(iso_cells(*row.before, "before", decimals));
  if (row.after) table.row(iso_cells(*row.after, "after", decimals));
  if (row.before && row.after) table.row(ratio_cells(row));
  return table.markup();
}

std::string slope_of(const MeasuredPhase& phase) { return number_text(phase.readings.level.removed.slope_per_m, 1); }

/// "slope −22.4, after 0.3 µm/m removed by least squares"
std::string slope_text(const TableRow& row) {
  const auto method = row.planned.slope;
  if (method == laser::SlopeMethod::none) return "no slope removed";
  const std::string values = row.before && row.after
                                 ? fmt::format("{}, after {}", slope_of(*row.before), slope_of(*row.after))
                                 : slope_of(row.before ? *row.before : *row.after);
  return fmt::format("slope {} {} removed by {}", values, is_rotation(row.planned.sense) ? "µm/m per m" : "µm/m",
                     method == laser::SlopeMethod::end_points ? "end points" : "least squares");
}

std::string how_measured(const TableRow& row) {
  const MeasuredPhase& phase = row.before ? *row.before : *row.after;
  const auto lines = lines_in(phase.readings.before);
  std::vector<std::string> parts;
  if (!lines.empty()) {
    const LineSummary& line = lines.front();
    if (const std::string parked = parked_text(line.group); !parked.empty())
      parts.push_back(fmt::format("{} moves, {} mm", letter_of(row.planned.axis), worded(parked)));
    parts.push_back(fmt::format("{}, {}{}", counted(line.targets, "target", "targets"),
                                counted(line.runs, "run", "runs"), line.forward && line.reverse ? " both ways" : ""));
  }
  if (const auto instrument = laser::metadata_value(phase.readings.before, "instrument")) parts.push_back(*instrument);
  parts.push_back(slope_text(row));
  return fmt::format("{}", fmt::join(parts, " · "));
}

/// What the map did with this component, by the lines of its header.
std::vector<std::string> processing_of(const ReportContent& content, const TableRow& row) {
  std::vector<std::string> lines;
  if (!content.map) return lines;
  const std::string code(name_of(curve_of(row.planned.sense, row.planned.axis)));
  const std::string& name = row.planned.name;
  const std::string& wanted = component_of(name) ? name : code;
  if (wanted != name) return lines;
  for (const std::string& line : content.map->map.header.processing)
    if (line.starts_with(wanted + " ")) lines.push_back(worded(line.substr(wanted.size() + 1)));
  return lines;
}

Markup unmeasured(const ReportContent& content, const TableRow& row) {
  Markup out;
  for (const Problem& problem : row.problems)
    out += paragraph_of(without_commands(to_text(problem)), "class=\"problem\"");
  if (row.problems.empty() && !row.after)
    out += absence(content.has_after && content.planned ? "Measured before compensation only, as planned."
                                                        : "Measured before compensation only.");
  if (row.problems.empty() && !row.before) out += absence("Measured after compensation only.");
  return out;
}

Markup component(const ReportContent& content, const TableRow& row, const std::string& id) {
  const RowVerdict verdict = verdict_of(row);
  Markup body =
      element("h3", element("span", row.planned.name, "class=\"code\"") + text(" " + row.planned.title) +
                        element("span", word_for(verdict),
                                verdict == RowVerdict::above || verdict == RowVerdict::missing ? "class=\"badge open\""
                                                                                               : "class=\"badge\""));
  if (row.before || row.after) {
    body += paragraph_of(how_measured(row), "class=\"how\"");
    body += unmeasured(content, row);
    body += figure_of_row(row) + iso_table(row);
    if (const auto steps = processing_of(content, row); !steps.empty())
      body += paragraph_of(fmt::format("In the map: {}.", fmt::join(steps, "; ")), "class=\"how\"");
  } else {
    body += unmeasured(content, row);
  }
  return element("article", body, fmt::format("id=\"{}\"", id)) + Markup::literal("\n");
}

/// Conditions of the standard that are not met: each once, with the measurements.
Markup notes_of(const std::vector<TableRow>& rows) {
  std::vector<std::pair<std::string, std::vector<std::string>>> notes;
  for (const TableRow& row : rows)
    for (const auto* phase : {&row.before, &row.after}) {
      if (!*phase) continue;
      for (const std::string& note : (*phase)->iso.notes) {
        auto at = std::find_if(notes.begin(), notes.end(), [&](const auto& n) { return n.first == note; });
        if (at == notes.end()) at = notes.insert(notes.end(), {note, {}});
        if (std::find(at->second.begin(), at->second.end(), row.planned.name) == at->second.end())
          at->second.push_back(row.planned.name);
      }
    }
  if (notes.empty()) return {};
  std::vector<std::string> items;
  for (const auto& [note, names] : notes) items.push_back(fmt::format("{}: {}", note, fmt::join(names, ", ")));
  return element("article",
                 element("h3", "Where the conditions of ISO 230-2 are not met") + list_of(without_commands(items)));
}

}  // namespace

ReportSection components_section(const ReportContent& content, const std::vector<std::string>& ids) {
  Markup body = paragraph_of(
      "Grey bars: from the least to the greatest reading at each target. Before and after have the same scale. Symbols "
      "of ISO 230-2: A accuracy, E systematic deviation, M range of the mean, R repeatability, B reversal error and "
      "its mean; ↑ forward, ↓ reverse. ±3s: band of mean ± 3 standard deviations, 6s: largest 6 standard deviations "
      "(BS 4656 Part 16).",
      "class=\"small intro\"");
  for (std::size_t i = 0; i < content.rows.size(); ++i) body += component(content, content.rows[i], ids[i]);
  body += notes_of(content.rows);
  return {"components", "Components before and after", std::move(body)};
}

}  // namespace ecs::app
