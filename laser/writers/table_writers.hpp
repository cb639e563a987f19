// Small text tables of instruments: Renishaw error compensation table, API report, ISO 230-2 assignments, SIOS
// environment log; they need nothing but the types.
// Does not live here: their readers (laser/import/import.hpp), run files (renishaw_writer.hpp).
#pragma once

#include <string>
#include <vector>

#include "base/result.hpp"
#include "laser/environment_series.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::laser {

/// Renishaw error compensation table (.ren): one combined value in mm for each target, compensation = −mean of all
/// readings there. `refused`, with the reason, unless the set is positioning of one axis at one parked position with
/// targets a constant step apart (to 1 um).
[[nodiscard]] Result<std::string> to_renishaw_table(const MeasurementSet& set);

/// API report (.pos): position and mean error in mm, both directions together, then each that was measured.
/// `refused` unless the set is positioning of one axis at one parked position.
[[nodiscard]] Result<std::string> to_api_pos(const MeasurementSet& set);

/// ISO 230-2 assignments (.dat): targets and the position of every reading in mm, cycle = run. `refused` unless the set
/// is positioning of one axis at one parked position, every target once in each run and direction, approach known.
[[nodiscard]] Result<std::string> to_iso230_assignments(const MeasurementSet& set);

/// SIOS environment log (.env.pos): one line for each record, m, °C, Pa, percent. `refused` without records.
[[nodiscard]] Result<std::string> to_sios_environment(const std::vector<EnvironmentRecord>& records);

/// What the instrument's weather station saw with each reading; readings without all of it are left out.
[[nodiscard]] std::vector<EnvironmentRecord> environment_of(const MeasurementSet& set);

}  // namespace ecs::laser
