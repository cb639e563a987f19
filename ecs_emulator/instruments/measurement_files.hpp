// Measurements as files of the instruments that the host can read.
// Does not live here: the formats themselves (the writers of laser/).
#pragma once

#include <filesystem>

#include "base/result.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::emulator {

/// By the extension of the name: .csv; Renishaw .rtl, .rta or .rts (whichever fits), .ren (means, compensation), .rtx
/// (captures); API .pos (means); ISO 230-2 assignments .dat; .env.pos: the weather in a SIOS log. Any other extension
/// is a `usage` problem, a set that the format cannot hold is refused with the reason.
[[nodiscard]] Result<void> write_measurement(const std::filesystem::path& path, const laser::MeasurementSet& set);

}  // namespace ecs::emulator
