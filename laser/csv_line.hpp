// One line of comma separated text, cut into fields that know their column, and a field made safe for such a line.
// Does not live here: what the fields mean.
#pragma once

#include <string>
#include <string_view>
#include <vector>

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
/// blanks: a field never spans lines.
[[nodiscard]] std::string csv_field_of(std::string_view text);

}  // namespace ecs::laser
