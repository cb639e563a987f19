// A measurement taken target by target: begun or resumed, its devices opened, guided to its end, written.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "commissioning/measurements/capture_targets.hpp"
#include "commissioning/session/keyboard.hpp"
#include "commissioning/session/message.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::commissioning {

/// As typed; empty or absent: not given. Devices are DEVICE.toml[@SERIAL].
struct CaptureChoice {
  CaptureTargets target;
  std::string output;
  std::string resume;
  std::string trigger;
  std::string gauge;
  std::string readings;
  std::string follow;
  std::string display;
  std::string shows = "error";
  std::optional<double> scale;
  std::string environment;
  double environment_every_s = 5.0;
  std::optional<double> min_interval_s;
  bool force = false;
  static cli::Fields<CaptureChoice> fields();
};

struct CaptureEnd {
  bool complete = false;         ///< false: the operator left before the end
  laser::MeasurementSet result;  ///< what was read
  std::size_t targets = 0;
  std::size_t skipped = 0;
  int runs = 0;
  int unplugged = 0;  ///< times that a device was
  std::string part;   ///< file that holds the readings of an unfinished capture
  std::string file;   ///< where the complete capture was written; empty: it is not complete
  std::string kept;   ///< what is safe of an unfinished one, and how to go on with it
};

/// Guides through the targets until the last, a typed q or an interrupt. After a problem the readings taken stay in
/// OUT.csv.part.
/// @param keyboard  null: there is nobody to type
[[nodiscard]] Result<CaptureEnd> capture(MessageSink& messages, Keyboard* keyboard, const CaptureChoice& choice);

}  // namespace ecs::commissioning
