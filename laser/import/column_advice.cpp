#include "laser/import/column_advice.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.hpp"
#include "laser/findings.hpp"
#include "laser/import/time.hpp"

namespace ecs::laser {
namespace {

constexpr std::size_t kLeastTargets = 3;
constexpr std::size_t kRowsATurn = 4;  ///< positions turn back less often than every so many rows
/// Errors [um] vary by less than this part of the travel [mm]: 300 um/m. Coordinates beside a position vary by more.
constexpr double kGreatestSlope_um_per_mm = 0.3;
/// Errors lie round the 0 of a readout; coordinates that hardly change lie far from it.
constexpr double kGreatestOffset = 3.0;
/// Actual positions are as close to their targets as this part of the travel.
constexpr double kClose = 0.001;
constexpr std::size_t kMostNamed = 12;

struct NumberColumn {
  std::size_t number = 0;  ///< from 1
  std::string heading;
  std::vector<double> values;
  [[nodiscard]] double least() const { return *std::min_element(values.begin(), values.end()); }
  [[nodiscard]] double most() const { return *std::max_element(values.begin(), values.end()); }
  [[nodiscard]] double span() const { return most() - least(); }
};

/// The rows that the suggested options would read.
struct Rows {
  int skip = 0;
  std::size_t count = 0;  ///< 0: all
};

Rows rows_of(const TableShape& shape) {
  return {(shape.is_mixed ? shape.stretch_line : shape.first_row_line) - 1, shape.is_mixed ? shape.stretch_rows : 0};
}

/// Columns whose every cell is a number.
std::vector<NumberColumn> number_columns(std::string_view text, const TableShape& shape) {
  std::vector<NumberColumn> columns;
  for (std::size_t i = 0; i < shape.is_number.size(); ++i)
    if (shape.is_number[i]) columns.push_back({i + 1, i < shape.headings.size() ? shape.headings[i] : "", {}});
  const Rows rows = rows_of(shape);
  const auto lines = lines_of(text);
  const auto last = std::min(lines.size(), static_cast<std::size_t>(shape.last_row_line));
  std::size_t taken = 0;
  for (auto i = static_cast<std::size_t>(rows.skip); i < last && (rows.count == 0 || taken < rows.count); ++i) {
    if (is_comment(lines[i])) continue;
    const auto cells = cells_of(lines[i], shape.delimiter);
    if (cells.size() != shape.columns) continue;
    ++taken;
    for (NumberColumn& column : columns)
      if (const auto number = number_or_comma(cells[column.number - 1])) column.values.push_back(*number);
  }
  std::erase_if(columns, [&](const NumberColumn& column) { return column.values.size() != taken || taken == 0; });
  return columns;
}

/// What a heading says that its column holds.
enum class Meaning { none, reading, position, angle, run, approach };

Meaning meaning_of(const std::string& heading) {
  const std::string words = lower(heading);
  const auto has = [&](std::initializer_list<std::string_view> any) {
    return std::any_of(any.begin(), any.end(),
                       [&](std::string_view word) { return words.find(word) != std::string::npos; });
  };
  if (has({"std", "standard", "sigma", "uncertainty"})) return Meaning::none;
  if (has({"error", "deviation", "reading", "abweichung"})) return Meaning::reading;
  if (has({"approach", "direction"})) return Meaning::approach;
  if (words == "run" || has({"run_", "run ", "cycle", "index", "count"})) return Meaning::run;
  if (has({"angle", "_deg", "[deg", "(deg"})) return Meaning::angle;
  if (has({"position", "target", "nominal"})) return Meaning::position;
  return Meaning::none;
}

/// 0, 1, 2, ... or 1, 2, 3, ...
bool counts_rows(const NumberColumn& column) {
  if (column.values.front() != 0.0 && column.values.front() != 1.0) return false;
  for (std::size_t i = 1; i < column.values.size(); ++i)
    if (column.values[i] != column.values[i - 1] + 1.0) return false;
  return true;
}

bool are_positions(const NumberColumn& column) {
  std::size_t moves = 0, turns = 0;
  double before = 0.0;
  for (std::size_t i = 1; i < column.values.size(); ++i) {
    const double step = column.values[i] - column.values[i - 1];
    if (step == 0.0) continue;
    if (step * before < 0.0) ++turns;
    ++moves;
    before = step;
  }
  return moves + 1 >= kLeastTargets && turns * kRowsATurn <= moves;
}

/// Whether the values are positions that were reached where `targets` were asked for.
bool are_actual(const NumberColumn& column, const NumberColumn& targets) {
  double largest = 0.0;
  for (std::size_t i = 0; i < column.values.size(); ++i)
    largest = std::max(largest, std::abs(column.values[i] - targets.values[i]));
  return largest > 0.0 && largest <= kClose * targets.span();
}

bool are_errors(const NumberColumn& column, const NumberColumn& targets) {
  const double largest = std::max(std::abs(column.least()), std::abs(column.most()));
  return column.span() > 0.0 && column.span() <= kGreatestSlope_um_per_mm * targets.span() &&
         largest <= kGreatestOffset * column.span();
}

std::optional<std::size_t> time_column(std::string_view text, const TableShape& shape) {
  const auto cells = cells_of(lines_of(text)[static_cast<std::size_t>(shape.first_row_line) - 1], shape.delimiter);
  for (std::size_t i = 0; i < cells.size(); ++i)
    if (seconds_in(cells[i])) return i + 1;
  return std::nullopt;
}

std::string row_options(const TableShape& shape) {
  const Rows rows = rows_of(shape);
  return (rows.skip > 0 ? fmt::format(" --skip {}", rows.skip) : "") +
         (rows.count > 0 ? fmt::format(" --rows {}", rows.count) : "");
}

bool could_be_targets(const NumberColumn& column, const std::vector<NumberColumn>& columns) {
  const Meaning meaning = meaning_of(column.heading);
  if (meaning == Meaning::reading || meaning == Meaning::run || meaning == Meaning::approach) return false;
  return are_positions(column) && (columns.size() < 3 || &column != &columns.front() || !counts_rows(column));
}

/// Whether the headings allow it: a column named so where there is one, no count of runs.
bool could_be_readings(const NumberColumn& column, const std::vector<NumberColumn>& columns) {
  const bool named = std::any_of(columns.begin(), columns.end(),
                                 [](const NumberColumn& one) { return meaning_of(one.heading) == Meaning::reading; });
  const Meaning meaning = meaning_of(column.heading);
  return named ? meaning == Meaning::reading
               : meaning != Meaning::run && meaning != Meaning::approach && !counts_rows(column);
}

/// ",approach=2,run=3" as headings name them, else the approach from the motion.
std::string pass_rules(const std::vector<NumberColumn>& columns) {
  std::string approach = ",approach=motion", run;
  for (const NumberColumn& column : columns) {
    const Meaning meaning = meaning_of(column.heading);
    if (meaning == Meaning::run && run.empty()) run = fmt::format(",run={}", column.number);
    const bool signs = std::all_of(column.values.begin(), column.values.end(),
                                   [](double value) { return value == 1.0 || value == -1.0 || value == 0.0; });
    if (meaning == Meaning::approach && signs) approach = fmt::format(",approach={}", column.number);
  }
  return approach + run;
}

std::string pair_text(const NumberColumn& targets, const NumberColumn& readings, bool actual,
                      std::optional<std::size_t> time, const TableShape& shape,
                      const std::vector<NumberColumn>& columns) {
  const bool turns = meaning_of(targets.heading) == Meaning::angle;
  const std::string_view unit = turns ? "deg" : "mm";
  return fmt::format(
      "--columns \"{}={}[{}],reading={}[{}]{}\"{}{} reads column {} as targets and column {} as {}, if that is what "
      "they are",
      turns ? "c_deg" : "x_mm", targets.number, unit, readings.number,
      actual  ? unit
      : turns ? "um/m"
              : "um",
      time ? fmt::format(",date_time={}", *time) : pass_rules(columns), actual ? " --values actual" : "",
      row_options(shape), targets.number, readings.number, actual ? "the positions reached" : "errors");
}

/// The options for the first pair of columns that look like it, targets and positions reached before errors.
std::optional<std::string> pair_advice(const std::vector<NumberColumn>& columns, std::optional<std::size_t> time,
                                       const TableShape& shape) {
  for (const bool actual : {true, false})
    for (const NumberColumn& targets : columns) {
      if (!could_be_targets(targets, columns)) continue;
      for (const NumberColumn& readings : columns)
        if (&readings != &targets && could_be_readings(readings, columns) &&
            (actual ? are_actual(readings, targets)
                    : meaning_of(readings.heading) == Meaning::reading || are_errors(readings, targets)))
          return pair_text(targets, readings, actual, time, shape, columns);
    }
  return std::nullopt;
}

/// One column of readings at one place, over time.
std::optional<std::string> growth_advice(const std::vector<NumberColumn>& columns, std::optional<std::size_t> time,
                                         const TableShape& shape) {
  if (columns.size() != 1 || columns.front().span() == 0.0) return std::nullopt;
  const std::size_t number = columns.front().number;
  return fmt::format(
      "--columns \"reading={}[um]{}\"{} --axis X{} reads column {} as errors at one place, if that is what "
      "they are",
      number, time ? fmt::format(",date_time={}", *time) : "", row_options(shape), time ? "" : " --parked x=0", number);
}

std::string columns_named(const std::vector<NumberColumn>& columns) {
  std::vector<std::string> named;
  for (std::size_t i = 0; i < std::min(kMostNamed, columns.size()); ++i)
    named.push_back(fmt::format("{}{} ({:.6g} to {:.6g})", columns[i].number,
                                columns[i].heading.empty() ? "" : " " + in_quotes(columns[i].heading),
                                columns[i].least(), columns[i].most()));
  return fmt::format("{}{}", fmt::join(named, ", "), columns.size() > kMostNamed ? ", ..." : "");
}

}  // namespace

std::string column_advice(std::string_view text, const TableShape& shape, bool known) {
  const auto columns = number_columns(text, shape);
  if (!known) {
    const auto time = time_column(text, shape);
    if (const auto advice = pair_advice(columns, time, shape)) return *advice;
    if (const auto advice = growth_advice(columns, time, shape)) return *advice;
  }
  if (columns.empty()) return "expected columns with a number in every row, found none: fill the empty cells";
  return fmt::format(
      "expected targets and errors beside them, found the columns {}; if two of them are targets and errors, say "
      "which: x_mm=N[mm],reading=M[um] with their numbers after "
      "--columns{}, and --values actual where M holds positions",
      columns_named(columns), row_options(shape));
}

}  // namespace ecs::laser
