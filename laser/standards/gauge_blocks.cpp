#include "laser/standards/gauge_blocks.hpp"

#include <array>
#include <cmath>

#include "base/text.hpp"
#include "base/units.hpp"
#include "laser/findings.hpp"

namespace ecs::laser {
namespace {

constexpr std::array<std::string_view, 2> kBlockColumns{"nominal_mm", "measured_mm"};
constexpr double kLongestBlock_mm = 1e5;       ///< a choice
constexpr double kLargestDifference_mm = 1.0;  ///< more is a typing error or another block
constexpr double kMostDegrees = 100.0;         ///< a choice
constexpr double kMostExpansion = 100.0;       ///< um/m/degC, above all metals

/// A number from 0 to `most`; nothing, with a finding, beyond.
std::optional<double> stated_size(TableReader& table, std::string_view key, double most, Findings& findings) {
  const auto value = table.stated_number(key);
  if (!value || (*value >= 0.0 && *value <= most)) return value;
  findings.add(0, 0, "{}: expected a number from 0 to {:g}, found {:g}", key, most, *value);
  return std::nullopt;
}

void take_block_head(TableReader& table, BlockTest& test, Findings& findings) {
  const std::string axis = table.stated("axis").value_or("");
  const auto letter = axis.size() == 1 ? axis_of(axis.front()) : std::nullopt;
  if (letter)
    test.axis = *letter;
  else
    findings.add(0, 0, "expected `# axis: ` with X, Y or Z, found {}", in_quotes(axis));
  test.cut = table.stated_word("lengths", "measured", "cut", "measured") == "cut";
  test.block_expansion_um_per_m_degC =
      stated_size(table, "block_expansion", kMostExpansion, findings).value_or(test.block_expansion_um_per_m_degC);
  test.machine_expansion_um_per_m_degC = stated_size(table, "machine_expansion", kMostExpansion, findings);
  test.resolution_um = stated_size(table, "resolution_um", kUmPerMm, findings).value_or(0.0);
  test.common_U_um_per_m = stated_size(table, "common_U_um_per_m", kUmPerMm, findings).value_or(0.0);
}

/// Of a column that may be absent, and of a cell that may be empty.
std::optional<double> optional_number(TableReader& row, std::string_view column, double most) {
  if (!row.has(column) || row.text(column).empty()) return std::nullopt;
  return row.number(column, most);
}

BlockReading block_reading(TableReader& row) {
  BlockReading reading;
  reading.line = row.line();
  reading.nominal_mm = row.number("nominal_mm", kLongestBlock_mm).value_or(1.0);
  reading.measured_mm = row.number("measured_mm", kLongestBlock_mm + 1.0).value_or(reading.nominal_mm);
  if (reading.nominal_mm <= 0.0) row.wrong("nominal_mm", "a length above 0");
  if (std::abs(reading.measured_mm - reading.nominal_mm) >= kLargestDifference_mm)
    row.wrong("measured_mm", "a length within 1 mm of the nominal one");
  reading.block = row.has("block") ? row.text("block") : shortest(reading.nominal_mm);
  if (row.has("touch")) {
    const std::string& word = row.text("touch");
    bool known = false;
    for (const Touch touch : {Touch::outside, Touch::inside, Touch::step})
      if (word == name_of(touch)) {
        reading.touch = touch;
        known = true;
      }
    if (!known) row.wrong("touch", "outside, inside or step");
  }
  reading.U_um = optional_number(row, "U_um", kUmPerMm).value_or(0.0);
  if (reading.U_um < 0.0) row.wrong("U_um", "an expanded uncertainty, 0 or more");
  reading.block_degC = optional_number(row, "t_block_degC", kMostDegrees);
  reading.machine_degC = optional_number(row, "t_machine_degC", kMostDegrees);
  reading.from_mm = optional_number(row, "from_mm", kLongestBlock_mm);
  return reading;
}

}  // namespace

double error_um_of(const BlockTest& test, const BlockReading& reading) {
  const double excess_um = (reading.measured_mm - reading.nominal_mm) * kUmPerMm;
  const double length_m = reading.nominal_mm / kMmPerM;
  const auto growth_um = [&](const std::optional<double>& degC, double expansion) {
    return degC ? expansion * (*degC - kBlockReference_degC) * length_m : 0.0;
  };
  return (test.cut ? excess_um : -excess_um) + growth_um(reading.block_degC, test.block_expansion_um_per_m_degC) -
         growth_um(reading.machine_degC, test.machine_expansion_um_per_m_degC.value_or(0.0));
}

Result<BlockTest> parse_gauge_blocks(std::string_view text, const std::string& file_name) {
  Findings findings(file_name);
  ECS_TRY(table, parse_csv_table(text, file_name, kBlockColumns, findings));
  BlockTest test;
  test.source = file_name;
  test.metadata = table.metadata;
  TableReader reader(table, findings);
  take_block_head(reader, test, findings);
  for (const CsvRow& row : table.rows) {
    reader.take(row);
    test.readings.push_back(block_reading(reader));
  }
  if (findings.empty() && test.readings.empty())
    findings.add(table.header_line, 0, "expected measured lengths below the header, found none");
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  return test;
}

}  // namespace ecs::laser
