// Measurement sets into files of the form that their extension names.
#pragma once

#include <filesystem>

#include "base/result.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::emulator {

/// `.csv` (docs/design.md 3.1), `.rtl`, `.rta` or `.rts` (Renishaw). Any other extension is a `usage` problem.
[[nodiscard]] Result<void> write_measurement(const std::filesystem::path& path, const laser::MeasurementSet& set);

}  // namespace ecs::emulator
