// The part program that measures a plan, in the form of thesis appendix B, and the programs of a plan file.
// Does not live here: measuring without a program (ecs_emulator/instruments/measurement.hpp), running one (run.hpp).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/result.hpp"
#include "ecs_emulator/instruments/measurement.hpp"

namespace ecs::emulator {

/// Beyond the first target by the overrun, target by target with a dwell, M08, one second, M09; beyond the last, and
/// back; runs and equal steps as `$REP` loops. Other axes are sent to `plan.parked_mm` first where it says so.
/// Coordinates are written to the nanometre at most. Readings are taken standing, also where the plan wants them on the
/// fly.
[[nodiscard]] std::string program_for(const MeasurementPlan& plan);

/// A program and its name, such as `EXX.nc`.
struct ProgramFile {
  std::string name;
  std::string text;
};

/// One program for each row of a plan file (docs/emulator.md), in file order.
/// @param even  keep targets at equal steps; else they are moved (base/moved_targets.hpp)
/// @param machine  machine file; where given, rows park the other axes where `measure` would, and every program is
///                 checked against the travel of the axes, before anything is written
[[nodiscard]] Result<std::vector<ProgramFile>> programs_of_plan(const std::filesystem::path& plan,
                                                                const std::optional<std::filesystem::path>& machine,
                                                                bool even = false);

/// The program of one request `measure` (JSON text, as the workshop takes it; without `sense`: positioning).
[[nodiscard]] Result<ProgramFile> program_of_request(const std::string& request, const std::string& name,
                                                     const std::optional<std::filesystem::path>& machine);

}  // namespace ecs::emulator
