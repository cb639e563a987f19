// A table as comma separated text: `# key: value` lines, a header row, rows of fields that know their column; a field
// made safe for such a row. Does not live here: what the columns mean (measurement_set.cpp, laser/standards/).
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "laser/findings.hpp"
#include "laser/text_decoding.hpp"

namespace ecs::laser {

struct CsvField {
  std::string text;     ///< without the quotes and, where unquoted, without blanks around it
  int column = 1;       ///< 1-based character column of its first character
  bool quoted = false;  ///< stood in double quotes
};

struct CsvLine {
  std::vector<CsvField> fields;
  std::string fault;     ///< empty: none; else what was expected and found
  int fault_column = 0;  ///< 1-based, if there is a fault
};

/// Fields between separators; double quotes protect separators and blanks, "" inside them is one quote. Blanks round a
/// field are dropped. A quote that is never closed, or text after a closing quote, is a fault.
[[nodiscard]] CsvLine csv_fields(std::string_view line, char separator = ',');

/// `text` as one field: in quotes where it holds a comma, a quote, a '#' in front or blanks at an end. Line ends become
/// blanks: a field never spans lines. Behind an apostrophe, which csv_fields takes off again, where a spreadsheet would
/// take it for a formula.
[[nodiscard]] std::string csv_field_of(std::string_view text);

/// `# key: value` before the header row; an empty key is a comment without a colon.
struct MetadataEntry {
  std::string key;
  std::string value;
  friend bool operator==(const MetadataEntry&, const MetadataEntry&) = default;
};

/// `key: value`; nothing for a line without a colon.
[[nodiscard]] std::optional<MetadataEntry> entry_in(std::string_view line);

struct CsvRow {
  int line = 0;                  ///< of the file, from 1
  std::vector<CsvField> fields;  ///< as many as columns
};

struct CsvTable {
  std::vector<MetadataEntry> metadata;  ///< in file order
  std::vector<std::string> columns;     ///< each once
  int header_line = 0;
  char separator = ',';  ///< a comma, a semicolon or a tab; without commas "1,5" has become 1.5
  Encoding encoding = Encoding::utf8;
  std::vector<CsvRow> rows;  ///< those of the right length
};

/// @param needed  columns without which the table is refused
/// @param findings  takes the faults of single rows; the caller adds its own and refuses the file
/// Problems: no UTF-8 or known code page, no header, a column doubled or missing.
[[nodiscard]] Result<CsvTable> parse_csv_table(std::string_view text, const std::string& file_name,
                                               std::span<const std::string_view> needed, Findings& findings);

/// Position of a column; nothing if the table has none of that name.
[[nodiscard]] std::optional<std::size_t> place_of(const CsvTable& table, std::string_view column);

/// The first entry of that key (exact spelling); nothing if there is none.
[[nodiscard]] std::optional<std::string> metadata_value(const std::vector<MetadataEntry>& metadata,
                                                        std::string_view key);

/// What a table says, cell by cell and key by key, for the readers of files: what is wrong becomes a finding
/// `name: expected …, found "…"` at its place.
class TableReader {
 public:
  TableReader(const CsvTable& table, Findings& findings) : table_(table), findings_(findings) {}

  /// The row that the calls below are about.
  void take(const CsvRow& row) { row_ = &row; }
  [[nodiscard]] int line() const { return row_->line; }
  [[nodiscard]] bool has(std::string_view column) const { return place_of(table_, column).has_value(); }
  /// @pre has(column)
  [[nodiscard]] const std::string& text(std::string_view column) const { return cell(column).text; }
  /// A number within ±`most`; nothing, with a finding, where the cell holds none.
  [[nodiscard]] std::optional<double> number(std::string_view column, double most = kAnyNumber);
  void wrong(std::string_view column, std::string_view expected);
  /// A whole message about a cell.
  void refuse(std::string_view column, std::string message) {
    findings_.add(row_->line, cell(column).column, std::move(message));
  }

  /// Of `# key: value`; nothing where there is no such key.
  [[nodiscard]] std::optional<std::string> stated(std::string_view key) const {
    return metadata_value(table_.metadata, key);
  }
  [[nodiscard]] std::optional<double> stated_number(std::string_view key);
  /// One of two words; `usual` where there is no such key, or another word, which is a finding.
  [[nodiscard]] std::string stated_word(std::string_view key, std::string_view first, std::string_view second,
                                        std::string_view usual);

 private:
  static constexpr double kAnyNumber = std::numeric_limits<double>::infinity();
  [[nodiscard]] const CsvField& cell(std::string_view column) const { return row_->fields[*place_of(table_, column)]; }

  const CsvTable& table_;
  Findings& findings_;
  const CsvRow* row_ = nullptr;
};

}  // namespace ecs::laser
