#include "app/verbs/laser/stats_summary.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>
#include <tuple>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "commissioning/measurements/summary.hpp"

namespace ecs::app {
namespace {

/// Rows of the table of the worst lines, all components together; at least one each.
constexpr std::size_t kWorstLines = 20;
constexpr std::size_t kMostNotes = 8;

using Lines = std::vector<const LineStatistics*>;

std::string value_text(const std::optional<double>& value) { return value ? fmt::format("{:.3f}", *value) : "-"; }

std::string component_text(const LineStatistics& line) {
  return laser::curve_name(line.iso.sense, line.iso.axis, line.iso.rotary);
}

auto badness(const LineStatistics& line) {
  return std::tuple(line.iso.A.value_or(-1.0), line.iso.range, std::abs(line.largest));
}

/// In the order of their first line.
std::vector<Lines> by_component(const std::vector<LineStatistics>& lines) {
  std::vector<Lines> components;
  for (const LineStatistics& line : lines) {
    const auto same = std::find_if(components.begin(), components.end(), [&](const Lines& of) {
      return component_text(*of.front()) == component_text(line);
    });
    (same == components.end() ? components.emplace_back() : *same).push_back(&line);
  }
  return components;
}

std::string component_row(const Lines& of) {
  std::size_t readings = 0, outliers = 0, drifting = 0;
  double largest = 0.0, range = 0.0;
  std::optional<double> accuracy;
  for (const LineStatistics* line : of) {
    readings += line->group.readings.size();
    outliers += line->outliers;
    drifting += line->drifts ? 1 : 0;
    if (std::abs(line->largest) > std::abs(largest)) largest = line->largest;
    range = std::max(range, line->iso.range);
    if (line->iso.A) accuracy = std::max(accuracy.value_or(0.0), *line->iso.A);
  }
  return fmt::format("{:<5} {:>6} {:>9} {:>11.3f} {:>10.3f} {:>9} {:>9} {:>9}  {}\n", component_text(*of.front()),
                     of.size(), readings, largest, range, value_text(accuracy), outliers, drifting,
                     laser::unit_of(of.front()->iso.sense));
}

std::string line_row(const LineStatistics& line, bool with_file) {
  std::string text =
      fmt::format("{:<5} {:<22} {:>3} {:>9.3f} {:>9.3f} {:>8} {:>8} {:>8}", component_text(line),
                  commissioning::parked_text(line.group), line.iso.targets.size(), line.largest, line.iso.range,
                  value_text(line.iso.A), value_text(line.iso.R), value_text(line.iso.B));
  if (with_file) text += fmt::format("  {}", fmt::join(line.files, " + "));
  return text + "\n";
}

std::string worst_rows(std::vector<Lines> components) {
  const std::size_t most = std::max<std::size_t>(1, kWorstLines / components.size());
  std::string rows;
  for (Lines& of : components) {
    const bool one_file =
        std::all_of(of.begin(), of.end(), [&](const auto* line) { return line->files == of.front()->files; });
    std::stable_sort(of.begin(), of.end(), [](const auto* a, const auto* b) { return badness(*a) > badness(*b); });
    for (std::size_t i = 0; i < std::min(most, of.size()); ++i) rows += line_row(*of[i], !one_file);
  }
  return rows;
}

std::string note_rows(const std::vector<LineStatistics>& lines) {
  std::map<std::string, std::size_t> counts;
  for (const LineStatistics& line : lines)
    for (const std::string& note : line.iso.notes) ++counts[note];
  std::vector<std::pair<std::string, std::size_t>> notes(counts.begin(), counts.end());
  std::stable_sort(notes.begin(), notes.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  std::string text;
  for (std::size_t i = 0; i < std::min(kMostNotes, notes.size()); ++i)
    text += fmt::format("note on {} of {} lines: {}\n", notes[i].second, lines.size(), notes[i].first);
  if (notes.size() > kMostNotes) text += fmt::format("and {} more kinds of notes\n", notes.size() - kMostNotes);
  return text;
}

}  // namespace

std::string summary_text(const std::vector<LineStatistics>& lines) {
  const auto components = by_component(lines);
  std::string text = fmt::format("{:<5} {:>6} {:>9} {:>11} {:>10} {:>9} {:>9} {:>9}\n", "", "lines", "readings",
                                 "largest", "max range", "max A", "outliers", "drifting");
  for (const Lines& of : components) text += component_row(of);
  text += fmt::format("\nthe worst:\n{:<5} {:<22} {:>3} {:>9} {:>9} {:>8} {:>8} {:>8}\n", "", "parked [mm]", "n",
                      "largest", "range", "A", "R", "B");
  text += worst_rows(components);
  text += "\n" + note_rows(lines);
  return text + fmt::format(
                    "{} measurement lines: --all shows each with all its quantities, --json gives them to "
                    "programs\n",
                    lines.size());
}

}  // namespace ecs::app
