// Where an effect can sit on a given ground, and its shape there: drawn, of size one, over what it depends on.
// Does not live here: how large effects are made (modules/hidden_cases).
#pragma once

#include "ecs_emulator/effects/definition.hpp"

namespace ecs::emulator {

[[nodiscard]] std::vector<PlacedEffect> possible_places(const Scene& scene, const Ground& ground,
                                                        const EffectDefinition& kind);
[[nodiscard]] std::vector<PlacedEffect> good_places(const Scene& scene, const Ground& ground,
                                                    const EffectDefinition& kind);

[[nodiscard]] PlacedEffect at_place(const EffectDefinition& kind, std::optional<Axis> axis, std::optional<Sense> sense,
                                    std::optional<Component> code = {});
/// The sense is the translation along the axis.
[[nodiscard]] bool is_along(Sense sense, Axis axis);
/// The data tell the approaches of this axis apart.
[[nodiscard]] bool shows_approach(const PlaceSearch& search, Sense sense, Axis axis);
/// The data hold temperature, pressure and humidity of the air.
[[nodiscard]] bool shows_air(const PlaceSearch& search);

/// May it sit there, over what every effect of an axis asks for?
using Admits = bool (*)(const PlaceSearch&, Sense, Axis);

/// Every axis in every sense, where it has places enough.
[[nodiscard]] std::vector<PlacedEffect> on_axes(const PlaceSearch& search, Admits admits);
[[nodiscard]] std::vector<PlacedEffect> on_all_axes(const PlaceSearch& search);
/// The same, and an axis that stands still if it is the natural one of the sense.
[[nodiscard]] std::vector<PlacedEffect> on_axes_or_parked(const PlaceSearch& search);
/// Each sense at its natural axis.
[[nodiscard]] std::vector<PlacedEffect> on_senses(const PlaceSearch& search);
/// The whole map, all of one axis, or one curve: each where it is not the same as a smaller part.
[[nodiscard]] std::vector<PlacedEffect> in_map(const PlaceSearch& search);

/// Coordinates of a lever that readings of the sense have, less the measurement line; ascending, each once.
[[nodiscard]] std::vector<double> levers_mm(const Scene& scene, const Ground& ground, Sense sense, Component code);
/// Fewer targets do not show a curve or a slope.
inline constexpr std::size_t kFewTargets = 6;

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
