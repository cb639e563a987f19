// Which columns of a table that nobody has described are positions, readings, passes and conditions, as options of
// `laser import`. Does not live here: what a single column looks like (guessed_columns.cpp), the words about it
// (explain.cpp).
#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.hpp"
#include "laser/csv_columns.hpp"
#include "laser/import/columns.hpp"
#include "laser/import/fields.hpp"
#include "laser/import/guessed_columns.hpp"
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
std::string interval_text(const Columns& columns, std::string_view rules) {
  const TableColumn* counter = counter_of_runs(columns);
  if (counter == nullptr || rules.find(fmt::format(",time_s={}[", counter->number)) == rules.npos) return {};
  const std::string_view unit = interval_of_rows(*counter, columns);
  return fmt::format(
      "; column {0} counts the readings of each run, and the file does not state their interval. It is assumed to be 1 "
      "{1}{2}. Write time_s={0}*30 if it is 30 s",
      counter->number, unit,
      unit == "s" ? "" : ", because with a shorter unit a temperature would change faster than 3 degC/min");
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

/// The letter of a linear or of a rotary axis in a heading, lower case; else `otherwise`.
char axis_letter(const TableColumn& column, std::string_view letters, char otherwise) {
  for (const std::string& word : heading_words(column.heading))
    if (word.size() == 1 && letters.find(word[0]) != letters.npos) return word[0];
  return otherwise;
}

/// Errors without a unit are um, but mm where they would all be far too small for um.
std::string error_unit(const TableColumn& column) {
  constexpr double kTooSmall_um = 0.1;
  if (column.unit) return std::string(column.unit->name);
  return std::max(std::abs(column.least()), std::abs(column.most())) < kTooSmall_um ? "mm" : "um";
}

std::string reading_rule(const TableColumn& column, const TableColumn& targets, bool actual) {
  if (actual)
    return fmt::format("reading={}[{}]", column.number,
                       column.unit       ? column.unit->name
                       : targets.turns() ? "deg"
                                         : "mm");
  if (targets.turns()) return fmt::format("reading={}[{}]", column.number, column.unit ? column.unit->name : "um/m");
  return fmt::format("{}={}[{}]", column.turns() ? "EB" : "reading", column.number, error_unit(column));
}

/// "forward2" of "F2 (um)", "Lauf 2 vor": the field of a column that holds one pass; empty: the heading names none.
std::string pass_field(const std::string& heading) {
  std::string direction, number;
  for (const std::string& word : heading_words(heading)) {
    const std::size_t digits = std::min(word.find_first_of("0123456789"), word.size());
    const std::string letters = word.substr(0, digits);
    if (is_one_of(letters, {"f", "fwd", "forward", "vor", "vorw\xC3\xA4rts", "hin", "aller", "up"}))
      direction = "forward";
    if (is_one_of(letters, {"b", "r", "rev", "reverse", "bwd", "back", "backward", "r\u00FCck", "r\u00FCckw\xC3\xA4rts",
                            "zur\u00FCck", "retour", "down"}))
      direction = "reverse";
    if (digits < word.size() && integer_in(word.substr(digits))) number = word.substr(digits);
  }
  const std::string field = direction + (number.empty() ? "1" : number);
  return pass_named(field) ? field : "";
}

/// "forward1=2[um],reverse1=3[um]" where the columns of errors are passes, each another; empty: they are not.
std::string pass_columns(const Columns& columns, const TableColumn& targets, bool actual) {
  std::vector<std::string> fields, rules;
  for (const TableColumn& column : columns) {
    const std::string field = pass_field(column.heading);
    const bool fits = column.is_number() && column.turns() == targets.turns() && &column != &targets &&
                      !field.empty() && column.meaning != Meaning::temperature &&
                      (actual ? are_actual(column, targets) : are_errors(column, targets));
    if (!fits) continue;
    if (std::ranges::find(fields, field) != fields.end()) return {};
    fields.push_back(field);
    rules.push_back(field + reading_rule(column, targets, actual).substr(std::string_view("reading").size()));
  }
  return fields.size() < 2 ? std::string() : fmt::format("{}", fmt::join(rules, ","));
}

/// @pre the readings are errors, or positions reached where `actual`
TableSuggestion pair_suggestion(const TableColumn& targets, const TableColumn& readings, bool actual,
                                const Columns& columns) {
  const bool turns = targets.turns();
  const std::string field = turns ? fmt::format("{}_deg", axis_letter(targets, "abc", 'c'))
                                  : fmt::format("{}_mm", axis_letter(targets, "xyz", 'x'));
  const std::string date = date_rule(columns);
  const std::string passes = pass_columns(columns, targets, actual);
  std::string others;
  for (const TableColumn& column : columns)
    if (passes.empty() && &column != &readings && !actual && column.is_number() && column.meaning == Meaning::reading)
      others +=
          fmt::format("{} {}", others.empty() ? "; import readings of other columns separately:" : ",", column.number);
  TableSuggestion suggestion;
  suggestion.columns = fmt::format("{}={}[{}],{}{}{}{}", field, targets.number,
                                   targets.unit ? targets.unit->name
                                   : turns      ? "deg"
                                                : "mm",
                                   passes.empty() ? reading_rule(readings, targets, actual) : passes, date,
                                   passes.empty() ? pass_rules(columns, date.empty() || go_both_ways(targets)) : "",
                                   condition_rules(columns, !date.empty()));
  suggestion.actual = actual;
  suggestion.reads = fmt::format(
      "column {} as targets and {} as {}, if that is their meaning{}{}{}", targets.number,
      passes.empty() ? fmt::format("column {}", readings.number) : "the columns of passes",
      actual ? "the positions reached" : "errors",
      !turns && readings.turns() && !actual ? " (EB is a rotation about Y; EA and EC are those about X and Z)" : "",
      others, interval_text(columns, suggestion.columns));
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
      suggestion.actual = true;
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
  suggestion.columns = angles + tips;
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
      for (const TableColumn& readings : columns)
        if (&readings != &targets && could_be_readings(readings, columns) &&
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
  suggestion.columns = fmt::format("reading={}[{}]{}{}{}", number, error_unit(*found.front()), date,
                                   pass_rules(columns, false), condition_rules(columns, !date.empty()));
  suggestion.axis = "X";
  suggestion.parked = date.empty() ? "x=0" : "";
  suggestion.reads = fmt::format("column {} as errors at one position, if that is their meaning{}", number,
                                 interval_text(columns, suggestion.columns));
  return suggestion;
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

std::optional<TableSuggestion> suggestion_for(const Columns& columns, const TableShape& shape) {
  auto found = pair_columns(columns);
  if (!found) found = named_pair(columns);
  if (!found) found = growth_columns(columns);
  if (found) found->rows = rows_of(shape);
  return found;
}

}  // namespace ecs::laser
