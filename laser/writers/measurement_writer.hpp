// Measurement sets and circular tests as CSV text and files; needs nothing but the types.
// Does not live here: the readers (measurement_set.hpp, laser/standards/circle.hpp), instruments' own files
// (renishaw_writer.hpp).
#pragma once

#include <filesystem>
#include <string>

#include "base/result.hpp"
#include "laser/circle_test.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::laser {

/// Metadata, header row, readings. Columns stand in the order of `set.columns`, then whatever else the readings hold.
/// Numbers are written so that reading gives back the same doubles; line ends inside texts become blanks.
/// `source` and `notes` are not written.
[[nodiscard]] std::string to_csv(const MeasurementSet& set);

/// The same into a file, whole or not at all.
[[nodiscard]] Result<void> write_measurement_set(const std::filesystem::path& path, const MeasurementSet& set);

/// Plane, radius, feed, start and centre as `# key: value` from their members, other metadata before them, then
/// angle_deg,deviation_um,direction,run.
[[nodiscard]] std::string to_csv(const CircleTest& test);

}  // namespace ecs::laser
