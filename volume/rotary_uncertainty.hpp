// How certain the volume of a machine with rotary axes is: the uncertainty of the map (uncertainty.hpp) at every angle,
// and that of the errors of the rotary axes. Linearly (JCGM 100:2008, 5.2.2) and by drawing (JCGM 101:2008).
#pragma once

#include <random>
#include <vector>

#include "volume/rotary_errors.hpp"
#include "volume/uncertainty.hpp"

namespace ecs::volume {

/// Standard uncertainties (k = 1) of an error motion [um, um/m].
struct MotionUncertainty {
  kinematics::Joint joint = kinematics::Joint::C;
  Sense sense = Sense::EX;
  std::array<const RotaryTable*, 2> table{};   ///< by side; null: not given
  std::array<std::vector<double>, 2> value{};  ///< of each value of it, independent of the others
  double unmeasured = 0.0;                     ///< where no table is given: one and two waves a turn, from both sides
};

struct RotaryBudget {
  std::vector<MotionUncertainty> motions;
  std::array<std::array<double, 6>, kAxes> location{};  ///< of A, B, C: XO. … CO., without what ties add
  std::vector<LocationTie> ties{};
};

/// What the file of errors states; values without a statement get the roughness of their table, or
/// settings.repeatability; what nobody gave and location errors without a statement settings.declared_zero.
/// @param rotary  outlives the answer
[[nodiscard]] RotaryBudget rotary_budget_of(const RotaryAxes& rotary, const UncertaintySettings& settings);

/// Of the error vector at a place and a setting of the rotary axes, counted from the reference and its angles.
/// @pre machine.rotary
[[nodiscard]] Covariance covariance_at(const CompensatedMachine& machine, const UncertaintyBudget& budget,
                                       const RotaryBudget& rotary, const Vector3& position_mm,
                                       const kinematics::Angles& angles_deg, std::size_t side);

/// Draws errors of rotary axes: deviations from what is given.
class RotaryDraws {
 public:
  /// @param budget  outlives the draws
  RotaryDraws(const RotaryBudget& budget, std::uint64_t seed);
  [[nodiscard]] RotaryErrors next();

 private:
  const RotaryBudget& budget_;
  std::mt19937_64 generator_;
};

/// √(mean squared standard uncertainty of the error vector) over places and settings, by linear propagation [um].
[[nodiscard]] double linear_rms_um(const CompensatedMachine& machine, const UncertaintyBudget& budget,
                                   const RotaryBudget& rotary);

/// As uncertainty_of() of three axes, over the settings as well. @pre machine.rotary
[[nodiscard]] Result<VolumeUncertainty> uncertainty_of(const CompensatedMachine& machine,
                                                       const UncertaintyBudget& budget, const RotaryBudget& rotary,
                                                       const UncertaintySettings& settings, std::size_t places);

}  // namespace ecs::volume
