// Why a file is not read, in words that help: what it seems to be, the table found in it, the options that
// import it. Does not live here: which column is what (suggestion.cpp, guessed_columns.hpp).

#include <algorithm>
#include <array>
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
#include "laser/findings.hpp"
#include "laser/import/columns.hpp"
#include "laser/import/format.hpp"
#include "laser/import/guessed_columns.hpp"
#include "laser/import/import.hpp"
#include "laser/units.hpp"

namespace ecs::laser {
namespace {

constexpr std::size_t kMostNamed = 12;
constexpr std::size_t kLeastTableRows = 2;  ///< of a table

std::string row_options(const SuggestedRows& rows) {
  return (rows.skip > 0 ? fmt::format(" --skip {}", rows.skip) : "") +
         (rows.count > 0 ? fmt::format(" --rows {}", rows.count) : "");
}

std::string suggestion_text(const TableSuggestion& suggestion) {
  const auto given = [](std::string_view option, std::string_view value) {
    return value.empty() ? std::string() : fmt::format(" --{} {}", option, value);
  };
  std::string text = fmt::format("--columns \"{}\"{}{}{}{}{} reads {}", suggestion.columns,
                                 given("values", option_word(suggestion.values)), row_options(suggestion.rows),
                                 given("sense", suggestion.sense), given("axis", suggestion.axis),
                                 given("parked", suggestion.parked), suggestion.reads);
  for (const std::string& sentence : suggestion.assumed) text += ". " + sentence;
  return text + (suggestion.unread.empty() ? "" : ". " + suggestion.unread);
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
    if (const auto suggestion = suggestion_for(columns, shape)) return suggestion_text(*suggestion);
  }
  if (std::ranges::none_of(columns, [](const auto& column) { return column.is_number(); }))
    return "Expected columns with a number in every row, found none: fill the empty cells";
  const std::string obstacle = known ? "" : obstacle_in(columns);
  if (!obstacle.empty()) return obstacle;
  return fmt::format(
      "Expected targets with their errors, found the columns {}. If two of them, N and M, are targets and errors, add "
      "`--columns \"x_mm=N[mm],reading=M[um]\"{}` with their numbers, and `--values actual` if M contains positions",
      columns_named(columns), row_options(rows_of(shape)));
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

std::optional<FoundTable> found_table(std::string_view text) {
  auto shape = is_json_lines(text) ? std::nullopt : table_shape(text);
  if (!shape || shape->rows < kLeastTableRows) return std::nullopt;
  FoundTable found{std::move(*shape), {}, {}};
  if (const auto recognised = recognised_in(text))
    found.seems_to_be = recognised->known->is;
  else
    found.suggestion = suggestion_for(columns_of(text, found.shape), found.shape);
  return found;
}

Problem explanation_of(std::string_view text, const std::string& file_name) {
  const auto recognised = recognised_in(text);
  std::string why = "not a known measurement file";
  const std::string advice = recognised && recognised->known->becomes_map ? advice_on(kTableOfControl) : "";
  if (recognised)
    why +=
        fmt::format(": it seems to be {}{}", recognised->known->is, advice.empty() ? "" : fmt::format(" ({})", advice));
  const auto shape = is_json_lines(text) ? std::nullopt : table_shape(text);
  const bool has_table = shape && shape->rows >= kLeastTableRows;
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
