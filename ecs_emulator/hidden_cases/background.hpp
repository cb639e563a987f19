// The base model: errors that the engineer knows of already.
#pragma once

#include <vector>

#include "ecs_emulator/effects/designs.hpp"
#include "ecs_emulator/hidden_cases/space.hpp"

namespace ecs::emulator {

/// What the base model must leave alone.
struct Reserved {
  std::vector<PlacedEffect> hidden;
  std::vector<PlacedEffect> needed;  ///< places that it must hold
  bool free = false;                 ///< its nonlinear parameters are not given, and any effect may be in it
  Designs design = kNoDesign;        ///< effects excluded from it have no place in this base model
};

/// Share of an error's mean square that the base model must leave.
inline constexpr double kLeastShare = 0.05;

/// The effect that holds the mean and slope of a curve which has none itself.
[[nodiscard]] std::optional<PlacedEffect> line_of(const PlacedEffect& effect);

/// Draws it; sizes are about 1 um still. `absorbed` becomes what it can produce.
[[nodiscard]] std::vector<PlacedEffect> draw_background(Random& random, const Scene& scene, const Ground& ground,
                                                        const Reserved& reserved, Absorbed& absorbed);

}  // namespace ecs::emulator
