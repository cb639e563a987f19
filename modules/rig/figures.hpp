// Figures 3.3, 3.5 and 3.9 to 3.12 of the thesis from the rig, with their numbers beside the printed ones.
// Does not live here: the rig and its calibration (rig.hpp).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "modules/rig/rig.hpp"

namespace ecs::emulator {

/// One number of a figure.
struct RigNumber {
  std::string figure;  ///< "3.9"
  std::string name;
  std::string unit;
  std::optional<double> thesis;  ///< as printed; absent: not given
  double here = 0.0;
};

/// A step of the servo: D/A output against time (figures 3.3, 3.4).
struct ServoStep {
  std::vector<double> time_s;
  std::vector<double> dac_V;
  double steady_V = 0.0;
  double rise_s = 0.0;        ///< 10 to 90 % of the steady level
  double falls_from_s = 0.0;  ///< last time before the fall at which it stood at the steady level
  double largest_V = 0.0;
};
[[nodiscard]] ServoStep servo_step(const ServoParameters& servo, double distance_mm, double feed_mm_min,
                                   double length_s);

/// Error of the moving slide with and without compensation (figure 3.5), the motion itself taken off.
struct MovingError {
  std::vector<double> desired_mm;
  std::vector<double> uncompensated_um;
  std::vector<double> compensated_um;
  std::vector<double> compensation_um;  ///< what the unit adds
};
[[nodiscard]] MovingError moving_error(double feed_mm_min);

/// Runs all experiments; writes each figure's data as CSV and, where gnuplot is installed, its picture as SVG.
/// @return the numbers
[[nodiscard]] Result<std::vector<RigNumber>> draw_rig_figures(const std::filesystem::path& folder, std::uint64_t seed);

/// The files that draw_rig_figures writes into a folder, pictures too.
[[nodiscard]] std::vector<std::string> rig_files(const std::filesystem::path& folder);

/// The numbers as a table for a terminal.
[[nodiscard]] std::string table_of(const std::vector<RigNumber>& numbers);

}  // namespace ecs::emulator
