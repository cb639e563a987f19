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

/// The same with rotary axes, each from −100 to 200 deg and with every error of its own, 25 deg apart, from both sides.
inline CompensatedMachine stated_rotary_machine(const std::string& configuration) {
  CompensatedMachine machine = stated_machine(kinematics::linear_configuration(configuration));
  RotaryAxes rotary;
  rotary.machine.chain = *kinematics::joint_chain_of(configuration);
  rotary.machine.terms = kinematics::terms_of(rotary.machine.chain);
  for (const kinematics::ChainJoint& one : rotary.machine.chain) {
    if (!is_rotary(one.joint)) continue;
    const std::size_t r = index_of(one.joint) - kAxes;
    rotary.machine.rotary[r].direction = {};
    rotary.machine.rotary[r].direction[r] = 1.0;
    rotary.machine.rotary[r].pivot_mm = {400.0 - 30.0 * static_cast<double>(r), 250.0, 100.0};
    rotary.travel_deg[r] = {-100.0, 200.0};
    for (std::size_t s = 0; s < kSenseNames.size(); ++s) {
      rotary.errors.location[r][s] = 10.0 + static_cast<double>(s);
      for (const Approach side : {Approach::forward, Approach::reverse}) {
        RotaryTable table{one.joint, static_cast<Sense>(s), side, {}, {}, {}};
        for (double p = -100.0; p <= 200.0; p += 25.0) {
          table.p_deg.push_back(p);
          table.error.push_back(12.0 * std::sin(0.02 * p + static_cast<double>(s)) + static_cast<double>(side));
        }
        rotary.errors.tables.push_back(table);
      }
    }
  }
  machine.rotary = rotary;
  return machine;
}

}  // namespace ecs::volume
