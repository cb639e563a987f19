// Which effects can sit where on a given ground, and drawing their shapes.
// Does not live here: how large they are made (case.cpp).
#pragma once

#include <array>
#include <vector>

#include "ecs_emulator/hidden_cases/contribution.hpp"
#include "ecs_emulator/random/random.hpp"

namespace ecs::emulator {

/// What the stops of a scene cover.
struct Ground {
  struct Cover {
    bool moved = false;             ///< the axis is moved in readings of the sense
    bool both_ways = false;         ///< and comes from both sides
    std::vector<double> places_mm;  ///< coordinates in readings of the sense, from the datum, ascending, each once
  };
  std::array<PerAxis<Cover>, 6> covers{};  ///< [sense][axis]
  std::vector<Sense> senses;

  [[nodiscard]] const Cover& cover(Sense sense, Axis axis) const {
    return covers[static_cast<std::size_t>(sense)][index_of(axis)];
  }
  /// The only axis moved in readings of the sense, else the sense's own.
  [[nodiscard]] Axis natural_axis(Sense sense) const;
};
[[nodiscard]] Ground ground_of(const Scene& scene);

/// Places at which an effect of this kind could be written into a model of these data, without parameters.
[[nodiscard]] std::vector<PlacedEffect> possible_places(const Scene& scene, const Ground& ground, EffectKind kind);
/// Those where it makes physical sense and can be seen well.
[[nodiscard]] std::vector<PlacedEffect> good_places(const Scene& scene, const Ground& ground, EffectKind kind);

/// Draws the shape of an effect at its place; size about 1 um. Nothing where the stops are too few to show one.
[[nodiscard]] std::optional<PlacedEffect> with_shape(Random& random, const Scene& scene, const Ground& ground,
                                                     PlacedEffect effect);

/// Effects of size one whose contributions span all that the effect can produce at its nonlinear parameters.
[[nodiscard]] std::vector<PlacedEffect> unit_effects(const Ground& ground, const PlacedEffect& effect);

/// A map for some of the components that are measured; the first table is for one of them.
void draw_map(Random& random, Scene& scene, const Ground& ground, bool two_tables);
/// A component measured separately, along an axis that is moved.
void draw_known(Random& random, Scene& scene, const Ground& ground);

}  // namespace ecs::emulator
