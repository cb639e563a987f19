// Why a file is not read, in words that help: what it seems to be, the table found in it, the command that imports it.
#include <algorithm>
#include <array>
#include <optional>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.hpp"
#include "laser/findings.hpp"
#include "laser/import/column_advice.hpp"
#include "laser/import/import.hpp"
#include "laser/import/registry.hpp"
#include "laser/units.hpp"

namespace ecs::laser {
namespace {

constexpr std::size_t kExplainedBytes = 64 * 1024;

/// Files that engineers meet and that hold no measurement of a linear axis, by a word that only they have.
struct Known {
  std::string_view mark;  ///< lower case
  std::string_view is;
};

constexpr std::array<Known, 24> kKnown{{
    {":start2d",
     "an Aerotech two-axis correction table: what a control adds, not what was measured (`ecs export read` makes a map "
     "of it)"},
    {":start ",
     "an Aerotech correction table: what a control adds, not what was measured (`ecs export read` makes a map of it)"},
    {"$aa_enc_comp",
     "a SINUMERIK encoder error table: what a control adds, not what was measured (`ecs export read` makes a map of "
     "it)"},
    {"$an_cec",
     "a SINUMERIK sag error table: what a control adds, not what was measured (`ecs export read` makes a map of it)"},
    {".com  datum:", "a HEIDENHAIN compensation table: what a control adds, not what was measured"},
    {".com mm", "a HEIDENHAIN compensation table: what a control adds, not what was measured"},
    {"kw.ssfk.",
     "a TwinCAT compensation list: what a control corrects, not readings (`ecs export read` makes a map of it)"},
    {"gridpoints",
     "an Etalon exchange file: an error model, not readings of one axis (`ecs export read` makes a map of it)"},
    {"option record: altaz", "TPOINT pointing data of a telescope: azimuth and altitude, no linear axis"},
    {"pointing data", "a TPOINT pointing model of a telescope: fitted terms, no readings"},
    {"scan procedure description file", "the description of a SIOS scan: its numbers are in the .pos and .dat files"},
    {"motion system test report", "a test report: the readings are in the .dat file beside it"},
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
    {"{\"", "a JSON document: only JSON lines are read, an object with its time (ts, time_s, time) in each line"},
}};

bool is_json_lines(std::string_view text) { return trimmed(text).starts_with('{'); }

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
  std::string text = fmt::format("a table of {} rows and {} columns between {} is in lines {} to {}: {}", shape.rows,
                                 shape.columns, delimiter_name(shape.delimiter), shape.first_row_line,
                                 shape.last_row_line, in_quotes(shape.first_row));
  if (shape.lines_between > 0) text += fmt::format(", with {} other lines between", shape.lines_between);
  if (shape.is_mixed)
    text += fmt::format("; other numbers follow, {} rows from line {} on stand together", shape.stretch_rows,
                        shape.stretch_line);
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
      "; {} lines from line {} on hold one number each: expected the position beside it in each line, then "
      "--columns \"x_mm=1[mm],reading=2[um]\" imports them",
      count, first);
}

}  // namespace

Problem explanation_of(std::string_view text, const std::string& file_name) {
  const auto recognised = recognised_in(text);
  std::string why = "not a measurement file that is known here: ";
  why += recognised ? fmt::format("it seems to be {}", recognised->known->is)
                    : "nothing in it names a format that is known here";
  const auto shape = is_json_lines(text) ? std::nullopt : table_shape(text);
  const bool has_table = shape && shape->rows >= 2;
  if (has_table)
    why += fmt::format("; {}; {}", table_text(*shape), column_advice(text, *shape, recognised.has_value()));
  else
    why += "; no table of numbers was found in it" + list_text(text);
  if (!has_table && !recognised)
    why += "; of other files lines of numbers are read, with a target and its error in each";
  if (!recognised) {
    why += "; looked for: ";
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
