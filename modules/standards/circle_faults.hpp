// The faults that a circular test can show: each as columns of the radial deviation over angle and sense of rotation,
// with the decay lengths of reversal spikes where the readings want them, between those that the search tries.
// Does not live here: which of them a test does show (circle_diagnosis.hpp). Internal to this module (Eigen).
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "laser/circle_test.hpp"

namespace ecs::model {

/// Points of a circle as the columns need them.
struct CirclePoints {
  double radius_mm = 0.0;
  std::array<Axis, 2> plane{};
  Eigen::VectorXd angle;  ///< [rad]
  Eigen::VectorXd sense;  ///< +1 counter-clockwise, −1 clockwise
};

/// A fault at one axis, or of both, with fixed values of its nonlinear parameters. Coefficients in um.
struct CircleFault {
  std::string effect;       ///< "backlash"
  std::string where;        ///< "X", or "XY" where it is of both axes
  std::string title;        ///< "backlash of X"
  double nonlinear = 0.0;   ///< decay or period [mm]; 0: none
  Eigen::MatrixXd columns;  ///< (points × coefficients)
  double to_unit = 1.0;     ///< a coefficient times this is the fault's own quantity
  std::string quantity;     ///< what that is: "um", "um/m"
  std::string component{};  ///< of ISO 230-1 that it is, in the sign of docs/physics.md: "C0Y"; empty: none
  bool decay_free = false;  ///< the last column is the derivative by the logarithm of the decay, no part of the fault
  [[nodiscard]] std::string name() const { return effect + ":" + where; }
};

/// Effect of the faults whose decay is found from the readings.
inline constexpr const char* kReversalSpike = "reversal_spike";

/// Between which the decay of a spike is looked for.
struct DecayLimits {
  double least_mm = 0.0;     ///< travel over the step after the reversal: a shorter one would be a single reading
  double greatest_mm = 0.0;  ///< beyond, it is a backlash
};
[[nodiscard]] DecayLimits decay_limits(const CirclePoints& points);

/// A spike of 1 um of the first (0) or the second (1) axis, and its derivative by the logarithm of the decay.
[[nodiscard]] Eigen::MatrixXd spike_columns(const CirclePoints& points, std::size_t which, double decay_mm);

/// What is not a fault: centre and radius.
[[nodiscard]] Eigen::MatrixXd centring_columns(const CirclePoints& points);

// clang-format off
/// Every fault, with e_u and e_v the errors of the first and second axis at (u, v) = R (cos θ, sin θ), s = ±1 the sense
/// of rotation, so that Δr = e_u cos θ + e_v sin θ:
///   scale_mismatch   e_u = a u/2, e_v = −a v/2: a is the scale error of the first axis less that of the second
///   squareness       E_X = −C0Y·Y, E_X = +B0Z·Z or E_Y = −A0Z·Z, by the plane, which may name its axes in either order
///   servo_mismatch   e_u = −ẋ/Kv: Δr = k s sin θ cos θ, the ellipse at 45° that turns with the sense of rotation
///   backlash         e_u = b/2 · sign of motion
///   reversal_spike   e_u = c · sign of motion · exp(−travel since reversal/u0), u0 tried on a grid, then fitted
///   cyclic           e_u = A sin(2πu/P) + B cos(2πu/P), P a pitch of the axis
///   straightness     e_v = q (2(u/R)² − 1), the bow of axis u, the same as the progressive error of v
///   straightness_s   e_v = q (4(u/R)³ − 3 u/R), the S of axis u, the same as that of v
/// @param pitches_mm  of the first and the second axis
// clang-format on
[[nodiscard]] std::vector<CircleFault> circle_faults(const CirclePoints& points,
                                                     const std::array<std::vector<double>, 2>& pitches_mm);

/// Columns of spike `which` for a decay: the spike of 1 um and its derivative by the logarithm of the decay.
using SpikeColumns = std::function<Eigen::MatrixXd(std::size_t which, double decay_mm)>;

/// The decays with the least squares of what is left, beside other columns of any size: Gauss-Newton on the logarithms
/// of all decays at once. What the readings put at a limit stays there.
/// @param start_mm  one decay for each spike, within the limits
[[nodiscard]] std::vector<double> best_decays(const Eigen::VectorXd& deviation, const Eigen::MatrixXd& others,
                                              const SpikeColumns& columns, std::vector<double> start_mm,
                                              const DecayLimits& limits);

}  // namespace ecs::model
