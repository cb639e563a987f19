#include "ecs_emulator/unit/rack.hpp"

#include <numeric>
#include <utility>

#include <fmt/format.h>

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

namespace {

constexpr int kFirstMemorySlot = 4;
constexpr int kFirstAxisSlot = kFirstMemorySlot + static_cast<int>(kMostModules);
constexpr int kSupplySlots = 3;

}  // namespace

std::vector<RackModule> rack_of(std::uint8_t memory_modules, const AxisModules& axis_modules) {
  std::vector<RackModule> rack{{"microprocessor", 1, 1}, {"system memory", 2, 1}, {"communications", 3, 1}};
  for (int module = 0; module < memory_modules; ++module)
    rack.push_back({fmt::format("axis memory {}", module + 1), kFirstMemorySlot + module, 1});
  int slot = kFirstAxisSlot;
  for (const Axis a : kAllAxes) {
    const auto& transducer = axis_modules[index_of(a)];
    if (!transducer) continue;
    const bool resolver = *transducer == Transducer::resolver;
    rack.push_back(
        {fmt::format("{} axis {}", resolver ? "resolver" : "encoder", letter_of(a)), slot, resolver ? 2 : 1});
    slot += rack.back().slots;
  }
  rack.push_back({"power supply", kRackSlots - kSupplySlots + 1, kSupplySlots});
  return rack;
}

}  // namespace ecs::emulator
