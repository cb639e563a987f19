// The quantities of a circular test: ISO 230-4:2005, 3.3 to 3.7, and the circular hysteresis of ISO 230-4:1996; its
// file. Does not live here: the causes of what they show (modules/standards/circle_diagnosis.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "laser/circle_test.hpp"

namespace ecs::laser {

/// A part of a pass with a zero of the instrument of its own, such as a half circle.
struct CirclePart {
  int part = 1;
  double zero_um = 0.0;              ///< less that of the first part; taken off
  std::optional<double> sigma_um{};  ///< standard uncertainty of it, from several common angles
};

/// One contouring motion.
struct CirclePass {
  bool clockwise = false;
  int run = 1;
  std::vector<CircleReading> readings;  ///< by rising angle, with the zero of the first part
  std::vector<CirclePart> parts;        ///< empty: the pass has one zero
  /// Readings at angles that two parts share, which give the zeros. 0: too few for all parts; the zeros are then those
  /// of the least squares circle, and a constant difference of an error between the parts is not seen.
  std::size_t common = 0;
  double G_um = 0.0;      ///< circular deviation: separation of the minimum zone circles
  double F_max_um = 0.0;  ///< radial deviations about the least squares centre
  double F_min_um = 0.0;
  double mean_um = 0.0;               ///< radius of the least squares circle less the nominal radius
  std::array<double, 2> centre_um{};  ///< of least squares, along the first and the second axis
};

/// A pass each way, the same run of each.
struct CirclePair {
  int clockwise_run = 1;
  int counter_clockwise_run = 1;
  double G_um = 0.0;  ///< bidirectional circular deviation G(b): minimum zone circles that hold both paths
  double D_um = 0.0;  ///< mean bidirectional radial deviation: least squares circle of both paths less nominal radius
  /// Circular hysteresis: greatest radial difference between the paths at one angle, both about `centre_um` (ISO
  /// 230-4:1996).
  double H_um = 0.0;
  double H_at_deg = 0.0;
  std::array<double, 2> centre_um{};  ///< of least squares of both paths together
};

struct CircleValues {
  std::vector<CirclePass> passes;  ///< counter-clockwise first, by run
  std::vector<CirclePair> pairs;   ///< empty where one direction only was measured
  bool with_other_zeros = false;  ///< directions whose parts have other numbers make no pair: their zeros are unrelated
};

/// F is given about the least squares centre of each path, which ISO 230-4 allows for full circles. What compares both
/// paths, G(b), D and H, has one centre for both: a centre that moves with the direction is a deviation of the machine.
[[nodiscard]] CircleValues circle_values_of(const CircleTest& test);

/// Deviation of a pass at an angle about a centre, linear between its readings about that centre [um].
[[nodiscard]] double deviation_at(const CirclePass& pass, double angle_deg, const std::array<double, 2>& centre_um);

/// The same direction within 0 … 360.
[[nodiscard]] double folded_deg(double angle_deg);

/// A pass with a wider gap is no circle; figure 7.22 of the thesis has a reading every 10 degrees.
inline constexpr double kWidestGap_deg = 15.0;

/// Reads `angle_deg,deviation_um,direction` (cw or ccw) and, where there are several, `run`, below `# plane: XY` (two
/// axes, the first at 0 and the second at 90 degrees) and `# radius_mm: 150`; `feed_mm_min`, `start_angle_deg` and
/// `centre_x_mm` … are optional. With a column `part` each number is a zero of the instrument
/// in a run, for both directions. Counter-clockwise is the sense of rising angle. Refuses, with line and column: no
/// plane, no radius, a direction that is missing, an open circle (no reading over more than 15 degrees, the pass is
/// named), deviations of a millimetre and more.
[[nodiscard]] Result<CircleTest> parse_circle_test(std::string_view text, const std::string& file_name);

}  // namespace ecs::laser
