// Writers, which need nothing but the types: measurement sets and circular tests as CSV, Renishaw run files and
// captures at a constant rate (.rtx), small tables of instruments. Does not live here: the readers
// (measurement_set.hpp, laser/import/import.hpp, laser/standards/circle.hpp).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "laser/circle_test.hpp"
#include "laser/environment_series.hpp"
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
