// Renishaw error compensation tables: combined values by position, as readings of one axis.
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "base/text.hpp"
#include "base/units.hpp"
#include "laser/findings.hpp"
#include "laser/import/format.hpp"
#include "laser/import/readers.hpp"
#include "laser/import/renishaw_file.hpp"
#include "laser/writers/table_writers.hpp"

namespace ecs::laser {
namespace {

/// "Compensation end 200.000", with a colon, an equals sign or blanks before the number.
std::optional<MetadataEntry> compensation_entry(std::string_view line) {
  const std::string plain = lower(trimmed(line));
  for (const std::string_view name : {"Compensation start", "Compensation end", "Compensation spacing"}) {
    const std::size_t at = plain.find(lower(name));
    if (at == std::string::npos) continue;
    const auto numbers = numbers_of(std::string_view(plain).substr(at + name.size()));
    return MetadataEntry{std::string(name), numbers.empty() ? "" : shortest(numbers.front())};
  }
  return std::nullopt;
}

/// The rows must be those that the head announces.
void check_announced(const MeasurementSet& set, Findings& findings) {
  const auto announced = [&](std::string_view key) {
    const auto text = metadata_value(set, key);
    return text ? number_in(*text) : std::nullopt;
  };
  constexpr double kSamePosition_mm = 1e-3;
  const auto start = announced("Compensation start"), end = announced("Compensation end");
  const double first = target_mm(set.readings.front()), last = target_mm(set.readings.back());
  const bool reversed =
      start && end && std::abs(first - *end) < kSamePosition_mm && std::abs(last - *start) < kSamePosition_mm;
  if (reversed) return;
  if (start && std::abs(first - *start) > kSamePosition_mm)
    findings.add(set.readings.front().line, 1,
                 fmt::format("expected the first position at {} (Compensation start), found {}", *start, first));
  if (end && std::abs(last - *end) > kSamePosition_mm)
    findings.add(set.readings.back().line, 1,
                 fmt::format("expected the last position at {} (Compensation end), found {}: the file is cut short; "
                             "--accept-truncated reads the rest",
                             *end, last));
}

bool is_table_heading(std::string_view line) {
  const std::string plain = lower(line);
  return plain.find("axis position") != std::string::npos && plain.find("combined") != std::string::npos;
}

/// Rows number, position, combined value in mm.
Result<MeasurementSet> read_table(std::string_view text, const std::string& file_name, const ImportOptions& options) {
  ECS_TRY(line, positioning_line(options, file_name));
  MeasurementSet set;
  set.source = file_name;
  Findings findings(file_name);
  bool in_table = false;
  const auto lines = lines_of(text);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const int number = static_cast<int>(i) + 1;
    const std::size_t colon = lines[i].find(':');
    if (is_table_heading(lines[i])) {
      in_table = true;
    } else if (in_table && !trimmed(lines[i]).empty()) {
      const auto row = row_of(lines[i], 3);
      if (row)
        set.readings.push_back(reading_at(options, line, (*row)[1],
                                          (options.table_holds_errors ? 1.0 : -1.0) * (*row)[2] * kUmPerMm, number));
      else
        findings.add(number, 1, "expected number, position and combined value, found " + in_quotes(trimmed(lines[i])));
    } else if (const auto entry = compensation_entry(lines[i]); !in_table && entry) {
      set.metadata.push_back(*entry);
    } else if (!in_table && colon != std::string_view::npos) {
      set.metadata.push_back(
          {std::string(trimmed(lines[i].substr(0, colon))), std::string(trimmed(lines[i].substr(colon + 1)))});
    }
  }
  if (findings.empty() && set.readings.empty()) findings.add(0, 0, "expected rows below the heading, found none");
  if (findings.empty() && !options.accept_truncated) check_announced(set, findings);
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  set.notes.push_back(options.table_holds_errors ? "combined values taken as errors in mm"
                                                 : "combined values taken as compensation in mm: error = -value");
  number_rows(set);
  return set;
}

Recognition recognises_table(const FileStart& file) {
  return file.has("axis position") && file.has("combined") ? Recognition::certain : Recognition::no;
}

}  // namespace

extern const FileFormat kRenishawTable{
    .id = "renishaw_table",
    .title = "Renishaw error compensation table (.REN)",
    .sample = "table.REN",
    .recognises = recognises_table,
    .read = read_table,
    .written_extensions = {".ren"},
    .write = [](const MeasurementSet& set, const std::string&) { return to_renishaw_table(set); },
};

}  // namespace ecs::laser
