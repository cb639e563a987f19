// A table as comma separated text: `# key: value` lines, a header row, rows of fields. Does not live here: what the
// columns mean (measurement_set.cpp, laser/standards/).
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "laser/csv_line.hpp"
#include "laser/findings.hpp"
#include "laser/text_decoding.hpp"

namespace ecs::laser {

/// `# key: value` before the header row; an empty key is a comment without a colon.
struct MetadataEntry {
  std::string key;
  std::string value;
  friend bool operator==(const MetadataEntry&, const MetadataEntry&) = default;
};

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

}  // namespace ecs::laser
