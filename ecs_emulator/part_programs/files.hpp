// Part programs as files: one for each row of a measurement plan. Does not live here: their text (writer.hpp).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/result.hpp"

namespace ecs::emulator {

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
