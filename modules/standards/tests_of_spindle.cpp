// `ecs test spindle`: error motions of a spindle from the trace of a master ball or test bar (ISO 230-7), and the form
// of the ball by reversal.

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "app/cli/verb.hpp"
#include "app/plot/gnuplot.hpp"
#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "base/file_kind.hpp"
#include "modules/standards/circle_work.hpp"
#include "modules/standards/spindle.hpp"

namespace ecs::app {
namespace {

struct SpindleRequest {
  std::string file, reversed, output, plot;
  static Fields<SpindleRequest> fields() {
    using R = SpindleRequest;
    return {{"FILE", &R::file, "file of a master ball over the turns: angle_deg,x_um,y_um,z_um", Need::required},
            {"--reversed", &R::reversed, "file of the same sensors after ball and sensors were turned by 180 degrees"},
            {"-o,--output", &R::output, "CSV file for the curves over the angle", Is::output},
            {"--plot", &R::plot, "polar plots to write: OUT.svg or OUT.png", Is::output}};
  }
};

std::string_view unit_of(const laser::SpindleMotion& motion) { return motion.is_tilt ? "um/m" : "um"; }

std::string once_words(const laser::SpindleMotion& motion) {
  const std::string_view unit = unit_of(motion);
  if (!motion.is_radial)
    return fmt::format("fundamental {:.3f} {}, residual synchronous {:.3f} {}", 2.0 * motion.once.amplitude, unit,
                       motion.residual_synchronous, unit);
  if (!motion.is_fixed)
    return fmt::format("offset of the least-squares centre {:.3f} {}, removed", motion.once.amplitude, unit);
  return fmt::format("{} {:.3f} {} at {:.0f} deg, removed", motion.is_tilt ? "inclination of the bar" : "eccentricity",
                     motion.once.amplitude, unit, motion.once.at_deg);
}

Cell wave_cell(const laser::SpindleWave& wave) {
  return record_cell(" {amplitude:>8}", "per_turn"_is(wave.per_turn), "amplitude"_is(wave.amplitude, 3),
                     "sigma"_is(wave.sigma), "at_deg"_is(wave.at_deg));
}

Cell noise_cell(const laser::SpindleNoise& noise) {
  return record_cell("", "rms"_is(noise.rms), "asynchronous"_is(noise.asynchronous),
                     "synchronous"_is(noise.synchronous));
}

/// Quantities that a motion does not have are null.
template <class Value>
Json only(bool has, const Value& value) {
  return has ? Json(value) : Json();
}

Cell motion_cell(const laser::SpindleMotion& motion) {
  return record_cell(
      "  {title:<27} {unit:<4} {total:>8} {synchronous:>8} {synchronous_mrs:>8} {asynchronous:>8} {at:>7} {drift:>8}\n",
      "motion"_is(motion.id), "title"_shown(motion.title), "unit"_is(unit_of(motion)), "total"_is(motion.total, 3),
      "synchronous"_is(motion.synchronous, 3),
      "synchronous_mrs"_is(motion.is_radial ? std::optional(motion.synchronous_zone) : std::nullopt, 3),
      "asynchronous"_is(motion.asynchronous, 3), "asynchronous_at_deg"_is(motion.asynchronous_deg),
      "at"_shown(motion.asynchronous_deg, 0), "asynchronous_with_drift"_is(motion.asynchronous_drift),
      "asynchronous_rms"_is(motion.asynchronous_rms), "drift"_is(motion.drift, 3),
      "turn_means"_is(Json(motion.turn_means)),
      "eccentricity"_is(only(motion.is_radial && motion.is_fixed, motion.once.amplitude)),
      "eccentricity_at_deg"_is(only(motion.is_radial && motion.is_fixed, motion.once.at_deg)),
      "fundamental"_is(only(!motion.is_radial, 2.0 * motion.once.amplitude)),
      "residual_synchronous"_is(only(!motion.is_radial, motion.residual_synchronous)),
      "waves"_is(Cell{list_cell(motion.waves, wave_cell).json, {}}), "if_noise"_is(noise_cell(motion.if_noise)),
      "of_sensor"_is(motion.of_sensor ? noise_cell(*motion.of_sensor) : null_cell()));
}

/// What noise with the rms of the asynchronous motion would give, and what follows for the measured values.
std::string noise_words(const laser::SpindleMotion& motion, std::size_t turns) {
  constexpr double kLikeNoise = 0.2;    // the range of noise in few turns scatters about its mean; a choice
  constexpr double kBeyondNoise = 1.5;  // likewise
  const std::string_view unit = unit_of(motion);
  const double by_noise = motion.if_noise.asynchronous;
  const double excess = motion.asynchronous - by_noise;
  const bool beyond = motion.synchronous > kBeyondNoise * motion.if_noise.synchronous;
  return fmt::format(
      "    Compared with random noise of the same rms as the asynchronous motion ({1:.3f} {0}), over {2} turns:\n"
      "    asynchronous  such noise would give {3:.3f} {0}; measured {4:.3f} {0}. The measured value {5}\n"
      "    synchronous   such noise would give {6:.3f} {0}; measured {7:.3f} {0}. The measured value {8}\n",
      unit, motion.asynchronous_rms, turns, by_noise, motion.asynchronous,
      std::abs(excess) <= kLikeNoise * by_noise ? "cannot be distinguished from noise"
      : excess < 0.0 ? "is smaller, so part of the motion is not random. The usual cause repeats only after several "
                       "turns (cage, belt)"
                     : "is larger, so part of the motion is not random. Single turns differ by more",
      motion.if_noise.synchronous, motion.synchronous,
      beyond ? "exceeds that of noise" : "cannot be distinguished from noise");
}

/// What does not fit into the row of a motion.
std::string further_words(const laser::SpindleTest& test) {
  std::string text = "once per turn, and comparison with noise\n";
  for (const laser::SpindleMotion& motion : test.motions) {
    const std::string_view unit = unit_of(motion);
    text += fmt::format("  {:<27} {}\n", motion.title, once_words(motion));
    const std::string drifting = fmt::format("{:.3f}", motion.asynchronous_drift);
    if (drifting != fmt::format("{:.3f}", motion.asynchronous))
      text += fmt::format("    with the drift included, the asynchronous value is {} {}\n", drifting, unit);
    text += noise_words(motion, test.turns);
    if (motion.of_sensor)
      text += fmt::format(
          "    Noise of the sensor alone, {0:.3f} {1} rms, gives {2:.3f} {1} asynchronous and {3:.3f} {1} "
          "synchronous\n",
          motion.of_sensor->rms, unit, motion.of_sensor->asynchronous, motion.of_sensor->synchronous);
  }
  text += fmt::format("waves per turn, amplitude     ");
  for (const laser::SpindleWave& wave : test.motions.front().waves) text += fmt::format(" {:>8}", wave.per_turn);
  text += "\n";
  for (const laser::SpindleMotion& motion : test.motions)
    text += fmt::format("  {:<27} {}\n", motion.title, list_cell(motion.waves, wave_cell).text);
  return text;
}

Cell separation_cell(const laser::SpindleSeparation& separation) {
  return record_cell(
      "  {motion:<27} synchronous {synchronous_um} um (MRS {synchronous_mrs_um}), form of the ball {form_um} um (MRS "
      "{form_mrs_um}); standard uncertainty of either curve at any one angle: {sigma_um} um\n",
      "motion"_is(separation.id, fmt::format("radial, fixed direction {}", separation.id == "radial_y" ? 'Y' : 'X')),
      "synchronous_um"_is(separation.synchronous_um, 3), "synchronous_mrs_um"_is(separation.synchronous_zone_um, 3),
      "form_um"_is(separation.form_um, 3), "form_mrs_um"_is(separation.form_zone_um, 3),
      "sigma_um"_is(separation.sigma_um, 3));
}

/// What waves usually mean, where they are the greatest and stand out of their scatter.
std::vector<std::string> causes_of(const laser::SpindleTest& test) {
  constexpr double kStandsOut = 3.0;  // standard uncertainties
  std::vector<std::string> notes;
  for (const laser::SpindleMotion& motion : test.motions) {
    if (!motion.is_radial || !motion.is_fixed || motion.is_tilt) continue;
    const laser::SpindleWave& wave = *std::ranges::max_element(motion.waves, {}, &laser::SpindleWave::amplitude);
    if (wave.per_turn > 3 || wave.amplitude < kStandsOut * wave.sigma) continue;
    notes.push_back(
        fmt::format("{}: the largest wave has {} periods per turn. Usual causes: {}.", motion.title, wave.per_turn,
                    wave.per_turn == 2 ? "an oval ball, or oval seats of the bearings"
                                       : "a ball, seat or bearing ring deformed by clamping at three points"));
  }
  return notes;
}

std::string curves_csv(const laser::SpindleTest& test, const std::vector<laser::SpindleSeparation>& separations) {
  std::string text = "motion,unit,angle_deg,synchronous,least,greatest\n";
  for (const laser::SpindleMotion& motion : test.motions)
    for (std::size_t m = 0; m < motion.mean.size(); ++m) {
      const auto at = [&](const std::vector<double>& turn) { return turn[m]; };
      const auto [least, greatest] = std::ranges::minmax_element(motion.turns, {}, at);
      text += fmt::format("{},{},{:.4f},{:.5f},{:.5f},{:.5f}\n", motion.id, unit_of(motion), motion.angle_deg[m],
                          motion.mean[m], at(*least), at(*greatest));
    }
  for (const laser::SpindleSeparation& separation : separations)
    for (const auto& [name, curve] : {std::pair{"spindle", &separation.spindle_um}, {"ball", &separation.ball_um}})
      for (std::size_t m = 0; m < curve->size(); ++m)
        text += fmt::format("{}_{},um,{:.4f},{:.5f},,\n", separation.id, name, separation.angle_deg[m], (*curve)[m]);
  return text;
}

/// Strokes with a point at every few of the angles. @param follows  at the first angle a turn later; absent: not known
void add_strokes(PlotSeries& series, const std::vector<double>& angle_deg, const std::vector<double>& values,
                 double base, std::optional<double> follows) {
  constexpr std::size_t kMostPoints = 180;
  const std::size_t step = 1 + (values.size() - 1) / kMostPoints;
  for (std::size_t m = 0; m < values.size(); m += step) {
    const bool is_last = m + step >= values.size();
    if (is_last && !follows) return;
    series.points.push_back(polar_point(base + values[m], angle_deg[m]));
    series.points.push_back(is_last ? polar_point(base + *follows, angle_deg.front())
                                    : polar_point(base + values[m + step], angle_deg[m + step]));
  }
}

/// Every turn thin, their mean thick, about a circle that stands for 0 and is twice the largest deviation.
PlotPanel polar_panel(const laser::SpindleMotion& motion) {
  const std::string_view unit = motion.is_tilt ? "µm/m" : "µm";
  double largest = 1e-6;
  for (const auto& turn : motion.turns)
    for (const double value : turn) largest = std::max(largest, std::abs(value));
  constexpr double kLabelsAt_deg = 60.0;  // of the rings, between those of the angles
  const double ring_step = round_below(largest), base = 2.0 * largest;
  PlotPanel panel{fmt::format("{}: synchronous {:.3g} {}, asynchronous {:.3g} {}", motion.title, motion.synchronous,
                              unit, motion.asynchronous, unit),
                  {},
                  {},
                  {}};
  panel.drawing = panel.equal_units = true;
  PlotSeries labels{"", Mark::label, {}};
  for (const int k : {-1, 0, 1}) {
    if (k != 0) panel.series.push_back(ring("", Mark::wire, base + k * ring_step));
    labels.points.push_back(polar_point(base + k * ring_step, kLabelsAt_deg));
    labels.labels.push_back(k == 0 ? "0" : fmt::format("{:+g} {}", k * ring_step, unit));
  }
  for (const int angle_deg : {0, 90, 180, 270}) {
    labels.points.push_back(polar_point(base + 1.25 * largest, angle_deg));
    labels.labels.push_back(fmt::format("{}°", angle_deg));
  }
  PlotSeries turns{fmt::format("{} turns", motion.turns.size()), Mark::wire, {}};
  for (std::size_t t = 0; t < motion.turns.size(); ++t)
    add_strokes(turns, motion.angle_deg, motion.turns[t], base,
                t + 1 < motion.turns.size() ? std::optional(motion.turns[t + 1].front()) : std::nullopt);
  panel.series.push_back(std::move(turns));
  panel.series.push_back(ring(motion.is_radial ? "least squares circle" : "mean", Mark::level, base));
  PlotSeries mean{"synchronous", Mark::bent_wire, {}};
  add_strokes(mean, motion.angle_deg, motion.mean, base, motion.mean.front());
  panel.series.push_back(std::move(mean));
  panel.series.push_back(std::move(labels));
  return panel;
}

PlotFigure spindle_figure(const laser::SpindleTest& test) {
  PlotFigure figure{fmt::format("Error motions of a spindle (ISO 230-7), {} turns", test.turns), {}, 1, false};
  for (const laser::SpindleMotion& motion : test.motions) figure.panels.push_back(polar_panel(motion));
  if (figure.panels.size() > 1) figure.columns = 2;
  return figure;
}

Result<laser::SpindleTest> test_in(const std::string& file) {
  ECS_TRY(text, read_file_of(FileKind::spindle_test, file));
  ECS_TRY(trace, laser::parse_spindle_trace(text, file));
  return laser::spindle_test_of(trace);
}

Result<Outcome> spindle(VerbContext&, const SpindleRequest& request) {
  ECS_TRY(test, test_in(request.file));
  std::vector<laser::SpindleSeparation> separations;
  std::vector<std::string> notes = test.notes;
  if (!request.reversed.empty()) {
    ECS_TRY(reversed, test_in(request.reversed));
    ECS_TRY(separated, laser::separated(test, reversed));
    separations = std::move(separated);
    for (const std::string& note : reversed.notes) notes.push_back(fmt::format("{}: {}", request.reversed, note));
  } else if (std::ranges::any_of(test.motions, &laser::SpindleMotion::is_radial)) {
    notes.emplace_back(
        "The form of the ball is part of the radial synchronous motions. To separate them, make a second recording "
        "with ball and sensor turned by 180 degrees, and give that file as --reversed.");
  }
  for (std::string& cause : causes_of(test)) notes.push_back(std::move(cause));
  if (!request.plot.empty()) ECS_DO(write_plot(request.plot, spindle_figure(test)));
  if (!request.output.empty()) ECS_DO(write_file(request.output, curves_csv(test, separations)));
  const std::string heading = fmt::format("  {:<32} {:>8} {:>8} {:>8} {:>8} {:>7} {:>8}\n", "error motion", "total",
                                          "synchr.", "(MRS)", "asynchr.", "at deg", "drift");
  return outcome_of(record_cell(
      "{file}: {turns} turns, each read at {readings_per_turn} angles{speed}. The angle {way} with time. Drift is "
      "removed.\n"
      "Radial values refer to the least-squares centre (LSC). Those in the column MRS refer to the\n"
      "centre of minimum radial separation. Axial values refer to the mean.\n"
      "The synchronous value is the range of the mean of all turns. The asynchronous value is the\n"
      "largest range of the turns at one angle, stated in the column \"at deg\".\n"
      "{motions}{further}{separated}{notes}{output}{plot}",
      "file"_is(request.file), "turns"_is(test.turns), "readings_per_turn"_is(test.angles), "falling"_is(test.falling),
      "way"_shown(test.falling ? "decreases" : "increases"), "speed_rpm"_is(test.speed_rpm),
      "speed"_shown(test.speed_rpm ? fmt::format(", at {:.6g} rpm", *test.speed_rpm) : std::string()),
      "motions"_is(list_cell(test.motions, motion_cell, heading)), "further"_shown(further_words(test)),
      "separated"_is(list_cell(separations, separation_cell,
                               separations.empty() ? "" : "spindle and ball, separated by the reversal\n")),
      "notes"_is(paragraphs_cell(notes, "  note: ")), "output"_is(written_cell("curves", request.output)),
      "plot"_is(written_cell("plot", request.plot))));
}

}  // namespace

extern const std::vector<Action> kTestsOfSpindle{
    action("test spindle", "ISO 230-7: synchronous and asynchronous error motions of a spindle, by a master ball",
           "ecs test spindle spindle.csv --reversed turned.csv --plot spindle.svg", spindle,
           {.logged = Logged::always, .kind = "test"})};

}  // namespace ecs::app
