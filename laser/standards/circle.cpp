// Least squares centre and minimum zone of deviations that are small against the radius: r − a cos θ − b sin θ.
#include "laser/standards/circle.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <numbers>

#include <fmt/format.h>

#include "base/text.hpp"
#include "base/units.hpp"
#include "laser/findings.hpp"
#include "laser/standards/zone.hpp"

namespace ecs::laser {
namespace {

constexpr double kRad_per_deg = std::numbers::pi / 180.0;

std::vector<ZonePoint> zone_points(const CirclePass& pass) {
  std::vector<ZonePoint> points;
  for (const CircleReading& reading : pass.readings) {
    const double angle = reading.angle_deg * kRad_per_deg;
    points.push_back({std::cos(angle), std::sin(angle), reading.deviation_um});
  }
  return points;
}

/// The constant of the least squares circle: residuals about it have no mean.
double mean_about(const std::vector<ZonePoint>& points, const Zone& zone) {
  double sum = 0.0;
  for (const ZonePoint& point : points) sum += point.value - zone.per_u * point.u - zone.per_v * point.v;
  return sum / static_cast<double>(points.size());
}

void evaluate(CirclePass& pass) {
  std::stable_sort(pass.readings.begin(), pass.readings.end(),
                   [](const CircleReading& a, const CircleReading& b) { return a.angle_deg < b.angle_deg; });
  const auto points = zone_points(pass);
  const Zone zone = least_squares_zone(points);
  pass.centre_um = {zone.per_u, zone.per_v};
  pass.F_max_um = zone.greatest;
  pass.F_min_um = zone.least;
  pass.mean_um = mean_about(points, zone);
  pass.G_um = minimum_zone(points).width();
}

CirclePair pair_of(const CirclePass& ccw, const CirclePass& cw) {
  CirclePair pair;
  pair.clockwise_run = cw.run;
  pair.counter_clockwise_run = ccw.run;
  auto both = zone_points(ccw);
  const auto others = zone_points(cw);
  both.insert(both.end(), others.begin(), others.end());
  pair.G_um = minimum_zone(both).width();
  const Zone common = least_squares_zone(both);
  pair.D_um = mean_about(both, common);
  pair.centre_um = {common.per_u, common.per_v};
  for (const CircleReading& reading : ccw.readings) {
    const double own = deviation_at(ccw, reading.angle_deg, pair.centre_um),
                 other = deviation_at(cw, reading.angle_deg, pair.centre_um);
    if (std::abs(own - other) <= pair.H_um) continue;
    pair.H_um = std::abs(own - other);
    pair.H_at_deg = reading.angle_deg;
  }
  return pair;
}

}  // namespace

double deviation_at(const CirclePass& pass, double angle_deg, const std::array<double, 2>& centre_um) {
  const auto& readings = pass.readings;
  const auto above = std::lower_bound(readings.begin(), readings.end(), angle_deg,
                                      [](const CircleReading& reading, double at) { return reading.angle_deg < at; });
  const CircleReading& high = above == readings.end() ? readings.front() : *above;
  const CircleReading& low = above == readings.begin() ? readings.back() : *std::prev(above);
  const auto ahead = [](double from, double to) { return to < from ? to - from + 360.0 : to - from; };
  const double gap = ahead(low.angle_deg, high.angle_deg);
  const double share = gap > 0.0 ? ahead(low.angle_deg, angle_deg) / gap : 1.0;
  const auto about_centre = [&](const CircleReading& reading) {
    const double angle = reading.angle_deg * kRad_per_deg;
    return reading.deviation_um - centre_um[0] * std::cos(angle) - centre_um[1] * std::sin(angle);
  };
  return std::lerp(about_centre(low), about_centre(high), share);
}

CircleValues circle_values_of(const CircleTest& test) {
  std::map<std::pair<bool, int>, CirclePass> passes;
  for (const CircleReading& reading : test.readings) {
    CirclePass& pass = passes[{reading.clockwise, reading.run}];
    pass.clockwise = reading.clockwise;
    pass.run = reading.run;
    pass.readings.push_back(reading);
  }
  CircleValues values;
  for (auto& [key, pass] : passes) {
    evaluate(pass);
    values.passes.push_back(std::move(pass));
  }
  const auto first_cw =
      std::find_if(values.passes.begin(), values.passes.end(), [](const CirclePass& pass) { return pass.clockwise; });
  for (auto ccw = values.passes.begin(), cw = first_cw; ccw != first_cw && cw != values.passes.end(); ++ccw, ++cw)
    values.pairs.push_back(pair_of(*ccw, *cw));
  return values;
}

namespace {

constexpr std::array<std::string_view, 3> kCircleColumns{"angle_deg", "deviation_um", "direction"};
constexpr double kFullTurn_deg = 360.0;

double folded_deg(double angle_deg) {
  const double angle = std::fmod(angle_deg, kFullTurn_deg);
  return angle < 0.0 ? angle + kFullTurn_deg : angle;
}

/// Metadata that the values need.
constexpr double kLargestRadius_mm = 1e6;         ///< a choice
constexpr long long kMostCircleRuns = 1'000'000;  ///< a choice

class CircleHead {
 public:
  CircleHead(CircleTest& test, Findings& findings) : test_(test), findings_(findings) {}

  void take() {
    take_plane();
    const auto radius = number("radius_mm");
    if (!radius)
      findings_.add(0, 0, "expected `# radius_mm: ` with the nominal radius, found none");
    else if (*radius <= 0.0 || *radius > kLargestRadius_mm)
      findings_.add(
          0, 0,
          fmt::format("radius_mm: expected a number above 0, at most {:g}, found {:g}", kLargestRadius_mm, *radius));
    test_.radius_mm = radius.value_or(0.0);
    test_.feed_mm_min = number("feed_mm_min");
    test_.start_angle_deg = number("start_angle_deg");
    for (std::size_t i = 0; i < test_.plane.size(); ++i)
      test_.centre_mm[i] =
          number(fmt::format("centre_{}_mm", static_cast<char>(std::tolower(letter_of(test_.plane[i])))));
  }

 private:
  void take_plane() {
    const std::string text = metadata_value(test_.metadata, "plane").value_or("");
    const auto first = text.size() == 2 ? axis_at(text[0]) : std::nullopt;
    const auto second = text.size() == 2 ? axis_at(text[1]) : std::nullopt;
    if (!first || !second || *first == *second)
      findings_.add(
          0, 0,
          fmt::format("expected `# plane: ` with two of the axes X, Y and Z, such as XY, found {}", in_quotes(text)));
    else
      test_.plane = {*first, *second};
  }

  static std::optional<Axis> axis_at(char letter) {
    for (const Axis axis : kAllAxes)
      if (letter_of(axis) == letter) return axis;
    return std::nullopt;
  }

  std::optional<double> number(const std::string& key) {
    const auto text = metadata_value(test_.metadata, key);
    if (!text) return std::nullopt;
    const auto value = number_in(*text);
    if (!value) findings_.add(0, 0, fmt::format("{}: expected a number, found {}", key, in_quotes(*text)));
    return value;
  }

  CircleTest& test_;
  Findings& findings_;
};

struct CircleColumns {
  std::size_t angle, deviation, direction;
  std::optional<std::size_t> run;
};

CircleReading circle_reading(const CsvRow& row, const CircleColumns& columns, Findings& findings) {
  CircleReading reading;
  reading.line = row.line;
  const auto number = [&](std::size_t column, std::string_view name) {
    const CsvField& field = row.fields[column];
    const auto value = number_in(field.text);
    if (!value)
      findings.add(row.line, field.column, fmt::format("{}: expected a number, found {}", name, in_quotes(field.text)));
    return value.value_or(0.0);
  };
  reading.angle_deg = folded_deg(number(columns.angle, "angle_deg"));
  reading.deviation_um = number(columns.deviation, "deviation_um");
  if (std::abs(reading.deviation_um) >= kUmPerMm)
    findings.add(row.line, row.fields[columns.deviation].column,
                 fmt::format("deviation_um: expected less than a millimetre, found {:g}. Is the column in um?",
                             reading.deviation_um));
  const CsvField& direction = row.fields[columns.direction];
  reading.clockwise = direction.text == "cw";
  if (!reading.clockwise && direction.text != "ccw")
    findings.add(row.line, direction.column,
                 fmt::format("direction: expected cw or ccw, found {}", in_quotes(direction.text)));
  if (columns.run) {
    const CsvField& field = row.fields[*columns.run];
    const auto run = integer_in(field.text);
    if (run && std::abs(*run) <= kMostCircleRuns)
      reading.run = static_cast<int>(*run);
    else
      findings.add(row.line, field.column,
                   fmt::format("run: expected a whole number{}, found {}",
                               run ? fmt::format(" within {}", kMostCircleRuns) : "", in_quotes(field.text)));
  }
  return reading;
}

/// @param angles_deg  of one pass
void check_closed(std::vector<double> angles_deg, bool clockwise, int run, Findings& findings) {
  std::sort(angles_deg.begin(), angles_deg.end());
  double from = angles_deg.back(), widest = angles_deg.front() + kFullTurn_deg - angles_deg.back();
  for (std::size_t k = 1; k < angles_deg.size(); ++k)
    if (angles_deg[k] - angles_deg[k - 1] > widest) {
      from = angles_deg[k - 1];
      widest = angles_deg[k] - from;
    }
  if (widest > kWidestGap_deg)
    findings.add(0, 0,
                 fmt::format("{}, run {}: the circle is open: no reading from {:.6g} to {:.6g} degrees; expected one "
                             "every {:g} degrees at least",
                             contouring_name(clockwise), run, from, folded_deg(from + widest), kWidestGap_deg));
}

}  // namespace

Result<CircleTest> parse_circle_test(std::string_view text, const std::string& file_name) {
  Findings findings(file_name);
  ECS_TRY(table, parse_csv_table(text, file_name, kCircleColumns, findings));
  CircleTest test;
  test.source = file_name;
  test.metadata = table.metadata;
  CircleHead(test, findings).take();
  const CircleColumns columns{*place_of(table, "angle_deg"), *place_of(table, "deviation_um"),
                              *place_of(table, "direction"), place_of(table, "run")};
  std::map<std::pair<bool, int>, std::vector<double>> passes;
  for (const CsvRow& row : table.rows) {
    test.readings.push_back(circle_reading(row, columns, findings));
    const CircleReading& reading = test.readings.back();
    passes[{reading.clockwise, reading.run}].push_back(reading.angle_deg);
  }
  if (findings.empty()) {
    if (passes.empty()) findings.add(table.header_line, 0, "expected readings below the header, found none");
    for (const auto& [pass, angles_deg] : passes) check_closed(angles_deg, pass.first, pass.second, findings);
  }
  if (!findings.empty()) return tl::unexpected(findings.as_problem());
  return test;
}

}  // namespace ecs::laser
