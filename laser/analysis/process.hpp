// What is done to error curves before they become a map: slope, datum, smoothing, angles from two lines, squareness,
// grids (thesis 5.3, 6.3.2). Does not live here: averaging readings into curves (curve.hpp), maps
// (laser/map/error_map.hpp).
#pragma once

#include <optional>
#include <vector>

#include "base/result.hpp"
#include "core/axis.hpp"
#include "laser/analysis/curve.hpp"

namespace ecs::laser {

// ---- slope and datum -------------------------------------------------------------------------------------------

/// value(p) = offset + slope · p. The value in um (um/m), the slope in um/m (um/m per m for a rotation).
struct Line {
  double offset = 0.0;  ///< at position 0
  double slope_per_m = 0.0;
  friend bool operator==(const Line&, const Line&) = default;
};
[[nodiscard]] double value_at(const Line& line, double position_mm);

enum class SlopeMethod {
  none,           ///< positioning and angular errors keep their slope
  end_points,     ///< through the means at the first and the last target
  least_squares,  ///< through the means at all targets, equal weights
};

/// A curve without its slope, and what was removed: the slope serves squareness (`squareness_of`).
struct Levelled {
  Curve curve;
  SlopeMethod method = SlopeMethod::none;
  Line removed;
  std::optional<double> slope_std_error_per_m;  ///< least squares: from the residuals (3 points or more); end points:
                                                ///< from the scatter of the readings there, where known
};

/// The line goes through the means of both approaches and is taken from both, so the reversal error stays as it is.
/// `refused` if fewer than two targets have a mean.
[[nodiscard]] Result<Levelled> levelled(const Curve& curve, SlopeMethod method);

/// A curve whose bidirectional mean is zero at the datum.
struct Zeroed {
  Curve curve;
  double removed = 0.0;  ///< the mean at the datum, um or um/m
};

/// The mean at the datum is interpolated linearly; `refused` if the datum lies outside the measured travel.
[[nodiscard]] Result<Zeroed> zeroed_at(const Curve& curve, double datum_mm);

// ---- smoothing -------------------------------------------------------------------------------------------------

/// Local quadratic regression (Savitzky-Golay on any spacing): each value becomes that of the least-squares parabola
/// through the points of a window round it; near the ends the window keeps its width and moves inwards.
struct Smoothing {
  std::optional<double> window_mm;   ///< full width; one of the two is needed
  std::optional<int> window_points;  ///< number of points
  bool common = false;               ///< false: forward and reverse each; true: their mean and the reversal error
  std::optional<double> reversal_window_mm;  ///< with `common`: another width for the reversal error
                                             ///< (of no effect where the approach is unknown)
  std::optional<int> reversal_window_points;
};

/// Whether what smoothing took away is noise, judged by the scatter of repeats.
enum class Taken {
  noise,    ///< no more than repeats explain (F below its 99 % point)
  signal,   ///< more: form of the curve was taken too; the window is too wide
  unknown,  ///< no repeats to judge by
};

struct Smoothed {
  Curve curve;
  double removed_rms = 0.0;   ///< of before − after, all points and approaches
  double removed_peak = 0.0;  ///< largest size of it
  double removed_peak_position_mm = 0.0;
  std::optional<double> noise_rms;  ///< rms standard error of the means, from repeats
  std::optional<double> F;          ///< removed variance per degree of freedom over that of the means
  std::optional<double> F_99;       ///< 99 % point of F if noise alone is removed (Wilson-Hilferty approximation)
  Taken taken = Taken::unknown;
};

/// `refused` if a window holds fewer than 4 points anywhere (a parabola through 3 removes nothing), or with `common` if
/// a target lacks an approach; `usage` if the window is not given or not above 0.
[[nodiscard]] Result<Smoothed> smoothed(const Curve& curve, const Smoothing& how);

// ---- angles and squareness -------------------------------------------------------------------------------------

/// The rotation that explains the difference of two translations measured along the same axis on two lines:
/// yaw EBX = (E_X(z1) − E_X(z2))/(z1 − z2), EAY = −(E_Y(z1) − E_Y(z2))/(z1 − z2), and every other direction and lever
/// by the sign of ε × r (thesis 6.3.2.3, with its brackets). Values um/m, at the targets of `first` inside the overlap;
/// `second` is interpolated where its targets differ. The angle's own zero is unknown: it stands at the lasers' zeros.
/// `refused` with the reason: other axis, sense or a rotation; parked positions that differ in no or several axes, or
/// along the sense; fewer than two targets in common.
[[nodiscard]] Result<Curve> rotation_from(const Curve& first, const Curve& second);

struct Squareness {
  Component component = Component::C0Y;
  double um_per_m = 0.0;  ///< positive as in the rigid-body model: E_X = −C0Y·Y + B0Z·Z, E_Y = −A0Z·Z
  std::optional<double> std_error_um_per_m;  ///< from the residuals of the straight line; 3 targets or more
  double indicator_slope_um_per_m = 0.0;     ///< least squares through the means
};

/// Squareness from an indicator run along one axis over a square that was aligned with another (thesis 6.3.2.4).
/// The curve's axis is the one run along, its sense the direction of the reference axis: E_X along Y (or E_Y along X)
/// gives C0Y = −slope, E_X along Z (E_Z along X) B0Z = +slope, E_Y along Z (E_Z along Y) A0Z = −slope. `refused` for a
/// rotation, for the axis's own direction, and for fewer than two targets.
[[nodiscard]] Result<Squareness> squareness_of(const Curve& indicator);

// ---- grids -----------------------------------------------------------------------------------------------------

/// Positions start + k · increment, k = 0 … count − 1.
struct Grid {
  double start_mm = 0.0;
  double increment_mm = 0.0;  ///< above 0
  int count = 0;              ///< 1 … 1 000 000
  friend bool operator==(const Grid&, const Grid&) = default;
};

/// What stands beyond the measured travel.
enum class Beyond { refuse, hold_end_value };

/// The curve at the points of a grid, each approach interpolated linearly between its own targets. Grid points within
/// the merge tolerance of a target take its values and statistics; others the smaller counts and the interpolated
/// standard deviations of their neighbours. `refused` outside the measured travel unless ends are held, `usage` for a
/// wrong grid.
[[nodiscard]] Result<Curve> resampled(const Curve& curve, const Grid& grid, Beyond beyond = Beyond::refuse);

}  // namespace ecs::laser
