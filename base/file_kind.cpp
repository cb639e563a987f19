#include "base/file_kind.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <functional>
#include <initializer_list>
#include <map>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/file.hpp"
#include "base/text.hpp"

namespace ecs {
namespace {

constexpr std::size_t kBeginning = 64U << 10;  // bytes that say what a file is

/// How a kind is spoken of. In `command`, {} is the file; empty: what a module advises.
struct KindWords {
  std::string_view name;
  std::string_view one;      ///< with its article
  std::string_view command;  ///< what takes such a file, or what to do with it
};

constexpr std::array<KindWords, 26> kWords{{
    {"measurements", "a measurement", "use `ecs laser show {}`"},
    {"model", "an error model", "use `ecs model diagnose {} DATA`"},
    {"error map", "an error map", "use `ecs map show {}`"},
    {"parameters", "a parameter file", "use `ecs params show {}`"},
    {"machine", "a machine file", "verbs that use one accept it as --machine {}"},
    {"memory of a unit", "the memory of a unit", "use `ecs memory show {}`"},
    {"datum sequence", "a datum sequence", "use `ecs utility datum show {}`"},
    {"state of a unit", "the saved state of a unit", "use `ecs utility status --from {}`"},
    {"part program", "a part program", "ecs-emulator runs it"},
    {"lengths", "a file of lengths", ""},
    {"file", "a file", ""},
    {"circular test", "a circular test", ""},
    {"diagonal test", "a diagonal test", ""},
    {"readings of a surface", "a set of readings along the lines of a surface", ""},
    {"errors of rotary axes", "a table of the errors of rotary axes", "use `ecs volume MAP --rotary {}`"},
    {"recipe", "a recipe of a map", "use `ecs map build {}`"},
    {"measurement plan", "a plan of measurements", "use `ecs laser table {} --before DIR`"},
    {"logbook", "a logbook or another database", ""},
    {"workbook", "a workbook of a spreadsheet program",
     "save the sheet with the numbers as CSV in that program, and give the CSV file"},
    {"archive", "a compressed archive", "unpack it and give the files in it"},
    {"PDF", "a PDF document", "copy its numbers into a text file, or export them as CSV, and give that"},
    {"picture", "a picture", "export the numbers as text or CSV and give that"},
    {"spindle test", "a test of a spindle", ""},
    {"ball bar result", "the result of a ball bar", ""},
    {"gauge blocks", "a file of lengths of gauge blocks", ""},
    {"true errors (emulator)", "a file of the true errors of an emulated machine",
     "use `ecs volume MAP --params PARAMS --errors {}`"},
}};

std::map<std::string, std::string, std::less<>>& advice_of_modules() {
  static std::map<std::string, std::string, std::less<>> advice;
  return advice;
}

const KindWords& words_of(FileKind kind) { return kWords[static_cast<std::size_t>(kind)]; }

/// A line of the text begins with it.
bool has_line(std::string_view text, std::string_view begin) {
  return text.starts_with(begin) || text.find("\n" + std::string(begin)) != std::string_view::npos;
}

FileKind kind_of_binary(std::string_view bytes) {
  const auto has = [&](std::string_view part) { return bytes.find(part) != std::string_view::npos; };
  if (bytes.starts_with("PK\x03\x04"))
    return has("opendocument.spreadsheet") || has("[Content_Types].xml") || has("xl/") ? FileKind::workbook
                                                                                       : FileKind::archive;
  if (bytes.starts_with("\xD0\xCF\x11\xE0")) return FileKind::workbook;
  if (bytes.starts_with("\x1F\x8B") || bytes.starts_with("7z\xBC\xAF") ||
      bytes.starts_with("\xFD"
                        "7zXZ") ||
      bytes.starts_with("BZh"))
    return FileKind::archive;
  if (bytes.starts_with("%PDF-")) return FileKind::pdf;
  if (bytes.starts_with("\x89PNG") || bytes.starts_with("\xFF\xD8\xFF")) return FileKind::picture;
  if (bytes.starts_with("SQLite format 3")) return FileKind::logbook;
  if (bytes.starts_with("ECSDUMP ") || bytes.starts_with("ECSI")) return FileKind::memory;
  return FileKind::other;
}

/// The first line that is neither empty nor a comment, and its number.
std::pair<std::string_view, int> header_in(std::string_view text) {
  int number = 0;
  for (const std::string_view line : lines_of(text)) {
    ++number;
    if (const std::string_view words = trimmed(line); !words.empty() && words.front() != '#') return {words, number};
  }
  return {{}, 0};
}

FileKind kind_of_table(std::string_view text) {
  std::string header = lower(header_in(text).first);
  std::replace_if(
      header.begin(), header.end(), [](char c) { return c == ';' || c == '\t' || c == '"'; }, ',');
  std::vector<std::string_view> columns;
  for (const std::string_view column : split(header, ',')) columns.push_back(trimmed(column));
  const auto has = [&](std::initializer_list<std::string_view> all) {
    return std::all_of(all.begin(), all.end(), [&](std::string_view column) {
      return std::find(columns.begin(), columns.end(), column) != columns.end();
    });
  };
  if (has({"axis", "sense", "reading"})) return FileKind::measurements;
  if (has({"axis", "sense", "value_um"})) return FileKind::map;
  if (has({"angle_deg", "deviation_um"})) return FileKind::circle_test;
  if (has({"diagonal", "deviation_um"})) return FileKind::diagonal_test;
  if (has({"nominal_mm", "measured_mm"})) return FileKind::gauge_blocks;
  if (has({"line", "station_mm", "reading"})) return FileKind::surface;
  if (has({"component", "p_deg", "error"})) return FileKind::rotary_errors;
  const bool over_turns = has({"angle_deg"}) || has({"index"}) || (has({"time_s"}) && has_line(text, "# speed_rpm:"));
  if (over_turns && (has({"x_um"}) || has({"y_um"}) || has({"z_um"}))) return FileKind::spindle_test;
  return FileKind::other;
}

/// Of the XML that a ball bar's program writes, the names that only it has.
bool is_ball_bar(std::string_view text) {
  return trimmed(text).starts_with('<') &&
         (text.find("TEST_PLANE=") != std::string_view::npos || text.find("NAME=\"AF_") != std::string_view::npos);
}

FileKind kind_of_toml(std::string_view text) {
  for (const char* table : {"[[contribution]]", "[squareness]", "[scatter]", "[location]", "[air]", "[spindle]"})
    if (has_line(text, table)) return FileKind::true_errors;  // which has [[effect]] too
  if (has_line(text, "[[effect]]")) return FileKind::model;
  if (has_line(text, "[configuration]")) return FileKind::parameters;
  if (has_line(text, "configuration =") && has_line(text, "[axis.")) return FileKind::machine;
  if (has_line(text, "[[component]]")) return FileKind::recipe;
  if (has_line(text, "[[measure]]")) return FileKind::plan;
  return FileKind::other;
}

/// As one word of a command line.
std::string as_word(const std::string& file) {
  const bool plain = std::all_of(file.begin(), file.end(), [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '/' || c == '.' || c == '_' || c == '-';
  });
  return plain ? file : "'" + file + "'";
}

}  // namespace

std::optional<const char*> utf16_order(std::string_view bytes) {
  constexpr std::size_t kLooked = 64;
  if (bytes.starts_with("\xFF\xFE")) return "UTF-16LE";
  if (bytes.starts_with("\xFE\xFF")) return "UTF-16BE";
  if (bytes.size() < 4) return std::nullopt;
  std::size_t zeros[2] = {0, 0};
  const std::size_t looked = std::min(bytes.size() & ~std::size_t{1}, kLooked);
  for (std::size_t i = 0; i < looked; ++i)
    if (bytes[i] == '\0') ++zeros[i % 2];
  if (zeros[1] == looked / 2 && zeros[0] == 0) return "UTF-16LE";
  if (zeros[0] == looked / 2 && zeros[1] == 0) return "UTF-16BE";
  return std::nullopt;
}

std::optional<Problem> why_no_text(std::string_view bytes, const std::string& file_name) {
  if (utf16_order(bytes))
    return Problem{ProblemKind::bad_input, "this is UTF-16: save it as UTF-8", file_name, 0, 0, {}};
  const std::size_t at = bytes.find('\0');
  if (at == std::string_view::npos) return std::nullopt;
  const std::string_view before = bytes.substr(0, at);
  const std::size_t line_start = before.rfind('\n') + 1;  // npos + 1 is the beginning
  return Problem{ProblemKind::bad_input,
                 "a NUL byte (0): expected text; the file is damaged, or not of this kind",
                 file_name,
                 static_cast<int>(std::count(before.begin(), before.end(), '\n')) + 1,
                 static_cast<int>(at - line_start) + 1,
                 {}};
}

std::string_view name_of(FileKind kind) { return words_of(kind).name; }

void advise(std::string_view matter, std::string_view words) {
  advice_of_modules().insert_or_assign(std::string(matter), words);
}

std::string advice_on(std::string_view matter) {
  const auto found = advice_of_modules().find(matter);
  return found == advice_of_modules().end() ? std::string() : found->second;
}

FileKind kind_of_content(std::string_view beginning) {
  std::string_view text = beginning.substr(0, kBeginning);
  if (const FileKind binary = kind_of_binary(text); binary != FileKind::other) return binary;
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  if (is_ball_bar(text)) return FileKind::ball_bar;
  if (const FileKind table = kind_of_table(text); table != FileKind::other) return table;
  if (text.starts_with("{") && text.find("\"ecs_status\"") != std::string_view::npos) return FileKind::status;
  if (has_line(text, "# sample_period_us:") && has_line(text, "# um_per_count:")) return FileKind::datum_record;
  if (has_line(text, "# set_up: ") && has_line(text, "# tool: ")) return FileKind::lengths;
  return kind_of_toml(text);
}

std::optional<Problem> wrong_kind(FileKind wanted, std::string_view content, const std::string& file) {
  const FileKind found = kind_of_content(content);
  if (found == wanted || found == FileKind::other) return std::nullopt;
  if (wanted == FileKind::map && found == FileKind::rotary_errors) return std::nullopt;  // the reader of maps says more
  const bool swapped = wanted == FileKind::model && found == FileKind::measurements;
  const bool is_table = found == FileKind::map || found == FileKind::measurements || found == FileKind::circle_test ||
                        found == FileKind::diagonal_test || found == FileKind::gauge_blocks ||
                        found == FileKind::surface || found == FileKind::spindle_test ||
                        found == FileKind::rotary_errors;
  const int line = is_table ? header_in(content.substr(0, kBeginning)).second : 0;
  const KindWords& words = words_of(found);
  std::string advice = swapped                 ? "give MODEL first, then DATA"
                       : words.command.empty() ? advice_on(words.name)
                                               : std::string(words.command);
  if (!advice.empty()) advice = ": " + fmt::format(fmt::runtime(advice), as_word(file));
  return Problem{ProblemKind::bad_input,
                 wanted == FileKind::other
                     ? fmt::format("this is {}{}", words.one, advice)
                     : fmt::format("this is {}, not {}{}", words.one, words_of(wanted).one, advice),
                 file,
                 line,
                 line > 0 ? 1 : 0,
                 {}};
}

Result<std::string> read_file_of(FileKind wanted, const std::filesystem::path& path) {
  auto content = read_file(path);
  if (content)
    if (auto wrong = wrong_kind(wanted, *content, path.string())) return tl::unexpected(std::move(*wrong));
  return content;
}

}  // namespace ecs
