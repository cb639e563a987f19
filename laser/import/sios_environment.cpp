// Environment logs of SIOS nanomeasuring machines: nine numbers a line (m, degC, Pa, percent).
#include <vector>

#include "base/text.hpp"
#include "base/units.hpp"
#include "laser/findings.hpp"
#include "laser/import/format.hpp"
#include "laser/import/readers.hpp"

namespace ecs::laser {
namespace {

Result<EnvironmentSeries> read_sios_environment(std::string_view text, const std::string& file_name) {
  EnvironmentSeries series;
  series.columns = {"x_mm",         "y_mm",         "z_mm",         "t_air_degC",   "t_air_x_degC",
                    "t_air_y_degC", "t_air_z_degC", "pressure_hPa", "humidity_pct", "t_material_degC"};
  Findings findings(file_name);
  const auto lines = lines_of(text);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (trimmed(lines[i]).empty()) continue;
    const auto row = row_of(lines[i], 9);
    if (!row) {
      findings.add(
          static_cast<int>(i) + 1, 1,
          "expected nine numbers (X, Y, Z, three air temperatures, pressure, humidity, sample temperature), found " +
              in_quotes(trimmed(lines[i])));
      continue;
    }
    const auto& n = *row;
    series.rows.push_back({std::nullopt,
                           {n[0] * kMmPerM, n[1] * kMmPerM, n[2] * kMmPerM, (n[3] + n[4] + n[5]) / 3.0, n[3], n[4],
                            n[5], n[6] / kPaPerHPa, n[7], n[8]}});
  }
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  if (series.rows.empty()) return problem_at(file_name, 0, 0, "expected environment records, found none");
  return series;
}

/// Nine numbers, the seventh a pressure in Pa.
Recognition recognises_environment(const FileStart& file) {
  constexpr double kLeast_Pa = 30'000.0, kMost_Pa = 130'000.0;  // from the highest workshop to any weather
  const auto numbers = numbers_alone(file.first_line);
  const bool fits = numbers.size() == 9 && numbers[6] > kLeast_Pa && numbers[6] < kMost_Pa;
  return fits ? Recognition::certain : Recognition::no;
}

}  // namespace

extern const FileFormat kSiosEnvironment{
    .id = "sios_environment",
    .title = "SIOS environment log (.pos)",
    .sample = "environment.pos",
    .recognises = recognises_environment,
    .read_environment = read_sios_environment,
    .units = ErrorUnits::fixed,
};

}  // namespace ecs::laser
