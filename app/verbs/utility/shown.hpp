// In which unit the verbs of ECS UTILITY show positions. Does not live here: the units (params/position_unit.hpp).
#pragma once

#include "app/cli/verb_unit.hpp"
#include "commissioning/unit/transfer.hpp"
#include "params/position_unit.hpp"

namespace ecs::app {

/// As the unit's parameters say; mm where it has none. Asks the unit only where text is wanted: JSON is in mm.
[[nodiscard]] inline const params::PositionUnit& position_unit_for(const VerbContext& context, UnitLink& unit) {
  MeasurementSystem system = MeasurementSystem::metric;
  if (!context.console.json)
    if (const auto parameters = receive_parameters(unit.client())) system = parameters->measurement_system;
  return params::position_unit(system);
}

}  // namespace ecs::app
