// What only the virtual workshop knows about its machine: the table `[emulator]` of the machine file
// (docs/emulator.md). The rest of that file is read by params/machine.hpp.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "base/result.hpp"
#include "core/axis.hpp"
#include "ecs_emulator/settings/axis.hpp"
#include "ecs_emulator/settings/laser.hpp"
#include "params/machine.hpp"

namespace ecs::emulator {

struct EmulatorSettings {
  std::string serial_number = "EMULATOR-1";  ///< up to 16 characters
  std::uint64_t seed = 1;
  double load_kg = 0.0;
  Vector3 tool_offset_mm{};      ///< from the point that the unlevered machine carries to the tool point
  std::filesystem::path errors;  ///< errors file; empty: a perfect machine
  PerAxis<AxisSettings> axes{};
  LaserSettings laser{};
};

/// The machine file as the workshop sees it.
struct WorkshopMachine {
  params::Machine machine{};
  EmulatorSettings settings{};
};

/// Both halves of a machine file; relative names in it count from its folder.
[[nodiscard]] Result<WorkshopMachine> load_workshop_machine(const std::filesystem::path& path);
[[nodiscard]] Result<WorkshopMachine> parse_workshop_machine(std::string_view text, const std::string& file,
                                                             const std::filesystem::path& folder);

}  // namespace ecs::emulator
