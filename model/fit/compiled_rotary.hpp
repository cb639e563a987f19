// The rotary axes of the map that a model compiles to. Does not live here: how the map and its image hold them
// (laser/map/rotary_map.hpp), axes from a file of errors (commissioning/maps/rotary_part.hpp).
#pragma once

#include <span>
#include <vector>

#include "base/result.hpp"
#include "laser/map/error_map.hpp"
#include "model/fit/compiled_model.hpp"
#include "model/fit/model_file.hpp"
#include "params/machine.hpp"

namespace ecs::model {

/// The axis as the unit needs it, without errors; its deadband is five counts, as that of linear axes.
/// @pre facts.resolution_deg
[[nodiscard]] laser::MapRotaryAxis rotary_axis_of(char letter, const params::MachineRotaryAxis& facts);

/// Angles of the values of its curves: over the travel, of one that holds a turn a whole turn, from 0 where it can.
/// Sets `start_deg` and `increment_deg`.
std::vector<double> set_table_angles(laser::MapRotaryAxis& axis, const params::MachineRotaryAxis& facts,
                                     double increment_deg);

/// What an effect adds to an error motion of a rotary axis.
struct AddedMotion {
  Sense sense = Sense::EX;
  std::vector<double> values;  ///< error [um, um/m]
};
/// The error motions of the axis at these angles; none where the effect has no part in them.
/// @param fitted  with values @param machine  its rotary configuration tells the tilting axis @pre is_rotary_error
[[nodiscard]] Result<std::vector<AddedMotion>> motions_of(const Model& fitted, const EffectInstance& effect,
                                                          const params::Machine& machine, Axis axis,
                                                          const std::vector<double>& angles_deg, Approach side);

/// Every rotary axis of the machine into the header of the map, with what these effects add to it; none: nothing.
/// @pre is_rotary_error() and is_carried() of each
[[nodiscard]] Result<void> add_rotary_axes(CompiledModel& out, const Model& fitted, const params::Machine& machine,
                                           std::span<const EffectInstance* const> effects);

}  // namespace ecs::model
