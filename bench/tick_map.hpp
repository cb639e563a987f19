// The map that the tick is measured with: volumetric, three axes, all 21 components, forward and reverse, linear.
// Does not live here: the measuring (tick_bench.cpp, tick_callgrind.cpp).
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <string_view>
#include <vector>

#include "base/random.hpp"
#include "core/tick.hpp"

namespace ecs::bench {

/// Rows for all components and laws in turn, each temperature input used, lags of seconds to hours.
inline std::vector<ThermalRow> thermal_rows(std::size_t count) {
  std::vector<ThermalRow> rows;
  for (std::size_t k = 0; k < count; ++k) {
    const auto component = static_cast<Component>(k % kCurves);
    const auto law = is_angular(component) ? ThermalLaw::shift : static_cast<ThermalLaw>(k % 3);
    rows.push_back({component, law, static_cast<std::uint8_t>(k % kTemperatureInputs), kNoInput, -2.0, 20.0,
                    10.0 * static_cast<double>(k * k), -500.0});
  }
  return rows;
}

/// An XYTZ machine with a tool offset, so that every component acts.
inline UnitParameters full_parameters() {
  UnitParameters parameters;
  parameters.configuration = {'X', 'Y', 'T', 'Z', 0};
  parameters.C0Y_um_per_m = 16.0;
  parameters.B0Z_um_per_m = -38.8;
  parameters.A0Z_um_per_m = -66.93;
  parameters.tool_offset_mm = {12.0, -7.0, 150.0};
  parameters.memory_modules = static_cast<std::uint8_t>(kMostModules);
  for (auto& line : parameters.measurement_lines_mm) line = {-500.0, -400.0, -300.0};
  return parameters;
}

/// Its map, with `values` error values in all.
inline std::vector<std::uint8_t> full_image(std::uint32_t values, const std::vector<ThermalRow>& thermal = {}) {
  const UnitParameters parameters = full_parameters();
  const std::uint32_t per_table = values / kMostTables;
  const ImagePlan plan{kMostTables, per_table * kMostTables, 0, thermal.empty() ? kImageFormat : kFormatWithThermal,
                       static_cast<std::uint32_t>(thermal.size())};
  std::vector<std::uint8_t> image(image_bytes(plan));
  begin_image(image, plan);
  write_parameters(image, parameters);
  write_identity(image, {"BENCH", "bench", configuration_hash(parameters)});
  if (!thermal.empty()) write_thermal(image, {}, thermal);
  for (std::uint32_t t = 0; t < kMostTables; ++t) {
    const Approach approach = t % 2 == 0 ? Approach::forward : Approach::reverse;
    write_entry(image, t,
                {static_cast<Component>(t / 2), approach, false, t * per_table, per_table, -1000.0 + 0.1 * t,
                 1000.0 / (per_table - 1), 0.01});
    for (std::uint32_t k = 0; k < per_table; ++k)
      write_value(image, t * per_table + k, static_cast<std::int16_t>(3000.0 * std::sin(0.02 * k + t)));
  }
  seal_image(image);
  return image;
}

/// The working form of full_image(); nothing if it does not compile.
inline std::unique_ptr<CompiledMap> full_map(std::uint32_t values, const std::vector<ThermalRow>& thermal = {}) {
  const auto image = full_image(values, thermal);
  auto map = std::make_unique<CompiledMap>();
  if (check_image(image).fault != ImageFault::none || compile(ImageView(image), *map).fault != Fault::none)
    return nullptr;
  return map;
}

/// Gives the map the two rotary axes of a configuration such as XYACTZ: all six curves every 10 deg for each approach,
/// and all location errors. @param bends  "machine", "tool", "both": in all directions
/// @return false: the configuration is not one of this machine
inline bool add_rotary_axes(CompiledMap& map, std::string_view configuration, std::string_view bends = {}) {
  RotarySetup machine;
  const std::array<double, 6> sizes{5.0, -6.0, 7.0, 8.0, -9.0, 10.0};
  if (bends == "machine" || bends == "both") machine.bending.of_machine = sizes;
  if (bends == "tool" || bends == "both") machine.bending.of_tool = sizes;
  configuration.copy(machine.configuration.data(), machine.configuration.size() - 1);
  std::vector<std::uint8_t> values(12 * 36);
  std::size_t axis = 0;
  for (std::size_t i = 0; i < values.size() / 2; ++i)
    store_big(values, 2 * i,
              static_cast<std::uint16_t>(static_cast<std::int16_t>(1000.0 * std::sin(0.2 * static_cast<double>(i)))));
  for (const char letter : configuration) {
    if (letter < 'A' || letter > 'C' || axis == kRotaryInputs) continue;
    RotaryAxis& one = machine.axes[axis];
    one = {letter, 1e-3, 2e-3, {}, {600.0, 300.0, -560.0}, {3.0, -4.0, 5.0, 20.0, -30.0, 40.0}};
    one.direction[static_cast<std::size_t>(letter - 'A')] = 1.0;
    machine.tables[axis] = {0.0, 10.0, 36, {0.01, 0.01, 0.01, 0.1, 0.1, 0.1}, {values, values}};
    ++axis;
  }
  UnitParameters parameters = full_parameters();
  parameters.tool_range_mm = {500.0, 500.0, 500.0};
  return compile_rotary(machine, parameters, map) == RotaryFault::none;
}

/// Transducer counts of a random walk over one metre of each axis, steps up to 20 um, reversals included.
inline std::vector<PerAxis<std::int64_t>> random_walk(std::size_t steps) {
  std::mt19937 random(20240501);
  PerAxis<std::int64_t> at{-500'000, -500'000, -500'000};
  std::vector<PerAxis<std::int64_t>> walk;
  walk.reserve(steps);
  for (std::size_t i = 0; i < steps; ++i) {
    for (auto& counts : at) {
      const std::int64_t next = counts + one_of(random, 41) - 20;
      counts = next > 0 || next < -1'000'000 ? counts : next;
    }
    walk.push_back(at);
  }
  return walk;
}

}  // namespace ecs::bench
