// Least squares centre and minimum zone of deviations that are small against the radius: r − a cos θ − b sin θ.
#include "laser/standards/circle.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

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

}  // namespace ecs::laser
