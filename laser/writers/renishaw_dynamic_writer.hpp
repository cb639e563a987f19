// Captures at a constant rate as Renishaw .rtx files; needs nothing but the types.
// Does not live here: the reader (laser/import/import.hpp), runs at targets (renishaw_writer.hpp).
#pragma once

#include <string>

#include "base/result.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::laser {

/// Bytes of a dynamic capture: text head, little-endian 64-bit floats in mm (or mrad), `EOF::`. Readings are
/// displacements in the order of time. Metadata `Machine`, `Serial No`, `Date`, `By`, `Location`, `Velocity` go into
/// the head. `refused`, with the reason, unless there are two readings or more of one axis and one sense, a rotation or
/// the axis's own, with times a constant step apart (to 1 % of it).
[[nodiscard]] Result<std::string> to_renishaw_dynamic(const MeasurementSet& set, const std::string& file_name);

}  // namespace ecs::laser
