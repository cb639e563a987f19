// Memory images that the tests of the unit load.
#pragma once

#include <functional>
#include <string_view>
#include <vector>

#include "core/memory_image.hpp"
#include "params/machine.hpp"

namespace ecs::emulator::test {

/// What the map adds at a position: compensation, um or um/m.
using CurveFunction = std::function<double(Component, double position_mm, Approach)>;

/// An image for the unit of that serial number with both approaches of every needed curve, 10 mm apart over the travel
/// of its axis, 0.01 um a count.
inline std::vector<std::uint8_t> image_of(const UnitParameters& parameters, const params::Machine& machine,
                                          const CurveFunction& compensation,
                                          std::string_view serial_number = "EMULATOR-1",
                                          const std::vector<ThermalRow>& thermal = {},
                                          const ThermalSettings& settings = {}, const RotarySetup* rotary = nullptr) {
  const ComponentSet needed = components_needed(parameters);
  std::vector<TableEntry> entries;
  std::uint32_t values = 0;
  for (std::size_t c = 0; c < kCurves; ++c) {
    const auto curve = static_cast<Component>(c);
    if (!needed.contains(curve)) continue;
    const auto [low, high] = machine.axes[index_of(moving_axis(curve))]->travel_mm;
    const auto count = static_cast<std::uint32_t>((high - low) / 10.0 + 1.5);
    for (const Approach approach : {Approach::reverse, Approach::forward}) {
      entries.push_back({curve, approach, false, values, count, low, 10.0, 0.01});
      values += count;
    }
  }
  ImagePlan plan{
      static_cast<std::uint32_t>(entries.size()), values, 4,
      format_for(!thermal.empty(), rotary != nullptr, rotary != nullptr && rotary->bending != RotaryBending{}),
      static_cast<std::uint32_t>(thermal.size())};
  if (rotary != nullptr) plan.rotary_values = {rotary->tables[0].count, rotary->tables[1].count};
  std::vector<std::uint8_t> image(image_bytes(plan));
  begin_image(image, plan);
  write_parameters(image, parameters);
  write_identity(image, {serial_number, machine.name, configuration_hash(parameters)});
  if (!thermal.empty()) write_thermal(image, settings, thermal);
  for (std::uint32_t i = 0; i < entries.size(); ++i) {
    const TableEntry& entry = entries[i];
    write_entry(image, i, entry);
    for (std::uint32_t k = 0; k < entry.count; ++k) {
      const double value = compensation(entry.component, entry.start_mm + k * entry.increment_mm, entry.approach);
      write_value(image, entry.first_value + k, static_cast<std::int16_t>(std::lround(value / entry.resolution)));
    }
  }
  if (rotary != nullptr) write_rotary(image, *rotary);
  write_header(image, "test");
  seal_image(image);
  return image;
}

}  // namespace ecs::emulator::test
