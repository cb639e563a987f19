// Which columns of a table that nobody has described are positions, readings, passes and conditions, as options of
// `laser import`. Does not live here: what a single column looks like (guessed_columns.cpp), which columns are passes
// and senses (guessed_passes.cpp), the words about it (explain.cpp).
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.hpp"
#include "laser/csv_columns.hpp"
#include "laser/findings.hpp"
#include "laser/import/columns.hpp"
#include "laser/import/fields.hpp"
#include "laser/import/guessed_passes.hpp"
#include "laser/import/time.hpp"
#include "laser/units.hpp"

namespace ecs::laser {
namespace {

/// Visits of one point are as close together as this part of the distances between points.
constexpr double kOfOnePoint = 0.05;

/// ",date_time=1", or ",date_time=1..2" of a date and the time beside it; empty: none is there.
std::string date_rule(const Columns& columns) {
  for (std::size_t i = 0; i < columns.size() && !columns[i].cells.empty(); ++i) {
    const std::string cell(columns[i].cells.front());
    if (seconds_in(cell)) return fmt::format(",date_time={}", i + 1);
    if (i + 1 < columns.size() && !columns[i + 1].cells.empty() &&
        seconds_in(cell + " " + std::string(columns[i + 1].cells.front())))
      return fmt::format(",date_time={}..{}", i + 1, i + 2);
  }
  return {};
}

/// ",time_s=1*1e-7-…" of a column of moments in steps of 100 ns since 1601, as Windows and TwinCAT count them, from the
/// first row; empty: none is there.
std::string stamp_rule(const Columns& columns) {
  constexpr double kFrom = 1.2e17, kTo = 1.7e17, kStep_s = 1e-7;  // years 1981 to 2139
  for (const TableColumn& column : columns)
    if (column.is_number() && column.least() > kFrom && column.most() < kTo && column.span() > 0.0 &&
        std::ranges::is_sorted(column.values))
      return fmt::format(",time_s={}*1e-7-{:.3f}", column.number, column.values.front() * kStep_s);
  return {};
}

/// ",approach=2,run=3" as headings name them, else the approach from the motion.
std::string pass_rules(const Columns& columns, bool moves) {
  std::string approach = moves ? ",approach=motion" : "", run;
  for (const TableColumn& column : columns) {
    if (column.meaning == Meaning::run && run.empty() && are_runs(column)) run = fmt::format(",run={}", column.number);
    if (column.meaning == Meaning::approach && moves && approach == ",approach=motion" &&
        std::ranges::all_of(column.cells, [](auto cell) { return approach_named(cell).has_value(); }))
      approach = fmt::format(",approach={}", column.number);
  }
  return approach + run;
}

const TableColumn* counter_of_runs(const Columns& columns) {
  const auto found = std::ranges::find_if(columns, [](const TableColumn& column) {
    return column.is_number() && column.meaning == Meaning::counter && counts_rows_of_runs(column);
  });
  return found == columns.end() ? nullptr : &*found;
}

/// What is assumed of a column that counts rows in place of a time: lags, and the correlation of noise, depend on it.
void assume_interval(TableSuggestion& suggestion, const Columns& columns) {
  const TableColumn* counter = counter_of_runs(columns);
  if (counter == nullptr || suggestion.columns.find(fmt::format(",time_s={}[", counter->number)) == std::string::npos)
    return;
  const std::string_view unit = interval_of_rows(*counter, columns);
  suggestion.assumed.push_back(fmt::format(
      "Column {0} counts the readings of each run, and the file does not state their interval. It is assumed to be 1 "
      "{1}{2}. Write time_s={0}*30 if it is 30 s",
      counter->number, unit,
      unit == "s" ? "" : ", because with a shorter unit a temperature would change faster than 3 degC/min"));
}

/// The meaning of the readings by the sign that their heading states, and why.
void take_sign(TableSuggestion& suggestion, const TableColumn& readings) {
  if (suggestion.values == TableValues::actual_positions || !readings.sign) return;
  const auto& sign = *readings.sign;
  const std::string heading = in_quotes(readings.heading);
  if (sign.is_reversed) suggestion.values = TableValues::compensations;
  const std::string_view order = sign.is_reversed ? "target - actual" : "actual - target";
  if (sign.is_open)
    suggestion.assumed.push_back(fmt::format(
        "The heading {} leaves the sign open. Assumed is {}{}. {}", heading, sign.is_correction ? "a correction, " : "",
        order,
        sign.is_reversed ? "The sign is reversed, because error = actual - target. Without --values compensation the "
                           "readings are errors"
                         : "Add --values compensation if the readings are target - actual"));
  else if (sign.is_reversed)
    suggestion.assumed.push_back(fmt::format(
        "The sign is reversed (--values compensation), because the heading {} states {}, and error = actual "
        "- target",
        heading, sign.is_correction ? "a correction" : order));
}

/// Temperatures, air and time as their headings name them.
std::string condition_rules(const Columns& columns, bool dated) {
  std::string rules;
  const auto add = [&](const std::string& field, const TableColumn& column) {
    if (rules.find("," + field + "=") == rules.npos)
      rules += fmt::format(",{}={}{}", field, column.number, column.unit ? fmt::format("[{}]", column.unit->name) : "");
  };
  for (const TableColumn& column : columns) {
    if (!column.is_number()) continue;
    if (column.meaning == Meaning::temperature) add(sensor_named(column.heading, column.number), column);
    if (column.meaning == Meaning::pressure) add("pressure_hPa", column);
    if (column.meaning == Meaning::humidity && !column.unit) add("humidity_pct", column);
    if (column.meaning == Meaning::time && !dated) add("time_s", column);
  }
  if (const TableColumn* counter = dated ? nullptr : counter_of_runs(columns);
      counter != nullptr && rules.find(",time_s=") == rules.npos)
    rules += fmt::format(",time_s={}[{}]", counter->number, interval_of_rows(*counter, columns));
  if (!dated && rules.find(",time_s=") == rules.npos) rules += stamp_rule(columns);
  return rules;
}

/// The axis of each row as a column states it.
struct AxisOfRows {
  const TableColumn* column = nullptr;
  std::string letters{};     ///< lower case, each once
  std::string_view wrong{};  ///< a cell that names no axis
};
AxisOfRows axis_of_rows(const Columns& columns) {
  AxisOfRows found;
  for (const TableColumn& column : columns) {
    const auto words = heading_words(column.heading);
    const bool named = std::ranges::any_of(words, [](const auto& word) {
      return is_one_of(word, {"axis", "achse", "axe", "axes", "achsen"});
    });
    if (column.is_number() || column.cells.empty() || !named) continue;
    found.column = &column;
    for (const std::string_view cell : column.cells) {
      const bool same = cell == column.cells.front();
      const auto letters = heading_words(cell);
      const auto letter = std::ranges::find_if(letters, [](const auto& word) {
        return word.size() == 1 && std::string_view("xyzabc").find(word) != std::string_view::npos;
      });
      if (letter == letters.end() || (cell.size() > 1 && !same)) {
        found.wrong = cell;
        break;
      }
      if (found.letters.find(*letter) == std::string::npos) found.letters += *letter;
    }
    if (found.letters.size() > 1 && column.cells.front().size() > 1) found.wrong = column.cells.front();
    break;
  }
  return found;
}

/// @pre the readings are errors, or positions reached where `actual`
TableSuggestion pair_suggestion(const TableColumn& targets, const TableColumn& readings, bool actual,
                                const Columns& columns) {
  const bool turns = targets.turns();
  const AxisOfRows rows = axis_of_rows(columns);
  const bool several = rows.letters.size() > 1;
  const char axis =
      rows.letters.empty() ? axis_letter(targets, turns ? "abc" : "xyz", turns ? 'c' : 'x') : rows.letters[0];
  const bool is_sure = !several && (!rows.letters.empty() || axis_letter(targets, "xyz", ' ') != ' ');
  const auto sense_by = [&](const TableColumn& column, std::string_view used) {
    return actual || several ? StatedSense{} : sense_of(column, axis, is_sure, used);
  };
  const StatedSense sense = sense_by(readings, {});
  const bool rotary = std::string_view("abc").find(axis) != std::string_view::npos;
  const std::string date = date_rule(columns);
  TableSuggestion suggestion;
  if (actual) suggestion.values = TableValues::actual_positions;
  const PassColumns passes = pass_columns(columns, targets, readings, actual, [&](const TableColumn& column) {
    return sense_by(column, {}).name == sense.name;
  });
  std::string values = passes.rules, others;
  if (!values.empty()) {
    suggestion.sense = sense.name;
    for (const std::string& sentence : {passes.assumed, sense.assumed})
      if (!sentence.empty()) suggestion.assumed.push_back(sentence);
    if (!passes.numbered) others = pass_rules(columns, false);
  } else {
    if (!actual && !several && !turns && !rotary)
      values = sense_columns(columns, targets, readings, axis, sense_by, suggestion.assumed);
    if (values.empty())
      values = (readings.turns() && !turns && !actual ? "EB=" : "reading=") +
               reading_place(readings, targets, actual, largest_of(readings));
    others = pass_rules(columns, date.empty() || go_both_ways(targets));
  }
  const bool about_y = values.starts_with("EB=") && !turns && sense.name.empty() && !actual;
  suggestion.columns =
      fmt::format("{}={}[{}],{}{}{}{}{}",
                  several ? std::string("target") : fmt::format("{}_{}", axis, rotary ? "deg" : "mm"), targets.number,
                  targets.unit ? targets.unit->name
                  : rotary     ? "deg"
                               : "mm",
                  values, several ? fmt::format(",axis={}", rows.column->number) : "", date, others,
                  condition_rules(columns, !date.empty()));
  take_sign(suggestion, readings);
  suggestion.reads = fmt::format("column {} as targets and {} as {}, if that is their meaning{}", targets.number,
                                 !passes.rules.empty()                   ? "the columns of passes"
                                 : values.find(',') == std::string::npos ? fmt::format("column {}", readings.number)
                                                                         : "the columns of several senses",
                                 actual                                            ? "the positions reached"
                                 : suggestion.values == TableValues::compensations ? "compensation (target - actual)"
                                                                                   : "errors (actual - target)",
                                 about_y ? " (EB is a rotation about Y; EA and EC are those about X and Z)" : "");
  assume_interval(suggestion, columns);
  return suggestion;
}

/// Positions of a poor encoder beside their targets.
std::optional<TableSuggestion> loose_pair(const Columns& columns) {
  for (const TableColumn& targets : columns) {
    if (!could_be_targets(targets, columns)) continue;
    for (const TableColumn& actual : columns) {
      if (&actual == &targets || !actual.is_number() || !are_loosely_actual(actual, targets)) continue;
      const bool turns = is_one_turn(targets);
      const std::string unit = turns ? "deg" : "mm";
      TableSuggestion suggestion;
      suggestion.columns =
          fmt::format("{0}={1}[{2}],reading={3}[{2}]{4}{5}{6}",
                      turns ? fmt::format("{}_deg", axis_letter(targets, "abc", 'c'))
                            : fmt::format("{}_mm", axis_letter(targets, "xyz", 'x')),
                      targets.number, unit, actual.number, go_both_ways(targets) ? ",approach=motion,run=motion" : "",
                      rests(targets) ? ",rows=in_motion" : "", stamp_rule(columns));
      suggestion.values = TableValues::actual_positions;
      suggestion.reads = fmt::format(
          "column {} as targets and column {} as the positions reached, if that is their "
          "meaning",
          targets.number, actual.number);
      return suggestion;
    }
  }
  return std::nullopt;
}

/// Columns of numbers whose headings name X, Y and Z beside one of these words; all three or none.
std::vector<const TableColumn*> coordinates(const Columns& columns, std::initializer_list<std::string_view> words) {
  std::vector<const TableColumn*> found;
  for (const char letter : {'x', 'y', 'z'})
    for (const TableColumn& column : columns) {
      const auto named = heading_words(column.heading);
      const bool fits = column.is_number() && (!column.unit || column.unit->kind == UnitKind::length) &&
                        axis_letter(column, "xyz", ' ') == letter &&
                        std::ranges::any_of(named, [&](const std::string& word) { return is_one_of(word, words); });
      if (fits && found.size() == static_cast<std::size_t>(letter - 'x')) found.push_back(&column);
    }
  if (found.size() != kAxes) found.clear();
  return found;
}

/// Words that divide the rows into groups.
bool are_groups(const TableColumn& column) {
  const std::set<std::string_view> words(column.cells.begin(), column.cells.end());
  return column.numbers.empty() && words.size() > 1 && 2 * words.size() <= column.cells.size();
}

/// ",set_up=1" of groups whose heading says that the ball was set up, or the reference taken, again.
std::string set_up_rule(const Columns& columns) {
  for (const TableColumn& column : columns)
    if (are_groups(column) && std::ranges::any_of(heading_words(column.heading), [](const std::string& word) {
          return is_one_of(word, {"set", "sets", "setup", "session", "series", "aufspannung", "messreihe"});
        }))
      return fmt::format(",set_up={}", column.number);
  return {};
}

/// Centres of a ball as the control saw them at several angles of rotary axes.
std::optional<TableSuggestion> ball_columns(const Columns& columns) {
  const auto centre = coordinates(columns, {"center", "centre", "ball", "sphere", "tip", "tcp", "kugel", "mitte"});
  std::string angles;
  for (const TableColumn& column : columns)
    if (const char letter = axis_letter(column, "abc", ' '); column.is_number() && column.turns() && letter != ' ')
      angles += fmt::format("{}_deg={}[{}],", letter, column.number, column.unit->name);
  if (centre.empty() || angles.empty()) return std::nullopt;
  std::string tips;
  for (std::size_t d = 0; d < kAxes; ++d)
    tips += fmt::format("{}tip_{}_mm={}[{}]", d == 0 ? "" : ",", "xyz"[d], centre[d] -> number,
                        centre[d] -> unit ? centre[d] -> unit -> name : "mm");
  TableSuggestion suggestion;
  suggestion.columns = angles + tips + set_up_rule(columns);
  suggestion.reads = fmt::format("column {}, {} and {} as tool centre points at a ball, if that is their meaning",
                                 centre[0]->number, centre[1]->number, centre[2]->number);
  return suggestion;
}

/// Points that are visited again and again: a column that counts them, and three coordinates.
std::optional<TableSuggestion> point_columns(const Columns& columns) {
  std::vector<const TableColumn*> numbers;
  for (const TableColumn& column : columns)
    if (column.is_number()) numbers.push_back(&column);
  if (numbers.size() != 1 + kAxes || !are_runs(*numbers.front())) return std::nullopt;
  std::map<double, std::vector<std::size_t>> visits;
  for (std::size_t i = 0; i < numbers.front()->values.size(); ++i) visits[numbers.front()->values[i]].push_back(i);
  double apart = 0.0, scatter = 0.0;
  for (std::size_t c = 1; c <= kAxes; ++c) {
    apart = std::max(apart, numbers[c]->span());
    for (const auto& [point, rows] : visits) {
      if (rows.size() < 2) return std::nullopt;
      const auto [least, most] =
          std::ranges::minmax_element(rows, {}, [&](std::size_t i) { return numbers[c]->values[i]; });
      scatter = std::max(scatter, numbers[c]->values[*most] - numbers[c]->values[*least]);
    }
  }
  if (visits.size() < 2 || scatter > kOfOnePoint * apart) return std::nullopt;
  std::string rules = fmt::format("{}={}", kPointColumn, numbers.front()->number);
  for (std::size_t c = 1; c <= kAxes; ++c)
    rules += fmt::format(",measured_{}_mm={}[{}]", "xyz"[c - 1], numbers[c] -> number,
                         numbers[c] -> unit ? numbers[c] -> unit -> name : "mm");
  TableSuggestion suggestion;
  suggestion.columns = std::move(rules);
  suggestion.reads =
      fmt::format("column {} as the number of a point and the next three as its X, Y and Z, if that is their meaning",
                  numbers.front()->number);
  return suggestion;
}

std::optional<TableSuggestion> pair_columns(const Columns& columns) {
  if (auto of_ball = ball_columns(columns)) return of_ball;
  if (auto of_points = point_columns(columns)) return of_points;
  for (const bool actual : {true, false}) {
    for (const TableColumn& targets : columns) {
      if (!could_be_targets(targets, columns)) continue;
      for (const bool reversed : {false, true})  // errors are read rather than corrections beside them
        for (const TableColumn& readings : columns)
          if (&readings != &targets && could_be_readings(readings, columns) && readings.is_reversed() == reversed &&
              (actual ? are_actual(readings, targets)
                      : readings.meaning == Meaning::reading || are_errors(readings, targets)))
            return pair_suggestion(targets, readings, actual, columns);
    }
    if (auto loose = actual ? loose_pair(columns) : std::nullopt) return loose;
  }
  return std::nullopt;
}

/// Positions by their heading, over some travel: few of them, or in any order.
bool is_named_travel(const TableColumn& column) {
  constexpr double kLeast_mm = 1.0;
  const bool fits = !column.unit || column.unit->kind == UnitKind::length || column.unit->kind == UnitKind::angle;
  return column.is_number() && fits && column.meaning == Meaning::position &&
         column.span() * column.as_target() >= kLeast_mm;
}

/// The only column of positions and the only one of readings by their headings, whatever the values look like.
std::optional<TableSuggestion> named_pair(const Columns& columns) {
  const TableColumn *targets = nullptr, *readings = nullptr;
  for (const TableColumn& column : columns) {
    const bool travels = is_named_travel(column);
    const bool reads = column.meaning == Meaning::reading && could_be_readings(column, columns);
    if ((travels && targets != nullptr) || (reads && readings != nullptr)) return std::nullopt;
    if (travels) targets = &column;
    if (reads) readings = &column;
  }
  if (targets == nullptr || readings == nullptr) return std::nullopt;
  return pair_suggestion(*targets, *readings, are_actual(*readings, *targets), columns);
}

/// One column of readings at one place, over time: the only one, or the only one that is named so.
std::optional<TableSuggestion> growth_columns(const Columns& columns) {
  std::vector<const TableColumn*> numbers, named;
  for (const TableColumn& column : columns) {
    if (column.is_number() && column.meaning != Meaning::run) numbers.push_back(&column);
    if (column.is_number() && column.meaning == Meaning::reading) named.push_back(&column);
  }
  const auto& found = named.empty() ? numbers : named;
  if (std::ranges::any_of(columns, is_named_travel)) return std::nullopt;
  if (found.size() != 1 || found.front()->span() == 0.0 || found.front()->turns()) return std::nullopt;
  const std::size_t number = found.front()->number;
  const std::string date = date_rule(columns);
  TableSuggestion suggestion;
  suggestion.columns =
      fmt::format("reading={}[{}]{}{}{}", number, error_unit(*found.front(), largest_of(*found.front())), date,
                  pass_rules(columns, false), condition_rules(columns, !date.empty()));
  suggestion.axis = "X";
  suggestion.parked = date.empty() ? "x=0" : "";
  take_sign(suggestion, *found.front());
  suggestion.reads = fmt::format("column {} as {} at one position, if that is their meaning", number,
                                 suggestion.values == TableValues::errors ? "errors" : "compensation");
  assume_interval(suggestion, columns);
  return suggestion;
}

/// Rows of several axes whose cells name them in another way than the import reads, or not at all.
std::string axis_obstacle(const Columns& columns) {
  const AxisOfRows rows = axis_of_rows(columns);
  if (rows.column == nullptr || rows.wrong.empty()) return {};
  return fmt::format(
      "Column {} {} names the axis of each row, but {} is none of X, Y, Z, A, B and C. Write these letters in its "
      "cells",
      rows.column->number, in_quotes(rows.column->heading), in_quotes(rows.wrong));
}

/// Targets that are no numbers in some rows, so that the readings would seem to be at one position.
std::string target_obstacle(const Columns& columns) {
  for (const TableColumn& column : columns) {
    if (column.meaning != Meaning::position || column.numbers.empty() || column.is_number()) continue;
    const auto wrong = std::ranges::find_if(column.cells, [](auto cell) { return !number_or_comma(cell); });
    return fmt::format("Column {} {} has cells that are not numbers, the first is {}. Correct them", column.number,
                       in_quotes(column.heading), in_quotes(*wrong));
  }
  return {};
}

/// A row for each run below a row of targets.
std::string transposed_obstacle(const Columns& columns) {
  constexpr std::size_t kFewestTargets = 4;
  constexpr double kGreatestPart = 0.3;  // errors are smaller than this part of the last target
  if (columns.size() < 1 + kFewestTargets || columns.front().is_number() || columns.front().cells.size() < 2) return {};
  double before = -std::numeric_limits<double>::infinity(), largest = 0.0;
  for (std::size_t k = 1; k < columns.size(); ++k) {
    const auto& values = columns[k].values;
    if (values.empty() || values.front() <= before) return {};
    before = values.front();
    for (std::size_t i = 1; i < values.size(); ++i) largest = std::max(largest, std::abs(values[i]));
  }
  if (largest > kGreatestPart * (before - columns[1].values.front())) return {};
  return "The table seems to have the targets in its first row and a row for each run. Exchange rows and columns, so "
         "that "
         "each row has a target and its readings";
}

/// Every column with numbers, or with words that divide the rows, that the rules do not read.
std::string unread_in(const Columns& columns, const std::string& rules_text) {
  constexpr std::size_t kMostHeadings = 12;  // more are named by their numbers alone
  const auto rules = column_rules(rules_text);
  std::vector<const TableColumn*> unread;
  for (const TableColumn& column : columns) {
    const auto reads = [&](const ColumnRule& rule) {
      return column.number >= static_cast<std::size_t>(rule.column) &&
             column.number < static_cast<std::size_t>(rule.column + rule.columns);
    };
    if ((!column.numbers.empty() || are_groups(column)) && std::ranges::none_of(*rules, reads))
      unread.push_back(&column);
  }
  if (unread.empty()) return {};
  std::vector<std::string> named;
  bool readings = false;
  for (const TableColumn* column : unread) {
    readings = readings || column->meaning == Meaning::reading;
    const bool words = !column->numbers.empty() && !column->is_number() && !column->has_gaps();
    named.push_back(unread.size() > kMostHeadings || column->heading.empty()
                        ? std::to_string(column->number)
                        : fmt::format("{} {}", column->number, in_quotes(column->heading)));
    if (words) named.back() += " (some cells are not numbers)";
  }
  return fmt::format("{} not read: {}{}", unread.size() == 1 ? "This column is" : "These columns are",
                     fmt::join(named, ", "), readings ? ". Import further readings separately" : "");
}

}  // namespace

std::string sensor_named(std::string_view heading, std::size_t number) {
  std::string name;
  for (const std::string& word : heading_words(heading)) {
    if (word.find("luft") != word.npos || word == "air") return "t_air_degC";
    if (word.find("material") != word.npos || word.find("werkst") != word.npos) return "t_material_degC";
    std::string plain;
    for (const char c : word)
      if (static_cast<unsigned char>(c) < 0x80) plain += c;
    if (is_one_of(plain, {"t", "temp", "temperature", "temperatur", "c", "f", "k", "degc", "degf", "deg", "in"}))
      continue;
    if (!plain.empty()) name += (name.empty() ? "" : "_") + plain;
  }
  return fmt::format("t_{}_degC", name.empty() ? std::to_string(number) : name);
}

std::string obstacle_in(const Columns& columns) {
  for (const auto& obstacle : {axis_obstacle, target_obstacle, transposed_obstacle})
    if (std::string why = obstacle(columns); !why.empty()) return why;
  return {};
}

std::optional<TableSuggestion> suggestion_for(const Columns& columns, const TableShape& shape) {
  if (!axis_obstacle(columns).empty() || !transposed_obstacle(columns).empty()) return std::nullopt;
  auto found = pair_columns(columns);
  if (!found) found = named_pair(columns);
  if (!found && target_obstacle(columns).empty()) found = growth_columns(columns);
  if (!found) return found;
  found->rows = rows_of(shape);
  found->unread = unread_in(columns, found->columns);
  return found;
}

}  // namespace ecs::laser
