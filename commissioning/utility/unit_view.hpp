// The unit as it was seen last, and what the controllers of ECS UTILITY share.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "commissioning/link/unit_connection.hpp"
#include "commissioning/session/message.hpp"
#include "commissioning/session/task_runner.hpp"

namespace ecs::commissioning {

/// Why a unit in this mode refuses what needs integration mode, and what to do; empty: it does not.
[[nodiscard]] std::string refusal_in(UnitMode mode);

/// The unit as it was seen last, and how long ago.
struct UnitView {
  WatchedUnit watched;                            ///< without samples
  std::optional<protocol::MonitorSample> sample;  ///< the last one that came, also when the link is lost
  bool fresh = false;                             ///< `sample` came from the link that is open
  double age_s = 0.0;                             ///< of `sample`
  int restarts = 0;                               ///< how often the unit began anew while it was watched
  std::uint64_t changes = 0;

  /// @return whether there is anything new to draw
  bool look(const UnitConnection& connection);
  /// A sample that came with a piece of work while the connection could not look.
  void take(const protocol::MonitorSample& seen);
  [[nodiscard]] std::vector<Axis> axes() const;  ///< that the unit has; all as long as none answered
  [[nodiscard]] const protocol::AxisSample* axis(Axis which) const;
  [[nodiscard]] bool integrating() const { return sample && sample->mode == UnitMode::integration; }
  /// Why the unit refuses what it does in integration mode only; empty: it does it, or its mode is not known now.
  [[nodiscard]] std::string refusal() const { return fresh && sample ? refusal_in(sample->mode) : ""; }

 private:
  void take(const protocol::MonitorSample& seen, std::chrono::steady_clock::time_point at);
  std::chrono::steady_clock::time_point taken_at_{};
  std::uint64_t times_lost_ = 0;  ///< lines, when `sample` came
};

/// Whether the unit was started again between two samples: it then shows less than it had run, or lacks, of the time
/// that passed, at least all it had run before; half of that is the limit, for samples that came late.
/// @param passed  from one sample to the other while the link was lost, else 0
[[nodiscard]] bool began_anew(const protocol::MonitorSample& before, const protocol::MonitorSample& after,
                              std::chrono::steady_clock::duration passed);

[[nodiscard]] double seconds_since(std::chrono::steady_clock::time_point moment);

/// "seen 4 s ago", coarse; empty below one second.
[[nodiscard]] std::string age_text(double age_s);

/// How work ended that did not succeed: given up by the user, or the problem.
void say_failed(Message& message, const Problem& problem, bool given_up);

/// A stem with the local time, "datum-x-20260504-140509.csv".
[[nodiscard]] std::string file_name_now(const std::string& stem, const std::string& extension);

/// A file or folder is there already.
[[nodiscard]] bool file_is_there(const std::string& path);

}  // namespace ecs::commissioning
