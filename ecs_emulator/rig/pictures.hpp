// The rig's figures as pictures, drawn by gnuplot from a script that stays beside the data.
// Does not live here: the numbers (figures.hpp).
#pragma once

#include <filesystem>

#include "ecs_emulator/rig/figures.hpp"

namespace ecs::emulator {

struct RigPictures {
  const RigBand* full_before;
  const RigBand* full_after;
  const RigBand* turns_before;
  const RigBand* turns_after;
};

/// Writes means and ±3σ of the calibrations as CSV and `figures.gp`, and runs gnuplot on it.
[[nodiscard]] Result<void> draw_rig_pictures(const std::filesystem::path& folder, const RigPictures& pictures);

}  // namespace ecs::emulator
