// Measurement sets as Renishaw run files; needs nothing but the types.
// Does not live here: the reader (laser/import/import.hpp).
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

}  // namespace ecs::laser
