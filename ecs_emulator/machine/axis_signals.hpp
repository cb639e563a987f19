// The wires between the unit's axis module and the machine's axis: what crosses them in one period of the loop.
#pragma once

#include <cstdint>

#include "core/axis.hpp"

namespace ecs::emulator {

/// From the axis to the unit.
struct AxisSignals {
  std::int64_t counts = 0;         ///< transducer position since the machine was switched on
  bool switch_closed = false;      ///< reference switch
  bool marker = false;             ///< the transducer's marker passed since the last period
  std::int64_t marker_counts = 0;  ///< where, latched by the axis module
  bool transducer_ok = true;       ///< false: signal lost
};

/// From the unit to the axis.
struct AxisDrive {
  std::int32_t dac_counts = 0;
  bool relay_closed = false;
};

using Signals = PerAxis<AxisSignals>;
using Drives = PerAxis<AxisDrive>;

}  // namespace ecs::emulator
