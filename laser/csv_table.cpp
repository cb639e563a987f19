#include "laser/csv_table.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <fmt/format.h>

#include "base/text.hpp"
#include "laser/units.hpp"

namespace ecs::laser {
namespace {

/// Whether a spreadsheet could take it for a formula, or it is such a text behind apostrophes.
bool is_guarded(std::string_view text) {
  const auto first = text.find_first_not_of('\'');
  return first != std::string_view::npos && std::string_view("=+-@").find(text[first]) != std::string_view::npos;
}

bool is_blank(char c) { return c == ' ' || c == '\t'; }

/// Walks the line and counts characters (UTF-8 continuation bytes are no characters).
class Cursor {
 public:
  explicit Cursor(std::string_view line) : line_(line) {}
  [[nodiscard]] bool at_end() const { return place_ == line_.size(); }
  [[nodiscard]] char here() const { return line_[place_]; }
  [[nodiscard]] int column() const { return column_; }
  char take() {
    const char c = line_[place_++];
    if (at_end() || (static_cast<unsigned char>(line_[place_]) & 0xC0u) != 0x80u) ++column_;
    return c;
  }
  void skip_blanks(char separator) {
    while (!at_end() && is_blank(here()) && here() != separator) take();
  }

 private:
  std::string_view line_;
  std::size_t place_ = 0;
  int column_ = 1;
};

/// After the opening quote up to and with the closing one; false: never closed.
bool take_quoted(Cursor& cursor, std::string& text) {
  while (!cursor.at_end()) {
    const char c = cursor.take();
    if (c != '"') {
      text += c;
    } else if (!cursor.at_end() && cursor.here() == '"') {
      text += cursor.take();
    } else {
      return true;
    }
  }
  return false;
}

}  // namespace

CsvLine csv_fields(std::string_view text, char separator) {
  CsvLine line;
  Cursor cursor(text);
  for (;;) {
    cursor.skip_blanks(separator);
    CsvField field{{}, cursor.column(), false};
    if (!cursor.at_end() && cursor.here() == '"') {
      field.quoted = true;
      cursor.take();
      if (!take_quoted(cursor, field.text)) {
        line.fault = "expected a closing double quote before the end of the line, found none";
        line.fault_column = field.column;
        return line;
      }
      cursor.skip_blanks(separator);
      if (!cursor.at_end() && cursor.here() != separator) {
        line.fault = "expected a separator after the closing double quote, found other text";
        line.fault_column = cursor.column();
        return line;
      }
    } else {
      while (!cursor.at_end() && cursor.here() != separator) field.text += cursor.take();
      field.text = std::string(trimmed(field.text));
    }
    if (field.text.starts_with('\'') && is_guarded(field.text)) field.text.erase(0, 1);
    line.fields.push_back(std::move(field));
    if (cursor.at_end()) return line;
    cursor.take();
  }
}

std::string csv_field_of(std::string_view raw) {
  std::string text = (is_guarded(raw) && !number_in(raw) ? "'" : "") + shown_line(raw);
  const bool plain =
      text.find_first_of(",\"") == std::string::npos && trimmed(text).size() == text.size() && !text.starts_with('#');
  if (plain) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

namespace {

MetadataEntry metadata_in(std::string_view line) {
  const std::string_view text = trimmed(line.substr(1));
  return entry_in(text).value_or(MetadataEntry{"", std::string(text)});
}

/// Of the header row: a comma where it has one, else a semicolon or a tab.
char separator_of(std::string_view header) {
  for (const char separator : {',', ';', '\t'})
    if (header.find(separator) != std::string_view::npos) return separator;
  return ',';
}

/// The fields of a line. Where commas do not separate, "1,5" is the number 1.5.
CsvLine fields_of(std::string_view text, char separator) {
  CsvLine line = csv_fields(text, separator);
  if (separator == ',') return line;
  for (CsvField& field : line.fields)
    if (const auto number = number_or_comma(field.text); number && !number_in(field.text))
      field.text = shortest(*number);
  return line;
}

std::vector<std::string> columns_in(const CsvLine& header, int line, std::span<const std::string_view> needed_columns,
                                    Findings& findings) {
  std::vector<std::string> columns;
  for (const CsvField& field : header.fields) {
    if (field.text.empty())
      findings.add(line, field.column, "header: expected a column name, found nothing");
    else if (std::ranges::find(columns, field.text) != columns.end())
      findings.add(line, field.column, "header: expected each column once, found {} again", in_quotes(field.text));
    columns.push_back(field.text);
  }
  for (const std::string_view needed : needed_columns) {
    if (std::ranges::find(columns, needed) != columns.end()) continue;
    const std::string near = nearest_word(needed, columns);
    findings.add(line, 1, "header: expected a column {}{}, found none{}", needed,
                 needed == "axis" ? " (or read a table by --columns \"x_mm=x_mm,reading=reading[um]\")" : "",
                 near.empty() ? "" : fmt::format("; is {} meant?", in_quotes(near)));
  }
  return columns;
}

/// Rows of the right length; the others become findings.
std::vector<CsvRow> rows_in(const std::vector<std::string_view>& lines, std::size_t first, std::size_t width,
                            char separator, Findings& findings) {
  std::vector<CsvRow> rows;
  for (std::size_t i = first; i < lines.size(); ++i) {
    if (trimmed(lines[i]).empty()) continue;
    const int line = static_cast<int>(i) + 1;
    CsvLine cut = fields_of(lines[i], separator);
    if (!cut.fault.empty()) {
      findings.add(line, cut.fault_column, cut.fault);
    } else if (trimmed(lines[i]).starts_with('#')) {
      findings.add(line, 1,
                   "expected a row of readings, found a line beginning with #: such lines belong before the header");
    } else if (cut.fields.size() != width) {
      const std::size_t at = std::min(width, cut.fields.size() - 1);
      const bool is_last = std::all_of(lines.begin() + static_cast<std::ptrdiff_t>(i) + 1, lines.end(),
                                       [](std::string_view rest) { return trimmed(rest).empty(); });
      findings.add(line, cut.fields[at].column, "expected {} fields as in the header, found {}{}", width,
                   cut.fields.size(),
                   cut.fields.size() > width ? " (a decimal comma? write numbers with a decimal point)"
                   : is_last                 ? " in the last line: the file seems to be truncated, copy it again"
                                             : "");
    } else {
      rows.push_back({line, std::move(cut.fields)});
    }
  }
  return rows;
}

}  // namespace

Result<CsvTable> parse_csv_table(std::string_view text, const std::string& file_name,
                                 std::span<const std::string_view> needed, Findings& findings) {
  ECS_TRY(whole, decoded(text, file_name));
  const auto lines = lines_of(whole.text);
  CsvTable table;
  table.encoding = whole.encoding;
  std::size_t next = 0;
  for (; next < lines.size(); ++next) {
    const std::string_view line = trimmed(lines[next]);
    if (!line.empty() && !line.starts_with('#')) break;
    if (!line.empty()) table.metadata.push_back(metadata_in(line));
  }
  if (next == lines.size())
    return problem_at(file_name, 0, 0, "expected a header row and readings, found only comments");
  table.header_line = static_cast<int>(next) + 1;
  table.separator = separator_of(lines[next]);
  const CsvLine header = csv_fields(lines[next], table.separator);
  if (!header.fault.empty()) return problem_at(file_name, table.header_line, header.fault_column, header.fault);
  Findings of_header(file_name);
  table.columns = columns_in(header, table.header_line, needed, of_header);
  if (!of_header.empty()) return tl::unexpected(of_header.as_problem());
  table.rows = rows_in(lines, next + 1, table.columns.size(), table.separator, findings);
  return table;
}

std::optional<MetadataEntry> entry_in(std::string_view line) {
  const std::size_t colon = line.find(':');
  if (colon == line.npos) return std::nullopt;
  return MetadataEntry{std::string(trimmed(line.substr(0, colon))), std::string(trimmed(line.substr(colon + 1)))};
}

std::optional<std::size_t> place_of(const CsvTable& table, std::string_view column) {
  const auto found = std::ranges::find(table.columns, column);
  if (found == table.columns.end()) return std::nullopt;
  return static_cast<std::size_t>(found - table.columns.begin());
}

std::optional<std::string> metadata_value(const std::vector<MetadataEntry>& metadata, std::string_view key) {
  for (const MetadataEntry& entry : metadata)
    if (entry.key == key) return entry.value;
  return std::nullopt;
}

std::optional<double> TableReader::number(std::string_view column, double most) {
  const auto value = number_in(text(column));
  if (value && std::abs(*value) <= most) return value;
  wrong(column, value ? fmt::format("a number within {:g}", most) : "a number");
  return std::nullopt;
}

void TableReader::wrong(std::string_view column, std::string_view expected) {
  refuse(column, fmt::format("{}: expected {}, found {}", column, expected, in_quotes(text(column))));
}

std::optional<double> TableReader::stated_number(std::string_view key) {
  const auto given = stated(key);
  if (!given) return std::nullopt;
  const auto value = number_in(*given);
  if (!value) findings_.add(0, 0, "{}: expected a number, found {}", key, in_quotes(*given));
  return value;
}

std::string TableReader::stated_word(std::string_view key, std::string_view first, std::string_view second,
                                     std::string_view usual) {
  const auto given = stated(key);
  if (given && (*given == first || *given == second)) return *given;
  if (given) findings_.add(0, 0, "{}: expected {} or {}, found {}", key, first, second, in_quotes(*given));
  return std::string(usual);
}

}  // namespace ecs::laser
