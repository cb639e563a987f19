// What the stops of a scene cover: which axes move in which readings, and where.
#pragma once

#include <array>
#include <vector>

#include "ecs_emulator/scene/scene.hpp"

namespace ecs::emulator {

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

}  // namespace ecs::emulator
