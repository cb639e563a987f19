#include "commissioning/standards/polar.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

namespace ecs::commissioning {
namespace {

constexpr double kRad_per_deg = std::numbers::pi / 180.0;
/// The largest deviation is drawn as at most this share of the nominal circle.
constexpr double kLargestShare = 0.45;

/// The first pass of each direction that was measured, counter-clockwise first.
std::vector<const laser::CirclePass*> shown_passes(const laser::CircleValues& values) {
  std::vector<const laser::CirclePass*> shown;
  for (const laser::CirclePass& pass : values.passes)
    if (shown.empty() || shown.back()->clockwise != pass.clockwise) shown.push_back(&pass);
  return shown;
}

/// About the least squares circle of the first pass.
double drawn_um(const std::vector<const laser::CirclePass*>& passes, double deviation_um) {
  return deviation_um - passes.front()->mean_um;
}

double largest_um(const std::vector<const laser::CirclePass*>& passes) {
  double largest = 1e-3;
  for (const laser::CirclePass* pass : passes)
    for (const double deviation_um : {pass->F_max_um, pass->F_min_um})
      largest = std::max(largest, std::abs(drawn_um(passes, deviation_um)));
  return largest;
}

/// 1, 2 or 5 times a power of ten, at most `value`.
double round_below(double value) {
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {5.0, 2.0})
    if (step * power <= value) return step * power;
  return power;
}

PlotPoint polar_point(double radius, double angle_deg) {
  return {radius * std::cos(angle_deg * kRad_per_deg), radius * std::sin(angle_deg * kRad_per_deg)};
}

PlotSeries ring(std::string name, Mark mark, double radius) {
  PlotSeries series{std::move(name), mark, {}};
  for (int angle = 0; angle <= 360; angle += 2) series.points.push_back(polar_point(radius, angle));
  return series;
}

}  // namespace

PlotFigure polar_figure(const laser::CircleTest& test, const laser::CircleValues& values) {
  const auto passes = shown_passes(values);
  const double largest = largest_um(passes);
  const double magnified = round_below(kLargestShare * test.radius_mm / (largest / 1000.0));
  const double ring_um = round_below(largest / 2.0);
  const auto drawn_mm = [&](double deviation_um) { return test.radius_mm + deviation_um / 1000.0 * magnified; };
  PlotPanel panel{fmt::format("{} plane, nominal radius {:g} mm; deviations {:g} times, a ring each {:g} um",
                              laser::plane_name(test.plane), test.radius_mm, magnified, ring_um),
                  fmt::format("{} [mm]", letter_of(test.plane[0])),
                  fmt::format("{} [mm]", letter_of(test.plane[1])),
                  {}};
  panel.equal_units = true;
  const int rings = static_cast<int>(std::ceil(largest / ring_um));
  for (int k = -rings; k <= rings; ++k)
    if (k != 0) panel.series.push_back(ring("", Mark::wire, drawn_mm(k * ring_um)));
  panel.series.push_back(
      ring(fmt::format("least squares circle, {:+.1f} um", passes.front()->mean_um), Mark::level, test.radius_mm));
  for (const laser::CirclePass* pass : passes) {
    PlotSeries series{fmt::format("{}, G {:.1f} um", pass->clockwise ? "clockwise" : "counter-clockwise", pass->G_um),
                      pass->clockwise ? Mark::reverse : Mark::forward,
                      {}};
    for (const laser::CircleReading& reading : pass->readings)
      series.points.push_back(
          polar_point(drawn_mm(drawn_um(passes, laser::deviation_at(*pass, reading.angle_deg))), reading.angle_deg));
    series.points.push_back(series.points.front());
    panel.series.push_back(std::move(series));
  }
  return {"Circular test (ISO 230-4)", {std::move(panel)}, 1, true};
}

std::string polar_text(const laser::CircleValues& values) {
  constexpr int kHalfColumns = 30, kHalfRows = 15;
  constexpr double kNominal = 10.0;  ///< rows from the centre to the nominal circle
  const auto passes = shown_passes(values);
  const double largest = largest_um(passes);
  const double um_a_row = largest / (kHalfRows - kNominal);
  std::vector<std::string> rows(2 * kHalfRows + 1, std::string(2 * kHalfColumns + 1, ' '));
  const auto put = [&](double radius, double angle_deg, char sign) {
    const PlotPoint at = polar_point(radius, angle_deg);
    const int row = kHalfRows - static_cast<int>(std::lround(at.y)),
              column = kHalfColumns + static_cast<int>(std::lround(2.0 * at.x));
    if (row < 0 || row > 2 * kHalfRows || column < 0 || column > 2 * kHalfColumns) return;
    char& cell = rows[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
    cell = cell == ' ' || cell == '.' || cell == sign ? sign : '#';
  };
  for (int angle = 0; angle < 360; angle += 2) put(kNominal, angle, '.');
  for (const laser::CirclePass* pass : passes)
    for (const laser::CircleReading& reading : pass->readings)
      put(kNominal + drawn_um(passes, laser::deviation_at(*pass, reading.angle_deg)) / um_a_row, reading.angle_deg,
          pass->clockwise ? 'o' : '+');
  std::string text =
      fmt::format("a row is {:.3g} um; + counter-clockwise, o clockwise, # both, . least squares circle\n", um_a_row);
  for (const std::string& row : rows) text += row.substr(0, row.find_last_not_of(' ') + 1) + "\n";
  return text;
}

}  // namespace ecs::commissioning
