// What work on the link tells its screen while it has the link to itself: the newest sample and status, and where the
// bundled emulator's workshop is.
#pragma once

#include <mutex>
#include <optional>
#include <string>

#include "commissioning/link/unit_link.hpp"

namespace ecs::commissioning {

class DatumLive {
 public:
  struct Seen {
    std::optional<protocol::MonitorSample> sample;
    std::optional<protocol::UnitStatus> status;
    std::string workshop;  ///< socket; empty: no emulator
    std::optional<Axis> axis;
    bool running = false;      ///< the unit has answered that it is at it
    bool fetching = false;     ///< the command is done, its result is read out of the memory
    double part = 0.0;         ///< of the command under way, or of what is fetched, 0 … 1
    double seconds_left = -1;  ///< of what is fetched; negative: not known
    std::uint64_t changes = 0;
  };
  /// Begins work on an axis.
  void begin(UnitLink& link, Axis axis) {
    const std::lock_guard lock(mutex_);
    seen_.workshop = link.workshop();
    seen_.axis = axis;
    seen_.running = false;
    seen_.fetching = false;
    seen_.part = 0.0;
    seen_.seconds_left = -1;
    ++seen_.changes;
  }
  /// One look over the link; what fails is left to the command that is under way.
  void look(UnitLink& link, const protocol::CommandResult& busy, bool with_status) {
    auto sample = link.client().monitor();
    std::optional<protocol::UnitStatus> status;
    if (with_status)
      if (auto read = link.client().status()) status = *read;
    const std::lock_guard lock(mutex_);
    if (sample) seen_.sample = *sample;
    if (status) seen_.status = *status;
    seen_.running = true;
    seen_.part = busy.per_mille / 1000.0;
    ++seen_.changes;
  }
  void fetch(const protocol::Progress& progress) {
    const std::lock_guard lock(mutex_);
    seen_.fetching = true;
    if (progress.bytes_total > 0)
      seen_.part = static_cast<double>(progress.bytes_done) / static_cast<double>(progress.bytes_total);
    seen_.seconds_left = progress.seconds_left;
    ++seen_.changes;
  }
  void end() {
    const std::lock_guard lock(mutex_);
    seen_.axis.reset();
    seen_.running = false;
    ++seen_.changes;
  }
  [[nodiscard]] Seen now() const {
    const std::lock_guard lock(mutex_);
    return seen_;
  }

 private:
  mutable std::mutex mutex_;
  Seen seen_;
};

}  // namespace ecs::commissioning
