// The shape of an effect at its place: drawn, of size one, over what it depends on.
// Does not live here: how large effects are made (ecs_emulator/hidden_cases).
#pragma once

#include "ecs_emulator/effects/definition.hpp"

namespace ecs::emulator {

/// Draws the shape of an effect at its place; size about 1 um. Nothing where the stops are too few to show one.
[[nodiscard]] std::optional<PlacedEffect> with_shape(Random& random, const Scene& scene, const Ground& ground,
                                                     PlacedEffect effect);

/// Effects of size one whose contributions span all that the effect can produce at its nonlinear parameters.
[[nodiscard]] std::vector<PlacedEffect> unit_effects(const Ground& ground, const PlacedEffect& effect);

/// The effect at each value at which its nonlinear parameter is tried; the effect itself where it has none.
[[nodiscard]] std::vector<PlacedEffect> trials_of(const Scene& scene, const Ground& ground, PlacedEffect effect);

/// A curve, or a nonlinear parameter that is searched.
[[nodiscard]] bool is_flexible(const EffectDefinition& kind);
/// Its contribution has the same sign whatever its parameter.
[[nodiscard]] bool has_one_sign(const EffectDefinition& kind);

/// The places that a curve of this effect runs over.
[[nodiscard]] const std::vector<double>& places_under(const Ground& ground, const PlacedEffect& effect);
/// Draws a curve without mean and slope over the readings on which the effect acts (least squares).
void draw_curve_without_line(const Drawing& drawing, PlacedEffect& effect);

}  // namespace ecs::emulator
