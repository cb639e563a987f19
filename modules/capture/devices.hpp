// Devices of a measurement: named on a command line (a description's file, or one that comes with the program, and
// which of several alike), a trigger learnt while the user presses it; and the sensor of the surroundings that is
// watched beside a monitor (commissioning/unit/monitor_record.hpp).
#pragma once

#include <string>
#include <vector>

#include "base/result.hpp"
#include "commissioning/session/message.hpp"
#include "commissioning/unit/monitor_record.hpp"
#include "modules/capture/description.hpp"
#include "modules/capture/port.hpp"

namespace ecs::commissioning {

/// "foot_switch.toml", "foot_switch.toml@SERIAL", "temper@/dev/hidraw3". Several: the name stands for a family.
[[nodiscard]] Result<std::vector<devices::DeviceDescription>> described(const std::string& text);

/// Opens the device that `text` names. `usage` where it is of another kind.
[[nodiscard]] Result<devices::DevicePort> opened_device(const std::string& text, devices::DeviceKind kind);

/// "foot switch (16c0:27db Maker Pedal, serial 7)"
[[nodiscard]] std::string name_of(const devices::DevicePort& port);

struct LearnChoice {
  std::string device;  ///< path, serial or "16c0:27db"; empty: whichever is pressed
  std::string name;    ///< of the description; empty: as the device calls itself
  int presses = 3;
  double timeout_s = 60.0;
};

struct LearnedDevice {
  devices::DeviceDescription description;
  double bounce_ms = 0.0;
};

/// Ends a second after the last release, or at the time limit. `refused` with the reason where nothing or too much
/// changed; `link` where no device can be watched.
/// @param keyboard  a typed q gives up; null: there is nobody to type
[[nodiscard]] Result<LearnedDevice> learn_device(MessageSink& messages, Keyboard* keyboard, const LearnChoice& choice);

/// The sensor of --environment. @param every_s  between two readings
[[nodiscard]] std::unique_ptr<SurroundingsWatch> environment_watch(const std::string& device, double every_s);

}  // namespace ecs::commissioning
