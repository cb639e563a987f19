// Our own CSV form as a format of the registry. The form itself: laser/measurement_set.hpp.
#include <algorithm>
#include <filesystem>

#include "base/text.hpp"
#include "laser/import/format.hpp"
#include "laser/import/import.hpp"
#include "laser/measurement_checks.hpp"
#include "laser/writers/measurement_writer.hpp"

namespace ecs::laser {
namespace {

/// A heading with two of the columns that only this form has.
bool is_csv_heading(std::string_view line) {
  std::string plain = lower(line);
  std::replace_if(
      plain.begin(), plain.end(), [](char c) { return c == ';' || c == '\t' || c == '"' || c == ' '; }, ',');
  int known = 0;
  for (const std::string_view word : split(plain, ','))
    if (word == "axis" || word == "sense" || word == "reading" || word == "approach" || word == "x_mm") ++known;
  return known >= 2;
}

Recognition recognises_csv(const FileStart& file) {
  if (is_csv_heading(file.first_line)) return Recognition::certain;
  const bool is_named_csv = lower(std::filesystem::path(file.file_name).extension().string()) == ".csv";
  return is_named_csv && file.has("axis") && file.has("reading") ? Recognition::likely : Recognition::no;
}

}  // namespace

extern const FileFormat kMeasurementCsv{
    .id = "measurement_csv",
    .title = "measurement CSV",
    .sample = "x_axis.csv",
    .recognises = recognises_csv,
    .read =
        [](std::string_view text, const std::string& file_name, const ImportOptions& options) {
          return options.approach_unknown ? set_with_approach_open(text, file_name)
                                          : parse_measurement_set(text, file_name);
        },
    .written_extensions = {".csv"},
    .write = [](const MeasurementSet& set, const std::string&) -> Result<std::string> { return to_csv(set); },
    .units = ErrorUnits::fixed,
    .places_in_columns = true,
};

}  // namespace ecs::laser
