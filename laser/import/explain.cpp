// Why a file is not read, in words that help: what it seems to be, the table found in it, the command that imports it.
#include <algorithm>
#include <array>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.hpp"
#include "laser/findings.hpp"
#include "laser/import/import.hpp"
#include "laser/import/registry.hpp"

namespace ecs::laser {
namespace {

constexpr std::size_t kExplainedBytes = 64 * 1024;

/// Files that engineers meet and that hold no measurement of a linear axis, by a word that only they have.
struct Known {
  std::string_view mark;  ///< lower case
  std::string_view is;
};

constexpr std::array<Known, 24> kKnown{{
    {":start2d", "an Aerotech two-axis correction table: what a control adds, not what was measured"},
    {":start ", "an Aerotech correction table: what a control adds, not what was measured"},
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
    {"{\"ts\":", "JSON lines of a probe: convert ts, z and the temperatures to a CSV first"},
    {"artefact.ball_spacing", "a simulated ball bar or step gauge on a measuring machine (MSL): points and deviations"},
    {"cmm_model.", "the parameters of a measuring machine's error model: no readings"},
    {"target pos (", "telemetry of servo drives in encoder counts: no unit of length is in it"},
    {"roundness deviation", "the Lissajous figure of an interferometer: radius over phase, no positions"},
    {"sample temperature", "an environment table: no readings of an axis are in it"},
    {"refractive", "a table about the refractive index: no readings of an axis are in it"},
    {"vacuum_wavelength_nm", "a table of the refractive index of air: no readings of an axis are in it"},
    {"# source", "a description"},
    {"<html", "a web page"},
    {"{\"", "JSON: convert it to a CSV first"},
}};

bool is_json_lines(std::string_view text) { return trimmed(text).starts_with('{'); }

/// What the file is, if it is known by a mark.
std::optional<std::string_view> known_as(std::string_view text) {
  const std::string head = lower(text.substr(0, kExplainedBytes));
  for (const Known& known : kKnown)
    if (head.find(known.mark) != std::string::npos) return known.is;
  return std::nullopt;
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
  std::string text =
      fmt::format("a table of {} rows and {} columns between {} begins in line {}: {}", shape.rows, shape.columns,
                  delimiter_name(shape.delimiter), shape.first_row_line, in_quotes(shape.first_row));
  if (!shape.headings.empty()) {
    std::vector<std::string> named;
    for (std::size_t i = 0; i < std::min<std::size_t>(shape.headings.size(), 12); ++i)
      named.push_back(fmt::format("{} {}", i + 1, in_quotes(shape.headings[i])));
    text += fmt::format("; headings: {}{}", fmt::join(named, ", "), shape.headings.size() > 12 ? ", ..." : "");
  }
  return text;
}

std::string advice(const TableShape& shape) {
  const int skip = shape.first_row_line - 1;
  return fmt::format(
      "if it holds measurements, say which column is what: --columns \"x_mm=1[mm],reading=2[um],approach=motion\"{} "
      "(docs/formats.md)",
      skip > 0 ? fmt::format(" --skip {}", skip) : "");
}

}  // namespace

std::string explanation_of(std::string_view text) {
  const auto known = known_as(text);
  std::string why = "not a measurement file that is known here: ";
  why += known ? fmt::format("it seems to be {}", *known) : "nothing in it names a format that is known here";
  const auto shape = is_json_lines(text) ? std::nullopt : table_shape(text);
  if (shape && shape->rows >= 2)
    why += fmt::format("; {}; {}", table_text(*shape), advice(*shape));
  else
    why += "; no table of numbers was found in it";
  if (known) return why;
  why += "; looked for: ";
  std::vector<std::string_view> titles;
  for (const FileFormat* format : file_formats())
    if (format->recognises) titles.push_back(format->title);
  why += fmt::format("{}", fmt::join(titles, ", "));
  return why;
}

}  // namespace ecs::laser
