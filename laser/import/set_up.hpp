// What is done to readings once they are read: the set-up of a workpiece on the machine that measured it (the six
// freedoms of a rigid body between nominal and measured positions) taken out, those at rest taken, or their means. Does
// not live here: measured positions as columns of a table (rows.hpp), joining the channels of a log (channels.hpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/axis.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::laser {

/// measured = nominal + shift + rotation × (nominal − centre), for rotations of any size
struct RigidSetUp {
  Vector3 centre_mm{};      ///< of the nominal positions
  Vector3 shift_um{};       ///< of the centre
  Vector3 rotation_um_m{};  ///< about X, Y, Z: the rotation vector; 0 about an axis that the positions do not tell
  int rotations = 3;        ///< that the positions tell: 0 of a single point, 2 of points on a line
  std::array<Vector3, kAxes> matrix{};  ///< rows of the rotation
};

/// The rotation and shift that bring the nominal positions nearest to the measured ones (least squares; K. S. Arun,
/// T. S. Huang, S. D. Blostein, IEEE PAMI 9 (1987) 698; S. Umeyama, IEEE PAMI 13 (1991) 376, keeps it a rotation where
/// the points lie in a plane). Nothing for fewer than two points.
/// @pre nominal_mm.size() == measured_mm.size()
[[nodiscard]] std::optional<RigidSetUp> rigid_set_up(const std::vector<Vector3>& nominal_mm,
                                                     const std::vector<Vector3>& measured_mm);

/// What the set-up makes of the error at a nominal position [um].
[[nodiscard]] Vector3 set_up_error_um(const RigidSetUp& set_up, const Vector3& nominal_mm);

/// Takes the set-up out of the readings EX, EY, EZ that rows of a file give at one place: each row with two or three of
/// them is a point. A note tells shift, rotation, and the rms before and after. Where the rows lack a direction, its
/// error counts as 0 for the fit.
void take_out_set_up(MeasurementSet& set);

/// Keeps the readings of each axis and sense that stand in a stretch of three or more, one after the other, whose
/// positions lie within `at_rest_mm` of the first of them; with `average` a stretch becomes one reading at its mean
/// position, its error, time, conditions and numbers the means, with `readings_averaged` and `scatter` (standard
/// deviation) beside. Absent: readings at the same place, how many they are, make a stretch. The notes say how many
/// readings were left out and averaged.
void keep_at_rest(MeasurementSet& set, std::optional<double> at_rest_mm, bool average);

/// Keeps the readings of a scan taken while the moving axis goes on by at least half its usual step from the reading of
/// the same axis and sense before (the usual step is the median of all that are not 0): neither rests nor the ends of a
/// stroke. Where there are times, slower readings are kept down to a twentieth, and all get their speed: they tell a
/// delay from lost motion. A note states how many readings were left out.
void keep_in_motion(MeasurementSet& set);

/// Gives each reading the speed of its moving axis (`speed_column`), from the positions and times of the readings of
/// the same axis and sense before and behind it, and of a position the slope of its channel (kReadingSlopeColumn) where
/// the noise allows. Does nothing unless every reading has a time and the median interval
/// is at most `longest_interval_s`.
void take_speed(MeasurementSet& set, double longest_interval_s);
/// Readings closer than this are of a scan: no axis moves, comes to rest and is read within it.
inline constexpr double kIntervalOfScan_s = 0.5;

}  // namespace ecs::laser
