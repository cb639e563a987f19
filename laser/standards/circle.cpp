// Least squares centre and minimum zone of deviations that are small against the radius: r − a cos θ − b sin θ.
#include "laser/standards/circle.hpp"

#include <algorithm>
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
constexpr double kFullTurn_deg = 360.0;

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
  std::ranges::stable_sort(pass.readings,
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

double folded_deg(double angle_deg) {
  const double angle = std::fmod(angle_deg, kFullTurn_deg);
  return angle < 0.0 ? angle + kFullTurn_deg : angle;
}

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
  const auto first_cw = std::ranges::find_if(values.passes, [](const CirclePass& pass) { return pass.clockwise; });
  for (auto ccw = values.passes.begin(), cw = first_cw; ccw != first_cw && cw != values.passes.end(); ++ccw, ++cw)
    values.pairs.push_back(pair_of(*ccw, *cw));
  return values;
}

namespace {

constexpr std::array<std::string_view, 3> kCircleColumns{"angle_deg", "deviation_um", "direction"};

constexpr double kLargestRadius_mm = 1e6;   ///< a choice
constexpr int kMostCircleRuns = 1'000'000;  ///< a choice

void take_plane(TableReader& table, CircleTest& test, Findings& findings) {
  const auto axis_at = [](const std::string& text, std::size_t place) -> std::optional<Axis> {
    for (const Axis axis : kAllAxes)
      if (text.size() == 2 && letter_of(axis) == text[place]) return axis;
    return std::nullopt;
  };
  const std::string text = table.stated("plane").value_or("");
  const auto first = axis_at(text, 0), second = axis_at(text, 1);
  if (first && second && *first != *second)
    test.plane = {*first, *second};
  else
    findings.add(0, 0, "expected `# plane: ` with two of the axes X, Y and Z, such as XY, found {}", in_quotes(text));
}

/// Metadata that the values need.
void take_circle_head(TableReader& table, CircleTest& test, Findings& findings) {
  take_plane(table, test, findings);
  const auto radius = table.stated_number("radius_mm");
  if (!radius)
    findings.add(0, 0, "expected `# radius_mm: ` with the nominal radius, found none");
  else if (*radius <= 0.0 || *radius > kLargestRadius_mm)
    findings.add(0, 0, "radius_mm: expected a number above 0, at most {:g}, found {:g}", kLargestRadius_mm, *radius);
  test.radius_mm = radius.value_or(0.0);
  test.feed_mm_min = table.stated_number("feed_mm_min");
  test.start_angle_deg = table.stated_number("start_angle_deg");
  for (std::size_t i = 0; i < test.plane.size(); ++i)
    test.centre_mm[i] = table.stated_number(fmt::format("centre_{}_mm", small_letter_of(test.plane[i])));
}

CircleReading circle_reading(TableReader& row) {
  CircleReading reading;
  reading.line = row.line();
  reading.angle_deg = folded_deg(row.number("angle_deg").value_or(0.0));
  reading.deviation_um = row.number("deviation_um").value_or(0.0);
  if (std::abs(reading.deviation_um) >= kUmPerMm)
    row.refuse("deviation_um",
               fmt::format("deviation_um: expected less than a millimetre, found {:g}. Is the column in um?",
                           reading.deviation_um));
  reading.clockwise = row.text("direction") == "cw";
  if (!reading.clockwise && row.text("direction") != "ccw") row.wrong("direction", "cw or ccw");
  if (!row.has("run")) return reading;
  const auto run = number_in(row.text("run"));
  const bool is_whole = run && *run == std::round(*run);
  if (is_whole && std::abs(*run) <= kMostCircleRuns)
    reading.run = static_cast<int>(*run);
  else
    row.wrong("run", is_whole ? fmt::format("a whole number within {}", kMostCircleRuns) : "a whole number");
  return reading;
}

/// @param angles_deg  of one pass
void check_closed(std::vector<double> angles_deg, bool clockwise, int run, Findings& findings) {
  std::ranges::sort(angles_deg);
  double from = angles_deg.back(), widest = angles_deg.front() + kFullTurn_deg - angles_deg.back();
  for (std::size_t k = 1; k < angles_deg.size(); ++k)
    if (angles_deg[k] - angles_deg[k - 1] > widest) {
      from = angles_deg[k - 1];
      widest = angles_deg[k] - from;
    }
  if (widest > kWidestGap_deg)
    findings.add(
        0, 0,
        "{}, run {}: the circle is open: no reading between {:.6g} and {:.6g} degrees, a gap of {:.6g} degrees; "
        "expected a gap of {:g} degrees at most",
        contouring_name(clockwise), run, from, folded_deg(from + widest), widest, kWidestGap_deg);
}

}  // namespace

Result<CircleTest> parse_circle_test(std::string_view text, const std::string& file_name) {
  Findings findings(file_name);
  ECS_TRY(table, parse_csv_table(text, file_name, kCircleColumns, findings));
  CircleTest test;
  test.source = file_name;
  test.metadata = table.metadata;
  TableReader reader(table, findings);
  take_circle_head(reader, test, findings);
  std::map<std::pair<bool, int>, std::vector<double>> passes;
  for (const CsvRow& row : table.rows) {
    reader.take(row);
    test.readings.push_back(circle_reading(reader));
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
