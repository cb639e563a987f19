// Watches devices while the user presses a trigger, and describes the one that was pressed (which bit it is:
// devices/learn.hpp).
#pragma once

#include <string>

#include "base/result.hpp"
#include "commissioning/session/keyboard.hpp"
#include "commissioning/session/message.hpp"
#include "devices/description.hpp"

namespace ecs::commissioning {

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

}  // namespace ecs::commissioning
