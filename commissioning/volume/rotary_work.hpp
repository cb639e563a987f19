// The rotary axes of a machine file in the work of `ecs volume`: their chain and errors, what is said of them.
// Does not live here: the error at their angles (volume/joint_volume.hpp).
#pragma once

#include "commissioning/volume/work.hpp"

namespace ecs::commissioning {

/// 'A', 'B' or 'C' of 0, 1, 2.
[[nodiscard]] char rotary_letter(std::size_t rotary);

/// The rotary axes of the machine file and their errors; nothing where it has none. Refused: --rotary without them, the
/// printed equations.
/// @param model  in place of the map's errors, where one was given
/// @param expected  gets the errors that are known; `work` the true ones where an errors file is given
[[nodiscard]] Result<void> take_rotary(const VolumeArguments& arguments, const std::string& machine_file,
                                       const std::optional<model::Model>& model, volume::CompensatedMachine& expected,
                                       VolumeWork& work);

/// What the unit does not compensate, and errors that nobody gave.
void note_rotary(VolumeWork& work);

}  // namespace ecs::commissioning
