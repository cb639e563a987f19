// Files of circles (ISO 230-4) and diagonals (ISO 230-6) as readings that a model can take, alone and together with
// lines. Does not live here: the files themselves (laser/standards), their readings as a measurement set
// (model/data/path.hpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::commissioning {

/// A circle or diagonals file; nothing where the header row is of neither. Problem: what the readers of these files
/// refuse.
[[nodiscard]] Result<std::optional<laser::MeasurementSet>> read_path_file(const std::string& file);

/// Adds the readings of path files to those of lines: rows and runs are numbered on, notes and what the files say of
/// the machine are kept. `refused` if the files name different machines.
[[nodiscard]] Result<laser::MeasurementSet> joined_with_paths(laser::MeasurementSet lines,
                                                              std::vector<laser::MeasurementSet> paths);

}  // namespace ecs::commissioning
