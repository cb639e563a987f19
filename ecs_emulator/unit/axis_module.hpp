// An axis module of the rack as its registers show it: counter, speed, switch, latched marker (thesis 5.2).
// Does not live here: what the positions mean (unit.hpp).
#pragma once

#include <array>
#include <cstddef>

#include "ecs_emulator/machine/axis_signals.hpp"

namespace ecs::emulator {

class AxisModule {
 public:
  /// The counter begins at 0 wherever the axis stands.
  void power_up() { *this = AxisModule(); }

  /// One period.
  void take(const AxisSignals& signals);

  [[nodiscard]] std::int64_t counts() const { return signals_.counts - base_; }
  [[nodiscard]] std::int64_t marker_counts() const { return signals_.marker_counts - base_; }
  [[nodiscard]] bool marker() const { return signals_.marker; }
  [[nodiscard]] bool switch_closed() const { return signals_.switch_closed; }
  [[nodiscard]] bool transducer_ok() const { return signals_.transducer_ok; }
  /// Change in the last period.
  [[nodiscard]] std::int64_t step() const { return step_; }
  /// Counts per period, mean of the last eight.
  [[nodiscard]] double speed() const;
  /// A marker passed since this was last asked.
  [[nodiscard]] bool take_marker();

 private:
  static constexpr std::size_t kWindow = 8;
  AxisSignals signals_;
  bool begun_ = false;
  std::int64_t base_ = 0;
  std::int64_t step_ = 0;
  std::array<std::int64_t, kWindow> steps_{};
  std::size_t next_ = 0;
  bool marker_seen_ = false;
};

}  // namespace ecs::emulator
