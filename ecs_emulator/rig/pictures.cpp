#include "ecs_emulator/rig/pictures.hpp"

#include <array>
#include <cerrno>
#include <cstring>

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/file.hpp"

namespace ecs::emulator {
namespace {

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
set title 'Moving slide: error 0.25 um/mm, compensation in steps of one pulse (2 um)'
set xlabel 'desired position (mm)'
set ylabel 'deviation (um)'
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
set ylabel 'error (um)'
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
  if (fault != 0) return problem(ProblemKind::output, fmt::format("gnuplot: {}", std::strerror(fault)));
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (status != 0) return problem(ProblemKind::output, fmt::format("gnuplot failed on {}/figures.gp", folder.string()));
  return {};
}

}  // namespace

Result<void> draw_rig_pictures(const std::filesystem::path& folder, const RigPictures& pictures) {
  const std::array<Calibration, 4> calibrations{
      {{"3_9", "Slideway calibration, 4 mm steps", pictures.full_before, 280.0},
       {"3_11", "With compensation in both directions", pictures.full_after, 280.0},
       {"3_10", "Slideway calibration, 0.2 mm steps", pictures.turns_before, 280.0},
       {"3_12", "With compensation over 2 revolutions", pictures.turns_after, 280.0}}};
  std::string script =
      "set terminal svg size 900,520 enhanced font 'sans,13' background rgb 'white'\n"
      "set datafile separator ','\nset grid lc rgb '#d0d0d0'\n" +
      servo_commands() + "set datafile separator whitespace\n";
  for (const Calibration& c : calibrations) {
    script += calibration_commands(c);
    if (const auto written = write_file(folder / fmt::format("means_{}.dat", c.figure), means_of(*c.band)); !written)
      return written;
  }
  if (const auto written = write_file(folder / "figures.gp", script); !written) return written;
  return run_gnuplot(folder);
}

}  // namespace ecs::emulator
