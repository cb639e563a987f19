// A machine with a map by hand, for the tests of the volume.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "volume/volume.hpp"

namespace ecs::volume {

/// TXYZ, 1000 × 500 × 400 mm from the reference at 0, nothing but a scale error of X: 20 um at 1000 mm.
inline CompensatedMachine straight_machine(const std::string& configuration = "TXYZ") {
  CompensatedMachine machine;
  machine.parameters.configuration.fill(0);
  std::copy(configuration.begin(), configuration.end(), machine.parameters.configuration.begin());
  machine.travel_mm = {{{{0.0, 1000.0}}, {{0.0, 500.0}}, {{0.0, 400.0}}}};
  machine.map.tables = {{Component::EXX, Approach::unknown, {0.0, 1000.0}, {0.0, -20.0}}};
  machine.errors = errors_of_map(machine.map, machine.parameters, {});
  return machine;
}

/// The same with every curve, 50 mm apart, from both sides; the header states how certain each is.
inline CompensatedMachine stated_machine(const std::string& configuration = "TXYZ") {
  CompensatedMachine machine = straight_machine(configuration);
  machine.map.tables.clear();
  for (std::size_t c = 0; c < kCurves; ++c) {
    const auto component = static_cast<Component>(c);
    const double length = (*machine.travel_mm[index_of(moving_axis(component))])[1];
    for (const Approach approach : {Approach::forward, Approach::reverse}) {
      laser::MapTable table{component, approach, {}, {}};
      for (double p = 0.0; p <= length; p += 50.0) {
        table.position_mm.push_back(p);
        table.compensation.push_back(10.0 * std::sin(3.0 * p / length + static_cast<double>(c)));
      }
      machine.map.tables.push_back(table);
    }
    machine.map.header.uncertainty.push_back({component, 1.0, 0.5, 8});
  }
  machine.errors = errors_of_map(machine.map, machine.parameters, {});
  return machine;
}

}  // namespace ecs::volume
