// A device as a command line names it: a description's file, or one that comes with the program, and which of several
// alike.
#pragma once

#include <string>
#include <vector>

#include "devices/port.hpp"

namespace ecs::commissioning {

/// "foot_switch.toml", "foot_switch.toml@SERIAL", "temper@/dev/hidraw3". Several: the name stands for a family.
[[nodiscard]] Result<std::vector<devices::DeviceDescription>> described(const std::string& text);

/// Opens the device that `text` names. `usage` where it is of another kind.
[[nodiscard]] Result<devices::DevicePort> opened_device(const std::string& text, devices::DeviceKind kind);

/// "foot switch (16c0:27db Maker Pedal, serial 7)"
[[nodiscard]] std::string name_of(const devices::DevicePort& port);

}  // namespace ecs::commissioning
