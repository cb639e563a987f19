// Measurement sets as Renishaw run files, and captures at a constant rate as .rtx files; needs nothing but the types.
// Does not live here: the readers (laser/import/import.hpp).
#pragma once

#include <string>

#include "base/result.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::laser {

/// Text of a run file: .rtl for the positioning sense of the moving axis, .rta (mrad) for a rotation, .rts for a
/// straightness. CR LF, UTF-8, six decimals. Metadata `Machine`, `Serial No`, `Date`, `By`, `Location`, `TITLE` go into
/// USER-TEXT; air, material, pressure and humidity of the first and the last reading into ENVIRONMENT.
/// Runs must be complete: one axis, one sense, one parked position; runs numbered from 1 without a gap; every run has
/// the same targets once forward and once in reverse, or all runs forward only or reverse only (backward passes are
/// then filled with zeros and the file is flagged unidirectional). `refused` otherwise, with the reason.
[[nodiscard]] Result<std::string> to_renishaw_run(const MeasurementSet& set);

/// The extension that goes with the set: ".rtl", ".rta" or ".rts". @pre !set.readings.empty()
[[nodiscard]] std::string renishaw_extension(const MeasurementSet& set);

/// Bytes of a dynamic capture: text head, little-endian 64-bit floats in mm (or mrad), `EOF::`. Readings are
/// displacements in the order of time. Metadata `Machine`, `Serial No`, `Date`, `By`, `Location`, `Velocity` go into
/// the head. `refused`, with the reason, unless there are two readings or more of one axis and one sense, a rotation or
/// the axis's own, with times a constant step apart (to 1 % of it).
[[nodiscard]] Result<std::string> to_renishaw_dynamic(const MeasurementSet& set, const std::string& file_name);

}  // namespace ecs::laser
