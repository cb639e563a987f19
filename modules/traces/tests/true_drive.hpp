// The drive of the test rig with the value that its report misprints put right.
#pragma once

#include "modules/traces/simulation.hpp"

namespace ecs::model {

inline DriveParameters true_drive() {
  DriveParameters drive;
  drive[DriveConstant::Kw] = 0.0632298;  // the printed value with its decimal point put right
  return drive;
}

}  // namespace ecs::model
