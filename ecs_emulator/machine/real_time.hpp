// Simulated time held to the wall clock: every period of the loop begins when it is due, and what comes late is
// counted.
#pragma once

#include <cstdint>
#include <ctime>

namespace ecs::emulator {

/// What became of the periods so far.
struct RealTimeRecord {
  std::uint64_t periods = 0;
  std::uint64_t missed = 0;    ///< begun a whole period or more after they were due
  double worst_late_us = 0.0;  ///< of any period
  bool fifo = false;           ///< the system gave this process a real-time priority
};

class RealTime {
 public:
  /// Asks the system for a real-time priority; goes on without where it is refused.
  RealTime();

  /// Returns when the next period is due. After a stop of more than a quarter of a second, time starts anew: the
  /// periods left out count as missed.
  void wait(double period_s);

  [[nodiscard]] const RealTimeRecord& record() const { return record_; }

 private:
  timespec due_{};
  RealTimeRecord record_;
};

}  // namespace ecs::emulator
