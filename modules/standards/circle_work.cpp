#include "modules/standards/circle_work.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "base/file_kind.hpp"

namespace ecs::commissioning {
namespace {

Result<std::array<std::vector<double>, 2>> pitches_of(const params::Machine& machine, const laser::CircleTest& test) {
  std::array<std::vector<double>, 2> pitches_mm;
  for (std::size_t i = 0; i < test.plane.size(); ++i) {
    const auto& axis = machine.axes[index_of(test.plane[i])];
    if (!axis)
      return problem(ProblemKind::usage, "{}: the plane is {}, and the machine has no {}", test.source,
                     laser::plane_name(test.plane), letter_of(test.plane[i]));
    for (const auto& pitch_mm : {axis->screw_pitch_mm, axis->scale_pitch_mm})
      if (pitch_mm) pitches_mm[i].push_back(*pitch_mm);
  }
  return pitches_mm;
}

/// "" if the centres of both passes agree within their noise.
std::string centres_note(const laser::CircleValues& values, const laser::CirclePair& pair, double noise_um) {
  constexpr double kStandsOut = 5.0, kLeast_um = 0.5;  // standard uncertainties of a difference; choices
  const auto pass_of = [&](bool clockwise, int run) -> const laser::CirclePass& {
    return *std::ranges::find_if(values.passes,
                                 [&](const auto& pass) { return pass.clockwise == clockwise && pass.run == run; });
  };
  const auto &ccw = pass_of(false, pair.counter_clockwise_run), &cw = pass_of(true, pair.clockwise_run);
  const double first_um = cw.centre_um[0] - ccw.centre_um[0], second_um = cw.centre_um[1] - ccw.centre_um[1];
  const double sigma_um =
      2.0 * noise_um / std::sqrt(static_cast<double>(std::min(ccw.readings.size(), cw.readings.size())));
  if (std::hypot(first_um, second_um) < std::max(kLeast_um, kStandsOut * sigma_um)) return {};
  return fmt::format(
      "the centre of cw, run {}, differs from that of ccw, run {}, by ({:.2f}, {:.2f}) um. The causes do not include "
      "this difference. If the set-up was not changed, the axes shift with the direction",
      pair.clockwise_run, pair.counter_clockwise_run, first_um, second_um);
}

}  // namespace

Result<CircleWork> circle_work(const std::filesystem::path& file, const params::Machine* machine) {
  ECS_TRY(text, read_file_of(FileKind::circle_test, file));
  ECS_TRY(test, laser::parse_circle_test(text, file.string()));
  std::array<std::vector<double>, 2> pitches_mm;
  if (machine != nullptr) {
    ECS_TRY(known, pitches_of(*machine, test));
    pitches_mm = std::move(known);
  }
  ECS_TRY(diagnosis,
          model::diagnose_circle(test, pitches_mm,
                                 machine == nullptr ? model::PitchSource::nowhere : model::PitchSource::machine_file));
  laser::CircleValues values = laser::circle_values_of(test);
  for (const laser::CirclePair& pair : values.pairs)
    if (std::string note = centres_note(values, pair, diagnosis.noise_um); !note.empty())
      diagnosis.notes.push_back(std::move(note));
  return CircleWork{file, std::move(test), std::move(values), std::move(diagnosis)};
}

namespace {

constexpr double kRad_per_deg = std::numbers::pi / 180.0;
/// The largest deviation is drawn as at most this share of the nominal circle.
constexpr double kLargestShare = 0.45;

/// The first pass of each direction that was measured, counter-clockwise first, all about one least squares circle:
/// what differs between the directions is in the picture.
struct DrawnCircle {
  std::vector<const laser::CirclePass*> passes;
  std::array<double, 2> centre_um{};
  double mean_um = 0.0;

  [[nodiscard]] double deviation_um(const laser::CirclePass& pass, double angle_deg) const {
    return laser::deviation_at(pass, angle_deg, centre_um) - mean_um;
  }
};

DrawnCircle drawn_circle(const laser::CircleValues& values) {
  DrawnCircle drawn;
  for (const laser::CirclePass& pass : values.passes)
    if (drawn.passes.empty() || drawn.passes.back()->clockwise != pass.clockwise) drawn.passes.push_back(&pass);
  if (values.pairs.empty()) {
    drawn.centre_um = drawn.passes.front()->centre_um;
    drawn.mean_um = drawn.passes.front()->mean_um;
  } else {
    drawn.centre_um = values.pairs.front().centre_um;
    drawn.mean_um = values.pairs.front().D_um;
  }
  return drawn;
}

double largest_um(const DrawnCircle& drawn) {
  double largest = 1e-3;
  for (const laser::CirclePass* pass : drawn.passes)
    for (const laser::CircleReading& reading : pass->readings)
      largest = std::max(largest, std::abs(drawn.deviation_um(*pass, reading.angle_deg)));
  return largest;
}

}  // namespace

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

PlotFigure polar_figure(const laser::CircleTest& test, const laser::CircleValues& values) {
  const DrawnCircle drawn = drawn_circle(values);
  const double largest = largest_um(drawn);
  const double magnified = round_below(kLargestShare * test.radius_mm / (largest / 1000.0));
  const double ring_um = round_below(largest / 2.0);
  const auto drawn_mm = [&](double deviation_um) { return test.radius_mm + deviation_um / 1000.0 * magnified; };
  PlotPanel panel{fmt::format("{} plane, nominal radius {:g} mm; deviations enlarged {:g} times, a ring every {:g} um",
                              laser::plane_name(test.plane), test.radius_mm, magnified, ring_um),
                  fmt::format("{} [mm]", letter_of(test.plane[0])),
                  fmt::format("{} [mm]", letter_of(test.plane[1])),
                  {}};
  panel.equal_units = true;
  const int rings = static_cast<int>(std::ceil(largest / ring_um));
  for (int k = -rings; k <= rings; ++k)
    if (k != 0) panel.series.push_back(ring("", Mark::wire, drawn_mm(k * ring_um)));
  panel.series.push_back(
      ring(fmt::format("least squares circle{}, {:+.1f} um", values.pairs.empty() ? "" : " of both", drawn.mean_um),
           Mark::level, test.radius_mm));
  for (const laser::CirclePass* pass : drawn.passes) {
    PlotSeries series{fmt::format("{}, G {:.1f} um", pass->clockwise ? "clockwise" : "counter-clockwise", pass->G_um),
                      pass->clockwise ? Mark::reverse : Mark::forward,
                      {}};
    for (const laser::CircleReading& reading : pass->readings)
      series.points.push_back(polar_point(drawn_mm(drawn.deviation_um(*pass, reading.angle_deg)), reading.angle_deg));
    series.points.push_back(series.points.front());
    panel.series.push_back(std::move(series));
  }
  return {"Circular test (ISO 230-4)", {std::move(panel)}, 1, true};
}

std::string polar_text(const laser::CircleValues& values) {
  constexpr int kHalfColumns = 30, kHalfRows = 15;
  constexpr double kNominal = 10.0;  ///< rows from the centre to the nominal circle
  const DrawnCircle drawn = drawn_circle(values);
  const double largest = largest_um(drawn);
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
  for (const laser::CirclePass* pass : drawn.passes)
    for (const laser::CircleReading& reading : pass->readings)
      put(kNominal + drawn.deviation_um(*pass, reading.angle_deg) / um_a_row, reading.angle_deg,
          pass->clockwise ? 'o' : '+');
  std::string text = fmt::format(
      "one line of the drawing is {:.3g} um; + counter-clockwise, o clockwise, # both, . least squares circle\n",
      um_a_row);
  for (const std::string& row : rows) text += row.substr(0, row.find_last_not_of(' ') + 1) + "\n";
  return text;
}

}  // namespace ecs::commissioning
