// A servo axis answering a demanded move, by the equations of thesis 3.2.1 and appendix A: position error counter and
// D/A converter, velocity loop with PI regulator, lag of the current, torque against inertia and friction, screw.
// Does not live here: the constants (parameters.hpp), recordings (trace.hpp).
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "model/drive/parameters.hpp"

namespace ecs::model {

/// What can be measured at the axis from outside.
enum class DriveSignal : std::uint8_t { dac, tacho, current, speed, slide };
inline constexpr std::size_t kDriveSignals = 5;
[[nodiscard]] constexpr std::size_t index_of(DriveSignal signal) { return static_cast<std::size_t>(signal); }

struct DriveSignalInfo {
  DriveSignal id = DriveSignal::dac;
  std::string_view name;  ///< as a column of a recording: "tacho_V"
  std::string_view unit;  ///< "V"
  std::string_view words;
};
[[nodiscard]] const std::array<DriveSignalInfo, kDriveSignals>& drive_signals();
[[nodiscard]] const DriveSignalInfo& info_of(DriveSignal signal);

/// A move from rest at constant feed, as the controller demands it.
struct DriveMove {
  double feed_mm_min = 1200.0;  ///< > 0
  double distance_mm = 10.0;    ///< not 0; below 0: backwards
  [[nodiscard]] double duration_s() const { return 60.0 * std::abs(distance_mm) / feed_mm_min; }
};

/// Signals at 0, step, 2 step … from the start of the move.
struct DriveResponse {
  double step_s = 0.0;
  std::array<std::vector<double>, kDriveSignals> signal;
  bool bounded = true;  ///< false: the loop is unstable; the signals end where it ran away
  /// Linear between steps; before the start as at rest, beyond the end the last value.
  [[nodiscard]] double at(DriveSignal which, double time_s) const;
};

/// The axis between two events (the D/A converter reaching or leaving its limit, the motor stopping, turning round or
/// breaking away, the end of the demand) obeys linear equations: these are advanced exactly, and the events are found
/// inside a step. The position error is taken as a continuous count: whole pulses would add about half a pulse.
/// @pre  duration_s > 0, step_s > 0; step_s below the current regulator's time constant finds every event
[[nodiscard]] DriveResponse simulated(const DriveParameters& drive, const DriveMove& move, double duration_s,
                                      double step_s = 1e-4);

}  // namespace ecs::model
