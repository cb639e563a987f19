// The part program that measures a plan, in the form of thesis appendix B. Does not live here: measuring without a
// program (ecs_emulator/instruments/measurement.hpp), running one (run.hpp).
#pragma once

#include <string>

#include "ecs_emulator/instruments/measurement.hpp"

namespace ecs::emulator {

/// Beyond the first target by the overrun, target by target with a dwell, M08, one second, M09; beyond the last, and
/// back; runs and equal steps as `$REP` loops. Other axes are sent to `plan.parked_mm` first where it says so.
/// Coordinates are written to the nanometre at most. Readings are taken standing, also where the plan wants them on the
/// fly.
[[nodiscard]] std::string program_for(const MeasurementPlan& plan);

}  // namespace ecs::emulator
