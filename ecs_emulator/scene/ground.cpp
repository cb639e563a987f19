#include "ecs_emulator/scene/ground.hpp"

#include <algorithm>

namespace ecs::emulator {

Axis Ground::natural_axis(Sense sense) const {
  int moved = 0;
  Axis only = direction_of(sense);
  for (const Axis a : kAllAxes)
    if (cover(sense, a).moved) {
      ++moved;
      only = a;
    }
  return moved == 1 ? only : direction_of(sense);
}

Ground ground_of(const Scene& scene) {
  Ground ground;
  std::array<std::array<int, 3>, 6> ways{};
  for (const Stop& stop : scene.stops) {
    const auto s = static_cast<std::size_t>(stop.sense);
    if (std::find(ground.senses.begin(), ground.senses.end(), stop.sense) == ground.senses.end())
      ground.senses.push_back(stop.sense);
    for (const Axis a : kAllAxes)
      if (scene.chain.has(a)) ground.covers[s][index_of(a)].places_mm.push_back(scene.p_mm(stop, a));
    ground.covers[s][index_of(stop.axis)].moved = true;
    ways[s][index_of(stop.axis)] |= stop.approach > 0 ? 1 : 2;
  }
  for (std::size_t s = 0; s < 6; ++s)
    for (std::size_t a = 0; a < 3; ++a) {
      auto& places = ground.covers[s][a].places_mm;
      std::sort(places.begin(), places.end());
      places.erase(std::unique(places.begin(), places.end()), places.end());
      ground.covers[s][a].both_ways = ways[s][a] == 3;
    }
  return ground;
}

}  // namespace ecs::emulator
