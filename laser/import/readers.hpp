// Readers of instruments' own files, one for each format. Use import.hpp unless the format is known.
// Does not live here: recognising a format, decoding code pages.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "laser/import/import.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::laser {

/// Renishaw .rtl (linear, um), .rta (angular, mrad, here um/m), .rts (straightness, um); sections `NAME::`, one line
/// `run target deviation` for each point; the target number decides, not the order of lines. Odd runs go in the
/// direction of the target list, even ones back; approach is the sign of that motion, so a descending list starts with
/// reverse. Two passes make one run. Zero-filled backward passes of a file flagged unidirectional are left out.
[[nodiscard]] Result<MeasurementSet> parse_renishaw_run(std::string_view text, const std::string& file_name,
                                                        const ImportOptions& options);

/// Renishaw .rtx dynamic capture: text head, then little-endian 64-bit floats in mm or mrad at a fixed rate.
/// Readings are displacements from the origin of the capture at `parked_mm`, with `time_s`.
[[nodiscard]] Result<MeasurementSet> parse_renishaw_dynamic(std::string_view bytes, const std::string& file_name,
                                                            const ImportOptions& options);

/// Renishaw error compensation table: rows number, position, combined value in mm.
[[nodiscard]] Result<MeasurementSet> parse_renishaw_table(std::string_view text, const std::string& file_name,
                                                          const ImportOptions& options);

/// API report: blocks of position and mean error in mm, both directions together or each.
[[nodiscard]] Result<MeasurementSet> parse_api_pos(std::string_view text, const std::string& file_name,
                                                   const ImportOptions& options);

/// SIOS environment log: nine numbers a line (m, degC, Pa, percent).
[[nodiscard]] Result<std::vector<EnvironmentRecord>> parse_sios_environment(std::string_view text,
                                                                            const std::string& file_name);

/// Shell-style assignments TGT_DATA[i], REF_DATA_FWD[i,j], REF_DATA_BWD[i,j]: absolute positions in mm.
[[nodiscard]] Result<MeasurementSet> parse_iso230_assignments(std::string_view text, const std::string& file_name,
                                                              const ImportOptions& options);

/// Hole positions of a plate: nominal place and error in X and Y, mm. Two readings for each hole, approach unknown.
[[nodiscard]] Result<MeasurementSet> parse_plate(std::string_view text, const std::string& file_name,
                                                 const ImportOptions& options);

/// Probed surface: the first bed mesh of a Klipper configuration, a RepRapFirmware height map, or LinuxCNC probe
/// points, as EZ along X at each Y. Places that were not probed are left out.
[[nodiscard]] Result<MeasurementSet> parse_height_map(std::string_view text, const std::string& file_name,
                                                      const ImportOptions& options);

/// One channel of a log, values in mm: readings over time, or, where headings such as `3mm` stand between the values,
/// deviations from them.
[[nodiscard]] Result<MeasurementSet> parse_channel_log(std::string_view text, const std::string& file_name,
                                                       const ImportOptions& options);

/// The moving axis from the options; a `usage` problem that says what to give if they have none.
[[nodiscard]] Result<Axis> axis_wanted(const ImportOptions& options, const std::string& file_name);

/// The sense of a positioning measurement, unless the options say otherwise; a rotation is refused.
[[nodiscard]] Result<Sense> positioning_sense(const ImportOptions& options, Axis axis, const std::string& file_name);

/// `parked_mm` with the moving axis at `target_mm`.
[[nodiscard]] Vector3 position_at(const ImportOptions& options, Axis axis, double target_mm);

/// Numbers the readings 1, 2, 3 … in their order.
void number_rows(MeasurementSet& set);

/// Options that do not suit the file.
[[nodiscard]] inline Problem usage(const std::string& file_name, std::string message) {
  return {ProblemKind::usage, std::move(message), file_name, 0, 0, {}};
}

}  // namespace ecs::laser
