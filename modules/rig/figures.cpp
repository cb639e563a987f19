// Data of the figures as CSV, and their pictures, drawn by gnuplot from a script that stays beside the data. The verb
// `rig`, which the module brings to the emulator.

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/file.hpp"
#include "ecs_emulator/verbs/module.hpp"
#include "ecs_emulator/verbs/verb.hpp"
#include "laser/writers/writers.hpp"
#include "modules/rig/rig.hpp"

namespace ecs::emulator {
namespace {

struct RigPictures {
  const RigBand* full_before;
  const RigBand* full_after;
  const RigBand* turns_before;
  const RigBand* turns_after;
};

struct Calibration {
  const char* figure;
  const char* title;
  const RigBand* band;
  double most_um;  ///< of the axis: the same before and after, so that they can be compared by eye
};

/// Position, mean, mean − 3σ, mean + 3σ; forward, two empty lines, reverse: gnuplot's `index 0` and `index 1`.
std::string means_of(const RigBand& band) {
  std::string text = "# position_mm mean_um low_um high_um; forward, then reverse\n";
  for (const Approach approach : {Approach::forward, Approach::reverse}) {
    for (const RigTarget& t : band.targets)
      if (t.approach == approach)
        text += fmt::format("{:.4f} {:.3f} {:.3f} {:.3f}\n", t.position_mm, t.mean_um, t.mean_um - 3.0 * t.sigma_um,
                            t.mean_um + 3.0 * t.sigma_um);
    text += "\n\n";
  }
  return text;
}

std::string servo_commands() {
  return R"(set output 'figure_3_3.svg'
set title 'D/A output of the controller: 10 mm at 20 mm/s'
set xlabel 'time (s)'
set ylabel 'D/A output (V)'
set yrange [-0.5:10.5]
set key center right
plot 'figure_3_3.csv' using 1:2 every ::1 with lines lw 2 lc rgb '#0050a0' title 'Kw = 0.0632298 V s/rad', \
     'figure_3_3_printed_kw.csv' using 1:2 every ::1 with lines lw 1.5 dt (12,6) lc rgb '#c04000' title 'Kw = 0.632298, as printed'
set output 'figure_3_5.svg'
set title 'Moving slide: error 0.25 µm/mm, compensation in steps of one pulse (2 µm)'
set xlabel 'desired position (mm)'
set ylabel 'deviation (µm)'
set yrange [-24:24]
set key bottom left
plot 'figure_3_5.csv' using 1:2 every ::1 with lines lw 2 lc rgb '#804000' title 'uncompensated', \
     '' using 1:4 every ::1 with steps lw 1.5 dt (8,4) lc rgb '#0050a0' title 'compensation', \
     '' using 1:3 every ::1 with lines lw 2 lc rgb '#008040' title 'compensated', \
     2 with lines lw 1 dt 3 lc rgb '#808080' title 'resolution of the encoder', -2 with lines lw 1 dt 3 lc rgb '#808080' notitle
)";
}

std::string calibration_commands(const Calibration& c) {
  return fmt::format(R"(set output 'figure_{0}.svg'
set title '{1}: +/- 3 sigma error band {2:.3f} mm, non-repeatability {3:.3f} mm'
set xlabel 'position (mm)'
set ylabel 'error (µm)'
set yrange [{4}:{5}]
set key top right
plot 'means_{0}.dat' index 0 using 1:2 with lines lw 1.5 lc rgb '#0050a0' title 'forward, mean', \
     '' index 0 using 1:3 with lines lw 0.7 dt 3 lc rgb '#0050a0' title '3 sigma', '' index 0 using 1:4 with lines lw 0.7 dt 3 lc rgb '#0050a0' notitle, \
     '' index 1 using 1:2 with lines lw 1.5 dt (12,6) lc rgb '#c04000' title 'reverse, mean', \
     '' index 1 using 1:3 with lines lw 0.7 dt 2 lc rgb '#c04000' title '3 sigma', '' index 1 using 1:4 with lines lw 0.7 dt 2 lc rgb '#c04000' notitle
)",
                     c.figure, c.title, c.band->error_band_um * 1e-3, c.band->non_repeatability_um * 1e-3,
                     -0.15 * c.most_um, c.most_um);
}

Result<void> run_gnuplot(const std::filesystem::path& folder) {
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  char program[] = "gnuplot", no_start_files[] = "-d", script[] = "figures.gp";
  char* const words[] = {program, no_start_files, script, nullptr};
  pid_t child = -1;
  const int fault = ::posix_spawnp(&child, program, &actions, nullptr, words, environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (fault == ENOENT)
    return problem(ProblemKind::output, "gnuplot not found; the pictures need it: install the package gnuplot-nox");
  if (fault != 0) return problem(ProblemKind::output, "gnuplot: {}", std::strerror(fault));
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (status != 0) return problem(ProblemKind::output, "gnuplot failed on {}/figures.gp", folder.string());
  return {};
}

/// Writes means and ±3σ of the calibrations as CSV and `figures.gp`, and runs gnuplot on it.
Result<void> draw_rig_pictures(const std::filesystem::path& folder, const RigPictures& pictures) {
  const std::array<Calibration, 4> calibrations{
      {{"3_9", "Slideway calibration, 4 mm steps", pictures.full_before, 280.0},
       {"3_11", "With compensation in both directions", pictures.full_after, 280.0},
       {"3_10", "Slideway calibration, 0.2 mm steps", pictures.turns_before, 280.0},
       {"3_12", "With compensation over 2 revolutions", pictures.turns_after, 280.0}}};
  std::string script =
      "set terminal svg size 900,520 enhanced font 'sans,13' background rgb 'white'\nset encoding utf8\nset datafile "
      "separator ','\nset grid lc rgb '#d0d0d0'\n" +
      servo_commands() + "set datafile separator whitespace\n";
  for (const Calibration& c : calibrations) {
    script += calibration_commands(c);
    ECS_DO(write_file(folder / fmt::format("means_{}.dat", c.figure), means_of(*c.band)));
  }
  ECS_DO(write_file(folder / "figures.gp", script));
  return run_gnuplot(folder);
}

constexpr double kPrintedTacho = 0.632298;  ///< V s/rad, appendix A
constexpr double kStepDistance_mm = 10.0;
constexpr double kStepFeed_mm_min = 1200.0;  ///< 20 mm/s
constexpr double kMovingTravel_mm = 80.0;

/// Appendix A as it is printed. Its velocity loop is ten times as fast: it needs a finer step.
ServoParameters as_printed() {
  ServoParameters servo;
  servo.tacho_V_s_per_rad = kPrintedTacho;
  servo.step_s = 0.00002;
  return servo;
}

std::string step_csv(const ServoStep& step) {
  std::string text =
      fmt::format("# machine: single-axis test rig\n# feed_mm_min: {}\n# distance_mm: {}\ntime_s,dac_V\n",
                  kStepFeed_mm_min, kStepDistance_mm);
  for (std::size_t k = 0; k < step.time_s.size(); ++k)
    text += fmt::format("{:.5f},{:.6f}\n", step.time_s[k], step.dac_V[k]);
  return text;
}

std::string moving_csv(const MovingError& moving) {
  std::string text = "desired_mm,uncompensated_um,compensated_um,compensation_um\n";
  for (std::size_t k = 0; k < moving.desired_mm.size(); ++k)
    text += fmt::format("{:.4f},{:.4f},{:.4f},{:.4f}\n", moving.desired_mm[k], moving.uncompensated_um[k],
                        moving.compensated_um[k], moving.compensation_um[k]);
  return text;
}

struct Motion {
  std::vector<double> asked_mm, slide_mm, compensation_um;
};

/// @param injection  nothing: not compensated
Motion motion_of(const SlideErrors& errors, std::optional<Injection> injection, double feed_mm_min) {
  Rig rig(ServoParameters{}, errors, 0.0, 1);
  if (injection) {
    RigTables tables;
    tables.increment_mm = Rig::kPulse_um / errors.linear_um_per_mm;  // the travel over which the error grows by a pulse
    const auto last = static_cast<int>(kMovingTravel_mm / tables.increment_mm + 1.0);
    for (int k = 0; k <= last; ++k) {
      const double p = k * tables.increment_mm;
      tables.forward_um.push_back(-errors.linear_um_per_mm * p);
      tables.reverse_um.push_back(-errors.linear_um_per_mm * p);
    }
    rig.compensate_with(tables, Approach::forward, *injection);
  }
  Motion motion;
  int step = 0;
  rig.move_to(kMovingTravel_mm, feed_mm_min, 0.0, [&] {
    if (++step % 10 != 0) return;
    motion.asked_mm.push_back(rig.asked_mm());
    motion.slide_mm.push_back(rig.slide_mm());
    motion.compensation_um.push_back(rig.compensation_um());
  });
  return motion;
}

double largest(const std::vector<double>& values) {
  double most = 0.0;
  for (const double v : values) most = std::max(most, std::abs(v));
  return most;
}

/// One calibration with the compensation made from it, as figures 3.9 and 3.11 or 3.10 and 3.12.
struct BeforeAfter {
  laser::MeasurementSet before, after;
  RigBand band_before, band_after;
};

BeforeAfter calibrated_twice(const RigPlan& plan, std::uint64_t seed) {
  BeforeAfter both;
  const double start_mm = plan.from_mm;
  Rig bare({}, rig_slide_errors(), start_mm, seed_of(seed, 1, 0));
  both.before = calibrated(bare, plan, false);
  both.band_before = band_of(both.before);
  Rig rig({}, rig_slide_errors(), start_mm, seed_of(seed, 2, 0));
  rig.compensate_with(tables_of(both.band_before, plan), Approach::forward);
  both.after = calibrated(rig, plan, true);
  both.band_after = band_of(both.after);
  return both;
}

/// The three places of thesis 3.3, each also with a position loop whose gain is not what the unit was told.
void add_injections(std::vector<RigNumber>& numbers, const RigBand& before, RigPlan plan, std::uint64_t seed) {
  constexpr double kWrongGain = 1.1;
  constexpr std::array<std::pair<Injection, std::string_view>, 3> kPlaces{
      {{Injection::control_registers, "control registers"},
       {Injection::feedback, "feedback"},
       {Injection::velocity_command, "velocity command"}}};
  const RigTables tables = tables_of(before, plan);
  for (const auto& [injection, where] : kPlaces) {
    const auto add = [&numbers, place = where](std::string_view what, std::string_view unit, double here) {
      numbers.push_back({"3.1", fmt::format("{}: {}", place, what), std::string(unit), std::nullopt, here});
    };
    add("error band", "mm", band_with(tables, plan, injection, 1.0, seed).error_band_um * 1e-3);
    add("band, loop gain 10 % higher", "mm", band_with(tables, plan, injection, kWrongGain, seed).error_band_um * 1e-3);
    add("largest error moving", "um", largest(moving_error(kStepFeed_mm_min, injection).compensated_um));
  }
}

void add_band(std::vector<RigNumber>& numbers, const std::string& figure, const RigBand& band, double thesis_band_mm,
              std::optional<double> thesis_6s_mm) {
  numbers.push_back({figure, "error band, +/- 3 sigma", "mm", thesis_band_mm, band.error_band_um * 1e-3});
  numbers.push_back({figure, "non-repeatability, 6 sigma", "mm", thesis_6s_mm, band.non_repeatability_um * 1e-3});
}

void add_step(std::vector<RigNumber>& numbers, const ServoStep& step, const ServoStep& printed) {
  numbers.push_back({"3.3", "steady D/A output", "V", 3.0, step.steady_V});
  numbers.push_back({"3.3", "rise 10 to 90 %", "s", 0.074, step.rise_s});
  numbers.push_back({"3.3", "falls from", "s", 0.5, step.falls_from_s});
  numbers.push_back({"3.3", "largest D/A output with the printed Kw", "V", std::nullopt, printed.largest_V});
}

}  // namespace

ServoStep servo_step(const ServoParameters& servo, double distance_mm, double feed_mm_min, double length_s) {
  ServoStep step;
  ServoDrive drive(servo);
  const double speed_mm_s = feed_mm_min / 60.0;
  const double move_s = distance_mm / speed_mm_s;
  const auto steps = static_cast<std::uint64_t>(std::llround(length_s / servo.step_s));
  const auto kept = static_cast<std::uint64_t>(std::max(1LL, std::llround(0.0005 / servo.step_s)));
  double sum_V = 0.0, count = 0.0;
  for (std::uint64_t k = 1; k <= steps; ++k) {
    const double asked_mm = std::min(distance_mm, speed_mm_s * static_cast<double>(k) * servo.step_s);
    drive.step(asked_mm / servo.screw_mm_per_rad * servo.encoder_pulses_per_rad, 0.0);
    step.largest_V = std::max(step.largest_V, std::abs(drive.dac_V()));
    if (drive.time_s() > 0.7 * move_s && drive.time_s() < 0.98 * move_s) {
      sum_V += drive.dac_V();
      count += 1.0;
    }
    if (k % kept != 0) continue;
    step.time_s.push_back(drive.time_s());
    step.dac_V.push_back(drive.dac_V());
  }
  step.steady_V = count > 0.0 ? sum_V / count : 0.0;
  const auto first_above = [&](double part) {
    for (std::size_t k = 0; k < step.dac_V.size(); ++k)
      if (step.dac_V[k] >= part * step.steady_V) return step.time_s[k];
    return length_s;
  };
  step.rise_s = first_above(0.9) - first_above(0.1);
  for (std::size_t k = 0; k < step.dac_V.size(); ++k)
    if (step.dac_V[k] >= 0.98 * step.steady_V) step.falls_from_s = step.time_s[k];
  return step;
}

MovingError moving_error(double feed_mm_min, Injection injection) {
  SlideErrors wrong;
  wrong.linear_um_per_mm = 0.25;
  const Motion ideal = motion_of({}, std::nullopt, feed_mm_min);
  const Motion bare = motion_of(wrong, std::nullopt, feed_mm_min);
  const Motion compensated = motion_of(wrong, injection, feed_mm_min);
  MovingError moving;
  moving.desired_mm = ideal.asked_mm;
  for (std::size_t k = 0; k < ideal.slide_mm.size(); ++k) {
    moving.uncompensated_um.push_back((bare.slide_mm[k] - ideal.slide_mm[k]) * 1e3);
    moving.compensated_um.push_back((compensated.slide_mm[k] - ideal.slide_mm[k]) * 1e3);
    moving.compensation_um.push_back(compensated.compensation_um[k]);
  }
  return moving;
}

RigBand band_with(const RigTables& tables, const RigPlan& plan, Injection injection, double loop_gain,
                  std::uint64_t seed) {
  Rig rig({}, rig_slide_errors(), plan.from_mm, seed_of(seed, 2, 0));
  rig.compensate_with(tables, Approach::forward, injection, loop_gain);
  return band_of(calibrated(rig, plan, true));
}

Result<std::vector<RigNumber>> draw_rig_figures(const std::filesystem::path& folder, std::uint64_t seed) {
  std::error_code fault;
  std::filesystem::create_directories(folder, fault);
  if (fault) return problem(ProblemKind::output, "{}: {}", folder.string(), fault.message());
  RigPlan whole, fine;
  fine.from_mm = 16.0;  // two turns of the screw
  fine.step_mm = 0.2;
  const ServoStep step = servo_step({}, kStepDistance_mm, kStepFeed_mm_min, 1.0);
  const ServoStep printed = servo_step(as_printed(), kStepDistance_mm, kStepFeed_mm_min, 1.0);
  const MovingError moving = moving_error(kStepFeed_mm_min);
  const BeforeAfter full_travel = calibrated_twice(whole, seed);
  const BeforeAfter two_turns = calibrated_twice(fine, seed + 1);

  const std::vector<std::pair<std::string, std::string>> files{{"figure_3_3.csv", step_csv(step)},
                                                               {"figure_3_3_printed_kw.csv", step_csv(printed)},
                                                               {"figure_3_5.csv", moving_csv(moving)},
                                                               {"figure_3_9.csv", to_csv(full_travel.before)},
                                                               {"figure_3_10.csv", to_csv(two_turns.before)},
                                                               {"figure_3_11.csv", to_csv(full_travel.after)},
                                                               {"figure_3_12.csv", to_csv(two_turns.after)}};
  for (const auto& [name, text] : files) ECS_DO(write_file(folder / name, text));
  ECS_DO(draw_rig_pictures(
      folder, {&full_travel.band_before, &full_travel.band_after, &two_turns.band_before, &two_turns.band_after}));

  std::vector<RigNumber> numbers;
  add_injections(numbers, full_travel.band_before, whole, seed);
  add_step(numbers, step, printed);
  numbers.push_back(
      {"3.5", "largest error of the moving slide, compensated", "um", Rig::kPulse_um, largest(moving.compensated_um)});
  numbers.push_back({"3.5", "the same without compensation", "um", std::nullopt, largest(moving.uncompensated_um)});
  add_band(numbers, "3.9", full_travel.band_before, 0.261430, std::nullopt);
  add_band(numbers, "3.11", full_travel.band_after, 0.027505, 0.025052);
  numbers.push_back({"3.11", "largest reading before / after", ":1", 14.0,
                     full_travel.band_before.largest_reading_um / full_travel.band_after.largest_reading_um});
  add_band(numbers, "3.10", two_turns.band_before, 0.194117, std::nullopt);
  add_band(numbers, "3.12", two_turns.band_after, 0.041467, 0.036348);
  return numbers;
}

std::vector<std::string> rig_files(const std::filesystem::path& folder) {
  std::vector<std::string> files{folder / "figures.gp", folder / "figure_3_3_printed_kw.csv"};
  for (const char* figure : {"3_3", "3_5", "3_9", "3_10", "3_11", "3_12"})
    for (const char* ending : {"csv", "svg"}) files.push_back(folder / fmt::format("figure_{}.{}", figure, ending));
  for (const char* figure : {"3_9", "3_10", "3_11", "3_12"})
    files.push_back(folder / fmt::format("means_{}.dat", figure));
  return files;
}

std::string table_of(const std::vector<RigNumber>& numbers) {
  std::string text = fmt::format("{:<7} {:<46} {:>9} {:>9}\n", "figure", "", "thesis", "here");
  for (const RigNumber& n : numbers)
    text += fmt::format("{:<7} {:<46} {:>9} {:>9.3f} {}\n", n.figure, n.name,
                        n.thesis ? fmt::format("{:.3f}", *n.thesis) : "-", n.here, n.unit);
  return text;
}

namespace {

struct RigRequest {
  std::string folder;
  std::optional<std::uint64_t> seed;
  bool json = false, force = false;
  static Fields<RigRequest> fields() {
    using R = RigRequest;
    return {{"-o,--output", &R::folder, "folder for data (CSV) and pictures (SVG)", Need::required},
            {"--seed", &R::seed, "seed of the scatter (7)"},
            {"--force", &R::force, "overwrite existing files"},
            {"--json", &R::json, "write the numbers as JSON"}};
  }
};

nlohmann::json json_of(const std::vector<RigNumber>& numbers) {
  nlohmann::json list = nlohmann::json::array();
  for (const RigNumber& n : numbers)
    list.push_back({{"figure", n.figure},
                    {"name", n.name},
                    {"unit", n.unit},
                    {"thesis", n.thesis ? nlohmann::json(*n.thesis) : nlohmann::json()},
                    {"here", n.here}});
  return {{"numbers", list}};
}

Result<Outcome> draw_rig(VerbContext& /*context*/, const RigRequest& arguments) {
  ECS_DO(spared(rig_files(arguments.folder), arguments.force));
  ECS_TRY(numbers, draw_rig_figures(arguments.folder, arguments.seed.value_or(7)));
  return Outcome{arguments.json ? json_of(numbers).dump(2) : table_of(numbers), {}};
}

}  // namespace

extern const std::vector<Action> kRig{
    action("rig", "reproduce the thesis's single-axis rig: figures 3.3, 3.5, 3.9 to 3.12 with numbers",
           "ecs-emulator rig -o rig", draw_rig)};

const Module& rig_emulator_module() {
  static const Module module{{"program", &kRig}};
  return module;
}

}  // namespace ecs::emulator
