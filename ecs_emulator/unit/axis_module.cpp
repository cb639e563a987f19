#include "ecs_emulator/unit/axis_module.hpp"

#include <numeric>
#include <utility>

namespace ecs::emulator {

void AxisModule::take(const AxisSignals& signals) {
  if (!begun_) {
    begun_ = true;
    base_ = signals.counts;
    signals_ = signals;
  }
  step_ = signals.counts - signals_.counts;
  steps_[next_] = step_;
  next_ = (next_ + 1) % kWindow;
  signals_ = signals;
  marker_seen_ = marker_seen_ || signals.marker;
}

double AxisModule::speed() const {
  return static_cast<double>(std::accumulate(steps_.begin(), steps_.end(), std::int64_t{0})) / kWindow;
}

bool AxisModule::take_marker() { return std::exchange(marker_seen_, false); }

}  // namespace ecs::emulator
