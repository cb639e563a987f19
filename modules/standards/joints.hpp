// The axis about which a joint of a robot or a table turns, from points x, y, z that an instrument read at angles of
// the joint (circle point analysis: Mooring, Roth and Driels 1991, Fundamentals of Manipulator Calibration, chapter 4):
// the line of the axis, what the points leave beside a circle, and how the axes of two joints lie to each other. Does
// not live here: rotary axes with a ball at known places (docs/five_axes.md), poses reached repeatedly (poses.hpp).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "core/axis.hpp"

namespace ecs::laser {

struct JointReading {
  double angle_deg = 0.0;  ///< commanded
  Vector3 point_mm{};      ///< in the frame of the instrument
};

/// All readings of one joint, in the order of the file; the other joints stood still.
struct JointSweep {
  std::string joint;
  std::vector<JointReading> readings;
};

/// Rows `joint, angle_deg, x_mm, y_mm, z_mm`. Sweeps in the order of their first rows. Refused, with line and column: a
/// missing column, no number, an empty name, fewer than five angles of a joint or less than 10 degrees between them.
[[nodiscard]] Result<std::vector<JointSweep>> parse_joints(std::string_view text, const std::string& file_name);

/// Uncertainties are standard ones (k = 1), from what the points leave beside the circle. Errors of the angle are
/// measured less commanded, without their mean: an instrument does not know where the joint has its zero.
struct JointAxis {
  std::string joint;
  std::size_t points = 0;
  double from_deg = 0.0, to_deg = 0.0;
  Vector3 centre_mm{};  ///< of the circle: a point of the axis
  double centre_u_mm = 0.0;
  Vector3 direction{};  ///< unit vector; the angle grows right-handed about it
  double direction_u_um_per_m = 0.0;
  double radius_mm = 0.0, radius_u_mm = 0.0;
  double radial_rms_um = 0.0, axial_rms_um = 0.0;
  double angle_rms_um_per_m = 0.0;
  double largest_angle_um_per_m = 0.0, largest_at_deg = 0.0;
  /// Mean of the angle reached upwards less that reached downwards, over the angles reached both ways.
  std::optional<double> reversal_um_per_m{};
  /// Largest distance of two points a whole turn apart.
  std::optional<double> closure_um{};
};

/// Refused: points that lie in one place or on a line, or whose order around the circle is not that of the angles.
[[nodiscard]] Result<JointAxis> joint_axis_of(const JointSweep& sweep, const std::string& file_name);

/// Two lines in space. Of axes within a degree of parallel the distance is that of the second centre from the first
/// axis, since their common normal is not determined.
struct AxesOfJoints {
  std::string first, second;
  double angle_deg = 0.0;    ///< between the directions, 0 to 180
  double distance_mm = 0.0;  ///< along the common normal
  bool is_parallel = false;
};
[[nodiscard]] AxesOfJoints between(const JointAxis& first, const JointAxis& second);

}  // namespace ecs::laser
