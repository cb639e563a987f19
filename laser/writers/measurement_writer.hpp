// Measurement sets as CSV text and files; needs nothing but the types.
// Does not live here: the reader (measurement_set.hpp), instruments' own files (renishaw_writer.hpp).
#pragma once

#include <filesystem>
#include <string>

#include "base/result.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::laser {

/// Metadata, header row, readings. Columns stand in the order of `set.columns`, then whatever else the readings hold.
/// Numbers are written so that reading gives back the same doubles; line ends inside texts become blanks.
/// `source` and `notes` are not written.
[[nodiscard]] std::string to_csv(const MeasurementSet& set);

/// The same into a file, whole or not at all.
[[nodiscard]] Result<void> write_measurement_set(const std::filesystem::path& path, const MeasurementSet& set);

}  // namespace ecs::laser
