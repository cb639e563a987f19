// Which bit of a device's reports is the button: learned from what changes while somebody presses it a few times.
// Does not live here: watching the devices and talking to the user (app/).
#pragma once

#include <string>
#include <vector>

#include "modules/capture/description.hpp"

namespace ecs::devices {

struct TimedReport {
  double time_s = 0.0;
  Bytes bytes;
};

/// What stands in the reports of one device after `presses` presses, each followed by a release.
struct Learned {
  std::uint8_t report_number = 0;  ///< 0: not numbered
  std::size_t report_bytes = 0;
  TriggerLayout trigger;   ///< debounce twice the longest bounce that was seen, at least 20 ms
  double bounce_ms = 0.0;  ///< longest bounce seen
};

/// How many presses can be told so far, at most `presses`: for showing, and for knowing when to stop.
[[nodiscard]] int presses_seen(const std::vector<TimedReport>& reports, bool numbered);

/// The bits of one byte that changed twice with every press and nothing else did. `refused` with the reason where no
/// bit did (what changed how often is said), where several could be meant (a counter, a stick, another button), or
/// where nothing came. Changes within 60 ms of each other count as bounce.
/// @param numbered  the reports begin with their number
[[nodiscard]] Result<Learned> learned(const std::vector<TimedReport>& reports, int presses, bool numbered);

}  // namespace ecs::devices
