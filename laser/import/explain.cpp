// Why a file is not read, in words that help: what it seems to be, the table found in it, which of its columns could be
// positions and readings, the command that imports it. Does not live here: how columns are told apart
// (guessed_columns.hpp).

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/file_kind.hpp"
#include "base/text.hpp"
#include "laser/csv_columns.hpp"
#include "laser/findings.hpp"
#include "laser/import/columns.hpp"
#include "laser/import/fields.hpp"
#include "laser/import/format.hpp"
#include "laser/import/guessed_columns.hpp"
#include "laser/import/import.hpp"
#include "laser/import/time.hpp"
#include "laser/units.hpp"

namespace ecs::laser {
namespace {

/// Visits of one point are as close together as this part of the distances between points.
constexpr double kOfOnePoint = 0.05;
constexpr std::size_t kMostNamed = 12;

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

std::string row_options(const TableShape& shape) {
  const Rows rows = rows_of(shape);
  return (rows.skip > 0 ? fmt::format(" --skip {}", rows.skip) : "") +
         (rows.count > 0 ? fmt::format(" --rows {}", rows.count) : "");
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

/// The name of a temperature: "t_air_degC" of "T Luft [°C]".
std::string sensor_of(const TableColumn& column) {
  std::string name;
  for (const std::string& word : heading_words(column.heading)) {
    if (word.find("luft") != word.npos || word == "air") return "t_air_degC";
    if (word.find("material") != word.npos || word.find("werkst") != word.npos) return "t_material_degC";
    std::string plain;
    for (const char c : word)
      if (static_cast<unsigned char>(c) < 0x80) plain += c;
    if (is_one_of(plain, {"t", "temp", "temperature", "temperatur", "c", "f", "k", "degc", "degf", "deg", "in"}))
      continue;
    if (!plain.empty()) name += (name.empty() ? "" : "_") + plain;
  }
  return fmt::format("t_{}_degC", name.empty() ? std::to_string(column.number) : name);
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
    if (column.meaning == Meaning::temperature) add(sensor_of(column), column);
    if (column.meaning == Meaning::pressure) add("pressure_hPa", column);
    if (column.meaning == Meaning::humidity && !column.unit) add("humidity_pct", column);
    if (column.meaning == Meaning::time && !dated) add("time_s", column);
  }
  for (const TableColumn& column : columns)
    if (column.is_number() && column.meaning == Meaning::counter && !dated && counts_rows_of_runs(column))
      add("time_s", column);
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

std::string pair_text(const TableColumn& targets, const TableColumn& readings, bool actual, const TableShape& shape,
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
  return fmt::format(
      "--columns \"{}={}[{}],{}{}{}{}\"{}{} reads column {} as targets and {} as {}, if that is their meaning{}{}",
      field, targets.number,
      targets.unit ? targets.unit->name
      : turns      ? "deg"
                   : "mm",
      passes.empty() ? reading_rule(readings, targets, actual) : passes, date,
      passes.empty() ? pass_rules(columns, date.empty() || go_both_ways(targets)) : "",
      condition_rules(columns, !date.empty()), actual ? " --values actual" : "", row_options(shape), targets.number,
      passes.empty() ? fmt::format("column {}", readings.number) : "the columns of passes",
      actual ? "the positions reached" : "errors",
      !turns && readings.turns() && !actual ? " (EB is a rotation about Y; EA and EC are those about X and Z)" : "",
      others);
}

/// Positions of a poor encoder beside their targets.
std::optional<std::string> loose_advice(const Columns& columns, const TableShape& shape) {
  for (const TableColumn& targets : columns) {
    if (!could_be_targets(targets, columns)) continue;
    for (const TableColumn& actual : columns) {
      if (&actual == &targets || !actual.is_number() || !are_loosely_actual(actual, targets)) continue;
      const bool turns = is_one_turn(targets);
      const std::string unit = turns ? "deg" : "mm";
      return fmt::format(
          "--columns \"{0}={1}[{2}],reading={3}[{2}]{4}{5}{6}\" --values actual{7} reads column {1} as targets and "
          "column "
          "{3} as the positions reached, if that is their meaning",
          turns ? fmt::format("{}_deg", axis_letter(targets, "abc", 'c'))
                : fmt::format("{}_mm", axis_letter(targets, "xyz", 'x')),
          targets.number, unit, actual.number, go_both_ways(targets) ? ",approach=motion,run=motion" : "",
          rests(targets) ? ",rows=in_motion" : "", stamp_rule(columns), row_options(shape));
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
std::optional<std::string> ball_advice(const Columns& columns, const TableShape& shape) {
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
  return fmt::format(
      "--columns \"{}{}\"{} reads column {}, {} and {} as tool centre points at a ball, if that is their meaning",
      angles, tips, row_options(shape), centre[0]->number, centre[1]->number, centre[2]->number);
}

/// Points that are visited again and again: a column that counts them, and three coordinates.
std::optional<std::string> points_advice(const Columns& columns, const TableShape& shape) {
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
  return fmt::format(
      "--columns \"{}\"{} reads column {} as the number of a point and the next three as its X, Y and Z, if that is "
      "their meaning",
      rules, row_options(shape), numbers.front()->number);
}

/// The options for columns that look like a measurement: of a ball, of points, else the first pair of targets and
/// positions reached, else of targets and errors.
std::optional<std::string> pair_advice(const Columns& columns, const TableShape& shape) {
  if (auto ball = ball_advice(columns, shape)) return ball;
  if (auto points = points_advice(columns, shape)) return points;
  for (const bool actual : {true, false}) {
    for (const TableColumn& targets : columns) {
      if (!could_be_targets(targets, columns)) continue;
      for (const TableColumn& readings : columns)
        if (&readings != &targets && could_be_readings(readings, columns) &&
            (actual ? are_actual(readings, targets)
                    : readings.meaning == Meaning::reading || are_errors(readings, targets)))
          return pair_text(targets, readings, actual, shape, columns);
    }
    if (auto loose = actual ? loose_advice(columns, shape) : std::nullopt) return loose;
  }
  return std::nullopt;
}

/// One column of readings at one place, over time: the only one, or the only one that is named so.
std::optional<std::string> growth_advice(const Columns& columns, const TableShape& shape) {
  std::vector<const TableColumn*> numbers, named;
  for (const TableColumn& column : columns) {
    if (column.is_number() && column.meaning != Meaning::run) numbers.push_back(&column);
    if (column.is_number() && column.meaning == Meaning::reading) named.push_back(&column);
  }
  const auto& found = named.empty() ? numbers : named;
  if (found.size() != 1 || found.front()->span() == 0.0 || found.front()->turns()) return std::nullopt;
  const std::size_t number = found.front()->number;
  const std::string date = date_rule(columns);
  return fmt::format(
      "--columns \"reading={}[{}]{}{}{}\"{} --axis X{} reads column {} as errors at one position, if that is their "
      "meaning",
      number, error_unit(*found.front()), date, pass_rules(columns, false), condition_rules(columns, !date.empty()),
      row_options(shape), date.empty() ? " --parked x=0" : "", number);
}

std::string columns_named(const Columns& columns) {
  std::vector<std::string> named;
  for (const TableColumn& column : columns) {
    if (!column.is_number()) continue;
    if (named.size() < kMostNamed)
      named.push_back(fmt::format("{}{} ({:.6g} to {:.6g})", column.number,
                                  column.heading.empty() ? "" : " " + in_quotes(column.heading), column.least(),
                                  column.most()));
    else
      return fmt::format("{}, ...", fmt::join(named, ", "));
  }
  return fmt::format("{}", fmt::join(named, ", "));
}

/// Suggested is a column of positions that rises or falls over stretches, with a column of errors beside it that are
/// small against its travel, or of actual positions close to it; or readings over time. Where no columns are like that
/// the answer names the columns, and how to say which is what.
/// @param known  the file is of a kind that holds no measurements: nothing is suggested
std::string column_advice(std::string_view text, const TableShape& shape, bool known) {
  const auto columns = columns_of(text, shape);
  if (!known) {
    if (const auto advice = pair_advice(columns, shape)) return *advice;
    if (const auto advice = growth_advice(columns, shape)) return *advice;
  }
  if (std::ranges::none_of(columns, [](const auto& column) { return column.is_number(); }))
    return "Expected columns with a number in every row, found none: fill the empty cells";
  return fmt::format(
      "Expected targets with their errors, found the columns {}. If two of them are targets and errors, assign them: "
      "x_mm=N[mm],reading=M[um] with their numbers after --columns{}, and --values actual if M contains positions",
      columns_named(columns), row_options(shape));
}

constexpr std::size_t kExplainedBytes = 64 * 1024;

/// Files that engineers meet and that hold no measurement of a linear axis, by a word that only they have.
struct Known {
  std::string_view mark;  ///< lower case
  std::string_view is;
  bool becomes_map = false;  ///< where a module reads tables of controls
};

constexpr std::array<Known, 24> kKnown{{
    {":start2d", "an Aerotech two-axis correction table: values added by a control, not measured errors", true},
    {":start ", "an Aerotech correction table: values added by a control, not measured errors", true},
    {"$aa_enc_comp", "a SINUMERIK encoder error table: values added by a control, not measured errors", true},
    {"$an_cec", "a SINUMERIK sag error table: values added by a control, not measured errors", true},
    {".com  datum:", "a HEIDENHAIN compensation table: values added by a control, not measured errors"},
    {".com mm", "a HEIDENHAIN compensation table: values added by a control, not measured errors", true},
    {"kw.ssfk.", "a TwinCAT compensation list: values corrected by a control, not readings", true},
    {"gridpoints", "an Etalon exchange file: an error model, not readings of one axis", true},
    {"option record: altaz", "TPOINT pointing data of a telescope: azimuth and altitude, no linear axis"},
    {"pointing data", "a TPOINT pointing model of a telescope: fitted terms, no readings"},
    {"scan procedure description file", "the description of a SIOS scan: its numbers are in the .pos and .dat files"},
    {"motion system test report", "a test report: the readings are in the .dat file in the same folder"},
    {"residraderrrms", "the result of a plate's fit: the hole positions are in the measurement file of the plate"},
    {"artefact.ball_spacing", "a simulated ball bar or step gauge on a measuring machine (MSL): points and deviations"},
    {"cmm_model.", "the parameters of a measuring machine's error model: no readings"},
    {"target pos (", "telemetry of servo drives in encoder counts: no unit of length is in it"},
    {"roundness deviation", "the Lissajous figure of an interferometer: radius over phase, no positions"},
    {"refractive", "a table about the refractive index: no readings of an axis are in it"},
    {"vacuum_wavelength_nm", "a table of the refractive index of air: no readings of an axis are in it"},
    {"line,station,height_um", "heights of a surface: no readings of an axis are in it"},
    {"nist/itl strd", "a reference problem of regression (NIST StRD): no readings of an axis are in it"},
    {"# source", "a description"},
    {"<html", "a web page"},
    {"{\"", "a JSON document: only JSON lines are read, with one object and its time (ts, time_s, time) per line"},
}};

bool is_json_lines(std::string_view text) { return trimmed(text).starts_with('{'); }

/// A table without a word: a line with the number of values and another number, then a value a line.
constexpr Known kCentroid{
    "", "a Centroid compensation table of a ball screw: values added by a control, not measured errors", true};

bool is_centroid_table(std::string_view text) {
  constexpr long kLeast = 3;
  const auto lines = lines_of(trimmed(text));
  const auto head = lines.empty() ? std::vector<std::string_view>{} : blank_words(lines.front());
  const auto count = head.size() == 2 && integer_in(head[1]) ? integer_in(head[0]) : std::nullopt;
  return count && *count >= kLeast && lines.size() == static_cast<std::size_t>(*count) + 1 &&
         std::all_of(lines.begin() + 1, lines.end(), [](std::string_view line) { return integer_in(trimmed(line)); });
}

/// What a file is, and where it says so.
struct Recognised {
  const Known* known = nullptr;
  std::size_t at = 0;  ///< in the text
};

/// Nothing if no mark is in the text.
std::optional<Recognised> recognised_in(std::string_view text) {
  const std::string head = lower(text.substr(0, kExplainedBytes));
  for (const Known& known : kKnown)
    if (const std::size_t at = head.find(known.mark); at != std::string::npos) return Recognised{&known, at};
  if (is_centroid_table(text)) return Recognised{&kCentroid, 0};
  return std::nullopt;
}

/// Line and column of a place in a text, from 1.
std::pair<int, int> place_of(std::string_view text, std::size_t at) {
  const auto lines = lines_of(text.substr(0, at));
  const bool begins = at == 0 || text[at - 1] == '\n' || text[at - 1] == '\r';
  const int above = static_cast<int>(lines.size()) - (begins ? 0 : 1);
  return {above + 1, begins ? 1 : static_cast<int>(lines.back().size()) + 1};
}

std::string_view delimiter_name(char delimiter) {
  switch (delimiter) {
    case ';':
      return "semicolons";
    case '\t':
      return "tabs";
    case '|':
      return "bars";
    case ' ':
      return "blanks";
    default:
      return "commas";
  }
}

std::string table_text(const TableShape& shape) {
  std::string text = fmt::format("a table of {} rows and {} columns, separated by {}, in lines {} to {}: {}",
                                 shape.rows, shape.columns, delimiter_name(shape.delimiter), shape.first_row_line,
                                 shape.last_row_line, in_quotes(shape.first_row));
  if (shape.lines_between > 0) text += fmt::format(", with {} other lines between", shape.lines_between);
  if (shape.is_mixed)
    text +=
        fmt::format("; other numbers follow, {} consecutive rows from line {}", shape.stretch_rows, shape.stretch_line);
  if (!shape.headings.empty()) {
    std::vector<std::string> named;
    for (std::size_t i = 0; i < std::min<std::size_t>(shape.headings.size(), 12); ++i)
      named.push_back(fmt::format("{} {}", i + 1, in_quotes(shape.headings[i])));
    text += fmt::format("; headings: {}{}", fmt::join(named, ", "), shape.headings.size() > 12 ? ", ..." : "");
  }
  return text;
}

/// A list of single numbers is no table: what it lacks, or nothing.
std::string list_text(std::string_view text) {
  constexpr int kLeast = 3;
  int count = 0, first = 0;
  const auto lines = lines_of(text);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (!number_or_comma(lines[i])) continue;
    ++count;
    if (first == 0) first = static_cast<int>(i) + 1;
  }
  if (count < kLeast) return {};
  return fmt::format(
      ". {} lines from line {} contain one number each: add the position to each line, then --columns "
      "\"x_mm=1[mm],reading=2[um]\" imports them",
      count, first);
}

}  // namespace

Problem explanation_of(std::string_view text, const std::string& file_name) {
  const auto recognised = recognised_in(text);
  std::string why = "not a known measurement file";
  const std::string advice = recognised && recognised->known->becomes_map ? advice_on(kTableOfControl) : "";
  if (recognised)
    why +=
        fmt::format(": it seems to be {}{}", recognised->known->is, advice.empty() ? "" : fmt::format(" ({})", advice));
  const auto shape = is_json_lines(text) ? std::nullopt : table_shape(text);
  const bool has_table = shape && shape->rows >= 2;
  if (has_table)
    why += fmt::format(". It contains {}. {}", table_text(*shape), column_advice(text, *shape, recognised.has_value()));
  else
    why += ". It contains no table of numbers" + (recognised ? "" : list_text(text));
  if (!has_table && !recognised) why += ". Other files can be read if each line has a target and its error";
  if (!recognised) {
    why += ". Known formats: ";
    std::vector<std::string_view> titles;
    for (const FileFormat* format : file_formats())
      if (format->recognises) titles.push_back(format->title);
    why += fmt::format("{}", fmt::join(titles, ", "));
  }
  auto [line, column] = std::pair{1, 1};
  if (recognised)
    std::tie(line, column) = place_of(text, recognised->at);
  else if (has_table)
    line = shape->first_row_line;
  return {ProblemKind::bad_input, std::move(why), file_name, line, column, {}};
}

}  // namespace ecs::laser
