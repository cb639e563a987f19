#include "modules/controllers/part_deviations.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "laser/csv_table.hpp"
#include "laser/findings.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::controllers {
namespace {

constexpr std::array<std::string_view, kAxes> kNominal{"x_mm", "y_mm", "z_mm"};
constexpr std::array<std::string_view, kAxes> kMeasured{"measured_x_mm", "measured_y_mm", "measured_z_mm"};
constexpr std::array<std::string_view, kAxes> kDifference{"dx_um", "dy_um", "dz_um"};
constexpr double kFarthestPoint_mm = 1e6;
constexpr double kLargestPartDeviation_um = 1e5;  ///< more is another part, or another unit

std::optional<MeasuredPoint> point_in(laser::TableReader& reader, bool measured) {
  MeasuredPoint point;
  bool good = true;
  for (std::size_t a = 0; a < kAxes; ++a) {
    const auto nominal = reader.number(kNominal[a], kFarthestPoint_mm);
    const std::string_view column = measured ? kMeasured[a] : kDifference[a];
    const auto value = reader.number(column, measured ? kFarthestPoint_mm : kLargestPartDeviation_um);
    good = good && nominal && value;
    if (!good) continue;
    point.nominal_mm[a] = *nominal;
    point.deviation_um[a] = measured ? (*value - *nominal) * 1e3 : *value;
    if (std::abs(point.deviation_um[a]) > kLargestPartDeviation_um)
      reader.wrong(column, fmt::format("a place within {} mm of the nominal one", kLargestPartDeviation_um / 1e3));
  }
  return good ? std::optional(point) : std::nullopt;
}

Result<PartDeviations> deviations_in(const laser::CsvTable& table, const std::string& file, laser::Findings& findings) {
  const bool measured = place_of(table, kMeasured[0]).has_value();
  const auto& needed = measured ? kMeasured : kDifference;
  for (const std::string_view column : needed)
    if (!place_of(table, column))
      return problem_at(file, table.header_line, 0,
                        "expected the columns dx_um, dy_um, dz_um, or measured_x_mm, measured_y_mm, "
                        "measured_z_mm; {} is missing",
                        column);
  PartDeviations found;
  laser::TableReader reader(table, findings);
  std::map<Vector3, int> seen;
  for (const laser::CsvRow& row : table.rows) {
    reader.take(row);
    const auto point = point_in(reader, measured);
    if (!point) continue;
    if (const auto [before, first] = seen.try_emplace(point->nominal_mm, row.line); !first)
      reader.refuse(kNominal[0], fmt::format("the same place as in line {}: expected each place once", before->second));
    found.points.push_back(*point);
  }
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  return found;
}

Result<PartDeviations> deviations_in(const laser::MeasurementSet& set, const std::string& file) {
  laser::Findings findings(file);
  struct Sums {
    Vector3 sum{};
    PerAxis<int> count{};
  };
  std::map<Vector3, Sums> places;
  for (const laser::Reading& reading : set.readings) {
    if (is_rotation(reading.sense) || reading.rotary)
      findings.add(reading.line, 0, "sense: expected EX, EY or EZ of a linear axis, found {}", name_of(reading.sense));
    else if (!(std::abs(reading.error) <= kLargestPartDeviation_um))
      findings.add(reading.line, 0, "reading: expected at most {} um, found {}", kLargestPartDeviation_um,
                   reading.error);
    Sums& sums = places[reading.position_mm];
    sums.sum[index_of(direction_of(reading.sense))] += reading.error;
    ++sums.count[index_of(direction_of(reading.sense))];
  }
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  PartDeviations found;
  std::size_t incomplete = 0;
  for (const auto& [place_mm, sums] : places) {
    MeasuredPoint point{place_mm, {}};
    for (std::size_t a = 0; a < kAxes; ++a)
      if (sums.count[a] > 0) point.deviation_um[a] = sums.sum[a] / sums.count[a];
    incomplete += std::count(sums.count.begin(), sums.count.end(), 0) > 0 ? 1u : 0u;
    found.points.push_back(point);
  }
  if (incomplete > 0)
    found.notes.push_back(fmt::format("{} of {} points lack a reading in X, Y or Z: the deviation there is taken as 0",
                                      incomplete, found.points.size()));
  return found;
}

}  // namespace

std::optional<Vector3> PartDeviations::at(const Vector3& program_mm, double reach_mm) const {
  const auto first =
      std::lower_bound(points.begin(), points.end(), program_mm[0] - reach_mm,
                       [](const MeasuredPoint& point, double x_mm) { return point.nominal_mm[0] < x_mm; });
  double weights = 0.0;
  Vector3 sum_um{};
  for (auto point = first; point != points.end() && point->nominal_mm[0] <= program_mm[0] + reach_mm; ++point) {
    const double distance_mm = std::hypot(point->nominal_mm[0] - program_mm[0], point->nominal_mm[1] - program_mm[1],
                                          point->nominal_mm[2] - program_mm[2]);
    if (distance_mm >= reach_mm) continue;
    if (distance_mm < 1e-9) return point->deviation_um;
    const double root = (reach_mm - distance_mm) / (reach_mm * distance_mm);
    weights += root * root;
    for (std::size_t a = 0; a < kAxes; ++a) sum_um[a] += root * root * point->deviation_um[a];
  }
  if (!(weights > 0.0)) return std::nullopt;
  return Vector3{sum_um[0] / weights, sum_um[1] / weights, sum_um[2] / weights};
}

Result<PartDeviations> parse_part_deviations(std::string_view text, const std::string& file) {
  laser::Findings findings(file);
  ECS_TRY(table, laser::parse_csv_table(text, file, kNominal, findings));
  Result<PartDeviations> found = PartDeviations();
  if (place_of(table, "reading")) {
    ECS_TRY(set, laser::set_with_approach_open(text, file));
    found = deviations_in(set, file);
  } else {
    found = deviations_in(table, file, findings);
  }
  if (!found) return found;
  if (found->points.empty()) return problem_at(file, 0, 0, "expected a row for each measured point, found none");
  std::sort(found->points.begin(), found->points.end(),
            [](const MeasuredPoint& a, const MeasuredPoint& b) { return a.nominal_mm < b.nominal_mm; });
  return found;
}

}  // namespace ecs::controllers
