#include "laser/map/error_map.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace ecs::laser {

const MapTable* table_of(const ErrorMap& map, Component component, Approach approach) {
  const MapTable* both = nullptr;
  for (const MapTable& table : map.tables) {
    if (table.component != component) continue;
    if (table.approach == approach) return &table;
    if (table.approach == Approach::unknown) both = &table;
  }
  return both;
}

double compensation_at(const MapTable& table, double position_mm) {
  const auto& p = table.position_mm;
  if (position_mm <= p.front()) return table.compensation.front();
  if (position_mm >= p.back()) return table.compensation.back();
  const auto above = static_cast<std::size_t>(std::upper_bound(p.begin(), p.end(), position_mm) - p.begin());
  const double part = (position_mm - p[above - 1]) / (p[above] - p[above - 1]);
  return std::lerp(table.compensation[above - 1], table.compensation[above], part);
}

double unit_value_at(const MapTable& table, Interpolation interpolation, double position_mm) {
  if (interpolation == Interpolation::linear) return compensation_at(table, position_mm);
  const auto& p = table.position_mm;
  const auto above = static_cast<std::size_t>(std::lower_bound(p.begin(), p.end(), position_mm) - p.begin());
  if (above == 0) return table.compensation.front();
  if (above == p.size()) return table.compensation.back();
  const bool upper = position_mm - p[above - 1] >= p[above] - position_mm;
  return table.compensation[upper ? above : above - 1];
}

std::string description_of(Component component) {
  if (component == Component::C0Y) return "squareness of Y to X";
  if (component == Component::B0Z) return "squareness of Z to X";
  if (component == Component::A0Z) return "squareness of Z to Y";
  const char axis = letter_of(moving_axis(component));
  if (is_positioning(component)) return fmt::format("{} axis linear positioning error", axis);
  const char direction = letter_of(direction_of(sense_of(component)));
  if (is_straightness(component)) return fmt::format("{} axis straightness error in {}", axis, direction);
  if (direction == axis) return fmt::format("{} axis roll error", axis);
  return fmt::format("{} axis rotation about {} (pitch or yaw)", axis, direction);
}

double largest_in(const std::vector<MapTable>& tables, Component component) {
  double largest = 0.0;
  for (const MapTable& table : tables)
    if (table.component == component)
      for (const double value : table.compensation) largest = std::max(largest, std::abs(value));
  return largest;
}

}  // namespace ecs::laser
