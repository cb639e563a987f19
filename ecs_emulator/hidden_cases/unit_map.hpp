// What an engineer has besides the readings: the map that the unit held, a component measured separately.
#pragma once

#include "ecs_emulator/random/random.hpp"
#include "ecs_emulator/scene/ground.hpp"

namespace ecs::emulator {

/// A map for some of the components that are measured; the first table is for one of them.
void draw_map(Random& random, Scene& scene, const Ground& ground, bool two_tables);
/// A component measured separately, along an axis that is moved.
void draw_known(Random& random, Scene& scene, const Ground& ground);

}  // namespace ecs::emulator
