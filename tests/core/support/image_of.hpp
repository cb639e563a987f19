// A whole, sealed image from parameters and tables, as the host would build it. Only for tests of core/.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "core/memory_image.hpp"

namespace ecs::test {

/// One table before its values have a place.
struct PlannedTable {
  Component component = Component::EXX;
  Approach approach = Approach::unknown;
  double start_mm = 0.0;
  double increment_mm = 10.0;
  double resolution = 0.01;
  std::vector<std::int16_t> counts;  ///< empty: declared zero
};

inline std::vector<std::uint8_t> image_of(const UnitParameters& parameters, const std::vector<PlannedTable>& tables,
                                          std::string_view header = "", const std::vector<ThermalRow>& thermal = {},
                                          const ThermalSettings& settings = {}, const RotarySetup* rotary = nullptr) {
  ImagePlan plan;
  plan.format =
      format_for(!thermal.empty(), rotary != nullptr, rotary != nullptr && rotary->bending != RotaryBending{});
  if (rotary != nullptr) plan.rotary_values = {rotary->tables[0].count, rotary->tables[1].count};
  plan.thermal_rows = static_cast<std::uint32_t>(thermal.size());
  plan.table_count = static_cast<std::uint32_t>(tables.size());
  for (const auto& t : tables) plan.value_count += static_cast<std::uint32_t>(t.counts.size());
  plan.header_bytes = static_cast<std::uint32_t>(header.size());
  std::vector<std::uint8_t> image(image_bytes(plan));
  begin_image(image, plan);
  write_parameters(image, parameters);
  std::uint32_t next = 0;
  for (std::uint32_t i = 0; i < plan.table_count; ++i) {
    const PlannedTable& t = tables[i];
    const auto count = static_cast<std::uint32_t>(t.counts.size());
    write_entry(image, i, {t.component, t.approach, count == 0, next, count, t.start_mm, t.increment_mm, t.resolution});
    for (const std::int16_t counts : t.counts) write_value(image, next++, counts);
  }
  if (!thermal.empty()) write_thermal(image, settings, thermal);
  if (rotary != nullptr) write_rotary(image, *rotary);
  write_header(image, header);
  seal_image(image);
  return image;
}

/// The tables given, and every other curve declared zero.
inline std::vector<PlannedTable> with_zeros(std::vector<PlannedTable> tables) {
  for (std::size_t c = 0; c < kCurves; ++c) {
    bool held = false;
    for (const auto& t : tables) held = held || index_of(t.component) == c;
    if (!held) tables.push_back({static_cast<Component>(c), Approach::unknown, 0.0, 10.0, 0.01, {}});
  }
  return tables;
}

}  // namespace ecs::test
