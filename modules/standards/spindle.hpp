// Error motions of an axis of rotation (ISO 230-7:2015) from a recorded trace of a master ball or test bar: the file,
// the motions that its sensors show, and the form of the ball by reversal. Does not live here: the test of an axis that
// warms up (warm_up.hpp), the verb and its pictures (tests_of_spindle.cpp).
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"

namespace ecs::laser {

inline constexpr std::size_t kLeastSpindleTurns = 5;
inline constexpr std::size_t kLeastReadingsPerTurn = 32;

/// The sensors by their columns; x2 and y2 look at a second plane along the axis of rotation.
enum class SpindleSensor : std::size_t { x, y, z, x2, y2 };
inline constexpr std::array<std::string_view, 5> kSpindleColumns{"x_um", "y_um", "z_um", "x2_um", "y2_um"};

/// Readings over whole and broken turns, in the order of time.
struct SpindleTrace {
  std::string source;
  std::vector<double> turn{};                                          ///< turns since the first reading, never falling
  std::array<std::vector<double>, kSpindleColumns.size()> value_um{};  ///< of each sensor; empty: no such column
  double first_deg = 0.0;                                              ///< spindle angle of the first reading
  bool falling = false;                                                ///< the spindle turns toward falling angles
  bool has_origin = false;            ///< angles count from a mark of the spindle, not from the first reading
  std::optional<double> planes_mm{};  ///< distance of the second plane from the first, positive along the axis
  std::optional<double> noise_um{};   ///< standard deviation of the sensors with the spindle at rest
  std::optional<double> speed_rpm{};
  std::vector<std::string> notes{};

  [[nodiscard]] const std::vector<double>& of(SpindleSensor sensor) const {
    return value_um[static_cast<std::size_t>(sensor)];
  }
};

/// Reads one or more of the columns x_um, y_um (radial, along the axes X and Y of angles 0 and 90 degrees), z_um
/// (axial), and x2_um, y2_um below `# planes_mm: 100`. The angle comes from the first of these that is there:
/// `angle_deg`, 0 … 360 or counted on; `index`, not 0 where a turn begins, in rows of equal time or with `time_s`;
/// `time_s` below `# speed_rpm: 3000`, corrected by the once-per-turn motion. `# noise_um: 0.02` and, with the first
/// two, `# speed_rpm:` are optional. Refuses, with line and column: fewer turns or readings a turn than the least,
/// jumps of the angle, a direction that reverses, uneven pulses, a sensor that does not change or stays at its greatest
/// or least value (out of range).
[[nodiscard]] Result<SpindleTrace> parse_spindle_trace(std::string_view text, const std::string& file_name);

/// A part that comes a whole number of times per turn: amplitude · cos(per_turn · (angle − at_deg)).
struct SpindleWave {
  int per_turn = 0;
  double amplitude = 0.0;
  double sigma = 0.0;   ///< standard uncertainty of the amplitude, from its scatter over the turns
  double at_deg = 0.0;  ///< an angle at which it is greatest, 0 … 360 / per_turn
};

/// What asynchronous and synchronous values noise alone is expected to give (`largest_range_of_noise`).
struct SpindleNoise {
  double rms = 0.0;
  double asynchronous = 0.0;
  double synchronous = 0.0;
};

/// One error motion [um; tilt um/m]. Its values are widths about one centre: of radial and tilt motions that of least
/// squares (LSC), of axial motion the mean (PC). A displacement is small against the ball, so that a centre is a·cos +
/// b·sin; what is neglected is eccentricity² / (2 · radius), 0.016 um for 20 um and a ball of 25 mm in diameter.
struct SpindleMotion {
  std::string id{};     ///< radial_x, radial_y, radial_rotating, axial, tilt_x, tilt_y, tilt_rotating
  std::string title{};  ///< "radial, fixed direction X"
  bool is_radial = true;
  bool is_fixed = true;  ///< sensitive direction: fixed, else rotating with the spindle
  bool is_tilt = false;
  double total = 0.0;                 ///< all turns
  double synchronous = 0.0;           ///< mean of the turns
  double synchronous_zone = 0.0;      ///< the same about the centre of minimum radial separation (MRS); radial and tilt
  double asynchronous = 0.0;          ///< largest range of the turns at one angle
  double asynchronous_deg = 0.0;      ///< that angle
  double asynchronous_drift = 0.0;    ///< asynchronous value if the drift were not removed
  double asynchronous_rms = 0.0;      ///< deviation of the turns from their mean, N − 1 degrees of freedom an angle
  double residual_synchronous = 0.0;  ///< axial: without what comes once per turn
  /// Once per turn: eccentricity of the ball (fixed direction, radial), removed; of axial motion half the fundamental
  /// axial error motion value, kept in `synchronous`.
  SpindleWave once{};
  std::vector<SpindleWave> waves{};  ///< 2 … 8 per turn, of the mean of the turns
  std::vector<double> turn_means{};  ///< of each turn from that of the first: drift; none for rotating directions
  std::optional<double> drift{};     ///< last turn from the first on the parabola that is removed; none likewise
  SpindleNoise if_noise{};           ///< all asynchronous motion taken for random noise
  std::optional<SpindleNoise> of_sensor{};   ///< the stated noise of the sensors
  std::vector<double> angle_deg{};           ///< of the columns below, in the order of rotation, 0 … 360
  std::vector<double> mean{};                ///< synchronous error motion
  std::vector<std::vector<double>> turns{};  ///< total error motion: (turns × angles)
};

struct SpindleTest {
  std::string source{};
  std::size_t turns = 0, angles = 0;  ///< whole turns that were evaluated, angles in each
  bool falling = false, has_origin = false;
  std::optional<double> speed_rpm{};
  std::vector<SpindleMotion> motions{};
  std::vector<std::string> notes{};
};

/// The total error motion is what remains of a trace when its sensor's zero, the eccentricity and the drift are
/// removed: a parabola of least squares through the means of the turns, which leaves what varies from turn to turn.
/// Motion slower than about the whole recording counts as drift. A rotating direction is x·cos + y·sin, tilt (second −
/// first) / planes.
[[nodiscard]] SpindleTest spindle_test_of(const SpindleTrace& trace);

/// Expected largest range of `draws` normal readings of deviation 1 over `places` independent places: the asynchronous
/// value of noise over that many turns and angles. Distribution of the range: Tippett (1925).
[[nodiscard]] double largest_range_of_noise(std::size_t draws, std::size_t places);

/// Donaldson (1972): a second recording with ball and sensor turned by 180 degrees about the spindle axis. The ball
/// adds to both with one sign and the spindle with two: ball = (first + second) / 2, spindle = (first − second) / 2.
struct SpindleSeparation {
  std::string id{};                                        ///< radial_x or radial_y
  double synchronous_um = 0.0, synchronous_zone_um = 0.0;  ///< of the spindle alone: LSC, MRS
  double form_um = 0.0, form_zone_um = 0.0;                ///< roundness of the ball: LSC, MRS
  double sigma_um = 0.0;  ///< standard uncertainty of either curve at one angle, if asynchronous motion is random
  std::vector<double> angle_deg{}, spindle_um{}, ball_um{};
};

/// Of the fixed directions that both have. Refuses recordings without a common origin of the angle or direction of
/// rotation, or without a common sensor.
[[nodiscard]] Result<std::vector<SpindleSeparation>> separated(const SpindleTest& first, const SpindleTest& second);

}  // namespace ecs::laser
