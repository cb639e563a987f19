#include "ecs_emulator/unit/rack.hpp"

#include <fmt/format.h>

namespace ecs::emulator {
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
