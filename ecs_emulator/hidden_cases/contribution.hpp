// What an effect adds to a reading, by the place where it acts in a machine.
// Does not live here: its formula (ecs_emulator/effects), the machine itself (ecs_emulator/errors/kinematics.hpp).
#pragma once

#include <vector>

#include "ecs_emulator/effects/placed.hpp"
#include "ecs_emulator/scene/scene.hpp"

namespace ecs::emulator {

/// Value of the effect's component, or what the instrument adds, at this stop [um, um/m]; 0 where it does not act.
/// @pre its seat is not the unit
[[nodiscard]] double amount(const Scene& scene, const PlacedEffect& effect, const Stop& stop);
/// How much of a component's value reaches the sense of this reading: levers and signs of the chain.
[[nodiscard]] double share_in(const Scene& scene, Component component, const Stop& stop);

/// Compensation that a unit adds to this reading, with the faults among `effects` [um, um/m].
[[nodiscard]] double unit_compensation(const Scene& scene, const std::vector<PlacedEffect>& effects, const Stop& stop);
/// Value of one of the map's curves; 0 where the map lacks it.
[[nodiscard]] double table_value(const UnitMap& map, Axis axis, Sense sense, double position_mm, int approach);

/// What the effect adds to each reading, to first order [um, um/m] (readings).
[[nodiscard]] std::vector<double> contribution(const Scene& scene, const PlacedEffect& effect);

}  // namespace ecs::emulator
