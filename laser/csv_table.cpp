#include "laser/csv_table.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "base/text.hpp"
#include "laser/units.hpp"

namespace ecs::laser {
namespace {

MetadataEntry metadata_in(std::string_view line) {
  const std::string_view text = trimmed(line.substr(1));
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos) return {"", std::string(text)};
  return {std::string(trimmed(text.substr(0, colon))), std::string(trimmed(text.substr(colon + 1)))};
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
    else if (std::find(columns.begin(), columns.end(), field.text) != columns.end())
      findings.add(line, field.column,
                   fmt::format("header: expected each column once, found {} again", in_quotes(field.text)));
    columns.push_back(field.text);
  }
  for (const std::string_view needed : needed_columns) {
    if (std::find(columns.begin(), columns.end(), needed) != columns.end()) continue;
    const std::string near = nearest_word(needed, columns);
    findings.add(line, 1,
                 fmt::format("header: expected a column {}, found none{}", needed,
                             near.empty() ? "" : fmt::format("; is {} meant to be it?", in_quotes(near))));
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
                   "expected a row of readings, found a line beginning with #: these belong before the header");
    } else if (cut.fields.size() != width) {
      const std::size_t at = std::min(width, cut.fields.size() - 1);
      findings.add(
          line, cut.fields[at].column,
          fmt::format("expected {} fields as in the header, found {}{}", width, cut.fields.size(),
                      cut.fields.size() > width ? " (a decimal comma? write numbers with a decimal point)" : ""));
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

std::optional<std::size_t> place_of(const CsvTable& table, std::string_view column) {
  const auto found = std::find(table.columns.begin(), table.columns.end(), column);
  if (found == table.columns.end()) return std::nullopt;
  return static_cast<std::size_t>(found - table.columns.begin());
}

std::optional<std::string> metadata_value(const std::vector<MetadataEntry>& metadata, std::string_view key) {
  for (const MetadataEntry& entry : metadata)
    if (entry.key == key) return entry.value;
  return std::nullopt;
}

}  // namespace ecs::laser
