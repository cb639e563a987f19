// Hole positions of a drilled plate from a coordinate measuring machine (SDSS plug plates).
#include <cmath>

#include <fmt/format.h>

#include "base/text.hpp"
#include "base/units.hpp"
#include "laser/findings.hpp"
#include "laser/import/format.hpp"
#include "laser/import/readers.hpp"

namespace ecs::laser {
namespace {

constexpr std::size_t kColumns = 9;  ///< measured X Y, nominal X Y, error X Y, measured and nominal diameter, roundness
constexpr double kPrinted_mm = 0.0016;  ///< three numbers rounded to 1 um each

Reading reading_of(const std::vector<double>& row, Axis axis, double parked_z_mm, int line) {
  const std::size_t i = index_of(axis);
  Reading reading;
  reading.line = line;
  reading.axis = axis;
  reading.sense = static_cast<Sense>(i);
  reading.position_mm = {row[2], row[3], parked_z_mm};
  reading.error = row[4 + i] * kUmPerMm;
  reading.extras = {{"diameter_mm", row[6]}, {"nominal_diameter_mm", row[7]}, {"roundness_mm", row[8]}};
  return reading;
}

/// Nominal place and error in X and Y, mm. Two readings for each hole, approach unknown.
Result<MeasurementSet> read_plate(std::string_view text, const std::string& file_name, const ImportOptions& options) {
  MeasurementSet set;
  set.source = file_name;
  Findings findings(file_name);
  bool in_table = false;
  int differing = 0;
  for (const auto& [number, as_written] : numbered_lines_of(text)) {
    const std::string_view line = trimmed(as_written);
    if (line.empty()) continue;
    if (!in_table && lower(line).find("nom x") != std::string::npos) {
      in_table = true;
    } else if (const auto entry = entry_in(line); !in_table && entry) {
      set.metadata.push_back(*entry);
    } else if (in_table) {
      const auto row = numbers_alone(line);
      if (row.size() != kColumns) {
        findings.add(number, 1, "expected nine numbers as in the heading, found {}", in_quotes(line));
        continue;
      }
      if (std::abs(row[0] - row[2] - row[4]) > kPrinted_mm || std::abs(row[1] - row[3] - row[5]) > kPrinted_mm)
        ++differing;
      for (const Axis axis : {Axis::X, Axis::Y})
        set.readings.push_back(reading_of(row, axis, options.parked_mm[index_of(Axis::Z)], number));
    }
  }
  if (findings.empty() && set.readings.empty()) findings.add(0, 0, "expected holes below the heading, found none");
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  set.notes.push_back(
      "each hole gives its X deviation as EX and its Y deviation as EY at its nominal position; approach unknown");
  set.notes.push_back("the errors include shift and rotation of the plate on the measuring machine");
  if (differing > 0)
    set.notes.push_back(
        fmt::format("in {} rows the error is not measured minus nominal; the error column is used", differing));
  number_rows(set);
  return set;
}

Recognition recognises_plate(const FileStart& file) {
  return file.has("meas x") && file.has("nom x") && file.has("err x") ? Recognition::certain : Recognition::no;
}

}  // namespace

extern const FileFormat kPlate{
    .id = "plate",
    .title = "hole positions of a plate",
    .sample = "plate.txt",
    .recognises = recognises_plate,
    .read = read_plate,
    .states_place = {true, true, false},
};

}  // namespace ecs::laser
