// The true errors of rotary axes A, B, C: error motions over their angle and the place of their axis lines (ISO 230-7),
// as the errors file gives them. No unit compensates them.
// Does not live here: how they add up at the tool (kinematics.hpp).
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/axis.hpp"
#include "ecs_emulator/effects/definition.hpp"
#include "ecs_emulator/errors/formula.hpp"

namespace ecs::emulator {

/// All that they may depend on.
struct RotaryState {
  Vector3 angle_deg{};  ///< of A, B, C
  PerAxis<Approach> approach{Approach::forward, Approach::forward, Approach::forward};
  double time_s = 0.0;
};

using SixOfAxis = std::array<double, 6>;  ///< by sense: EX EY EZ [um], EA EB EC [um/m]

struct RotaryValues {
  PerAxis<SixOfAxis> motion{};    ///< of A, B, C at their angles
  PerAxis<SixOfAxis> location{};  ///< XO., YO., ZO., AO., BO., CO.
};

/// One error motion: a curve over the angle, or an effect of the emulator's list with degrees in place of mm.
struct RotaryMotion {
  std::size_t axis = 0;  ///< A, B, C
  Sense sense = Sense::EX;
  std::optional<ErrorCurve> curve;
  std::optional<PlacedEffect> effect;
  int line = 0;  ///< of its table
};

struct RotaryParts {
  PerAxis<SixOfAxis> location{};
  std::vector<RotaryMotion> motions;
  PerAxis<int> line{};  ///< of a table that names the axis; 0: none does
};

[[nodiscard]] RotaryValues values_of(const RotaryParts& parts, Variables& variables, const RotaryState& state);

/// "EXC", "EAB"
[[nodiscard]] std::string rotary_name(std::size_t axis, Sense sense);
/// "XOC", "AOB"
[[nodiscard]] std::string location_name(std::size_t axis, std::size_t letter);

}  // namespace ecs::emulator
