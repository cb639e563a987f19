#include "volume/components.hpp"

#include <algorithm>

namespace ecs::volume {
namespace {

/// @param sign  −1: errors, 1: compensation
Components components_in(const laser::ErrorMap& map, const UnitParameters& parameters, const Grid& grid,
                         Interpolation interpolation, double sign) {
  Components out;
  for (std::size_t c = 0; c < kCurves; ++c) {
    const auto component = static_cast<Component>(c);
    if (!grid.exists[index_of(moving_axis(component))]) continue;
    const double scale = sign * (is_angular(component) ? parameters.angular_scale : 1.0);
    for (const Approach approach : kSides) {
      const laser::MapTable* table = table_of(map, component, approach);
      if (table == nullptr || table->position_mm.empty()) continue;
      auto& values = out.curve[side_of(approach)][c];
      for (const double p : coordinates_of(grid, moving_axis(component)))
        values.push_back(scale * laser::unit_value_at(*table, interpolation, p));
    }
  }
  for (const Component square : {Component::C0Y, Component::B0Z, Component::A0Z})
    out.squareness[index_of(square)] = -sign * squareness_um_per_m(parameters, square);
  return out;
}

}  // namespace

std::vector<double> coordinates_of(const Grid& grid, Axis axis) {
  std::vector<double> mm = grid.mm[index_of(axis)];
  mm.push_back(grid.reference_mm[index_of(axis)]);
  return mm;
}

Components errors_in(const laser::ErrorMap& map, const UnitParameters& parameters, const Grid& grid) {
  return components_in(map, parameters, grid, Interpolation::linear, -1.0);
}

Components compensation_in(const laser::ErrorMap& map, const UnitParameters& parameters, const Grid& grid) {
  return components_in(map, parameters, grid, parameters.interpolation, 1.0);
}

}  // namespace ecs::volume
