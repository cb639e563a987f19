#include "app/monitor_record.hpp"

#include <fmt/format.h>

#include "core/fault.hpp"

namespace ecs::app {

namespace {

std::string field_of(const laser::Values& surroundings, laser::Quantity quantity) {
  const auto found = surroundings.find(quantity);
  return found == surroundings.end() ? std::string() : fmt::format("{}", found->second);
}

}  // namespace

std::string monitor_rows(const protocol::MonitorSample& sample, const laser::Values& surroundings) {
  const std::string temperatures = fmt::format("{},{}", field_of(surroundings, laser::Quantity::air_degC),
                                               field_of(surroundings, laser::Quantity::material_degC));
  std::string rows;
  for (const Axis axis : kAllAxes) {
    const protocol::AxisSample& a = sample.axes[index_of(axis)];
    if (!a.present) continue;
    rows += fmt::format("{:.6f},{},{},{},{},{},{:d},{:d},{:d},{},{},{},{:d},{}\n",
                        static_cast<double>(sample.unit_time_us) * 1e-6, ecs::name_of(sample.mode),
                        ecs::text_of(sample.fault).name, letter_of(axis), a.position_mm, a.speed_mm_min, a.referenced,
                        a.switch_active, a.marker, static_cast<int>(a.approach), a.compensation_um, a.output_counts,
                        a.relay_closed, temperatures);
  }
  return rows;
}

}  // namespace ecs::app
