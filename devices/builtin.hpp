// Descriptions that come with the program: thermometers whose protocol is public. Does not live here: their format
// (description.hpp).
#pragma once

#include <string>
#include <vector>

#include "devices/description.hpp"

namespace ecs::devices {

/// Thermometers of the TEMPer family, by the names "temper-fm75" and "temper-hundredths"; from public descriptions that
/// `source` names, none tried on a real stick.
[[nodiscard]] const std::vector<DeviceDescription>& builtin_devices();

/// The built-in descriptions that a name stands for: its own, or "temper" for all of the family.
[[nodiscard]] std::vector<DeviceDescription> builtin_named(const std::string& name);

}  // namespace ecs::devices
