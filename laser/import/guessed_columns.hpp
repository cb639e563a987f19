// The columns of a table that nobody has described: what its headings and values say that they hold. Internal to the
// explanation of a file that is not read. Does not live here: what is said of them (explain.cpp), how the table looks
// (columns.hpp).
#pragma once

#include <algorithm>
#include <cstddef>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "laser/import/columns.hpp"
#include "laser/units.hpp"

namespace ecs::laser {

/// What a heading says that its column holds.
enum class Meaning { none, reading, position, counter, run, approach, temperature, pressure, humidity, time, other };

/// The sign of a difference, as its heading states it.
struct HeadingSign {
  bool is_reversed = false;    ///< target - actual, or a correction; else an error: actual - target
  bool is_correction = false;  ///< what is added to correct
  bool is_open = false;        ///< the heading leaves it open; `is_reversed` is an assumption
};
/// "Soll-Ist" and "Correction" are reversed, "Ist-Soll" and "Deviation" are errors, "diff" is open. Nothing of headings
/// of other quantities, and of correction factors.
[[nodiscard]] std::optional<HeadingSign> sign_in_heading(std::string_view heading);

struct TableColumn {
  std::size_t number = 0;  ///< from 1
  std::string heading;
  Meaning meaning = Meaning::none;
  std::optional<Unit> unit;         ///< of the heading
  std::optional<HeadingSign> sign;  ///< of a difference that the heading names
  std::vector<std::string_view> cells;
  std::vector<double> numbers;  ///< of the cells that are numbers
  std::vector<double> values;   ///< as many as cells where each is a number, else none
  [[nodiscard]] bool is_number() const { return !values.empty(); }
  /// Numbers, and empty cells between them.
  [[nodiscard]] bool has_gaps() const {
    const auto empty = std::ranges::count_if(cells, [](std::string_view cell) { return cell.empty(); });
    return empty > 0 && !numbers.empty() && numbers.size() + static_cast<std::size_t>(empty) == cells.size();
  }
  [[nodiscard]] bool is_reversed() const { return sign && sign->is_reversed; }
  /// @pre there are numbers
  [[nodiscard]] double least() const { return *std::ranges::min_element(numbers); }
  [[nodiscard]] double most() const { return *std::ranges::max_element(numbers); }
  [[nodiscard]] double span() const { return most() - least(); }
  [[nodiscard]] bool turns() const { return unit && unit->kind == UnitKind::angle; }
  /// One of the cells in mm, or deg.
  [[nodiscard]] double as_target() const {
    if (!unit) return 1.0;
    return unit->kind == UnitKind::angle ? unit->factor / kUmPerMPerDegree : unit->factor;
  }
  /// … in um, or um/m.
  [[nodiscard]] double as_error() const {
    if (!unit) return 1.0;
    return unit->kind == UnitKind::length ? unit->factor * 1000.0 : unit->factor;
  }
};
using Columns = std::vector<TableColumn>;

[[nodiscard]] bool is_one_of(std::string_view word, std::initializer_list<std::string_view> words);

/// Every column; numbers where each of its cells is one.
[[nodiscard]] Columns columns_of(std::string_view text, const TableShape& shape);

/// 0, 1, 2, ... or 1, 2, 3, ...
[[nodiscard]] bool counts_rows(const TableColumn& column);
/// Whole numbers, fewer than rows: a number of each row is no run.
[[nodiscard]] bool are_runs(const TableColumn& column);
/// Whether the values are positions that were reached where `targets` were asked for.
[[nodiscard]] bool are_actual(const TableColumn& column, const TableColumn& targets);
/// Positions of a poor encoder: the same travel, of each row not far from the target, and not its axis by the headings.
[[nodiscard]] bool are_loosely_actual(const TableColumn& column, const TableColumn& targets);
/// Positions without a unit that cover just one turn.
[[nodiscard]] bool is_one_turn(const TableColumn& targets);
/// An axis that stays at one place for many rows, one after the other.
[[nodiscard]] bool rests(const TableColumn& targets);
/// Small against the travel, but perhaps not round 0: a run that drifted, too.
[[nodiscard]] bool are_small(const TableColumn& column, const TableColumn& targets);
/// Small against the travel and round 0.
[[nodiscard]] bool are_errors(const TableColumn& column, const TableColumn& targets);
/// The heading names a straightness, or one of its directions.
[[nodiscard]] bool is_straightness(const TableColumn& column);
[[nodiscard]] bool could_be_targets(const TableColumn& column, const Columns& columns);
/// Whether the headings allow it: a column named so where there is one, no count of runs.
[[nodiscard]] bool could_be_readings(const TableColumn& column, const Columns& columns);
[[nodiscard]] bool go_both_ways(const TableColumn& targets);
/// 0, 1, 2, ... or 1, 2, 3, ... again in each run: in place of a time.
[[nodiscard]] bool counts_rows_of_runs(const TableColumn& column);
/// Unit of one step of such a column, which no file states: "s", or the shortest of "min" and "h" in which no
/// temperature of the table changes faster than the bodies and the air of a machine do.
[[nodiscard]] std::string_view interval_of_rows(const TableColumn& counter, const Columns& columns);

/// Why nothing is suggested although columns look like a measurement, and the remedy; empty: no such reason.
[[nodiscard]] std::string obstacle_in(const Columns& columns);

/// The options for columns that look like a measurement: of a ball, of points, else the first pair of targets and
/// positions reached, else of targets and errors, else readings over time.
[[nodiscard]] std::optional<TableSuggestion> suggestion_for(const Columns& columns, const TableShape& shape);

}  // namespace ecs::laser
