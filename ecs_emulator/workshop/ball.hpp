// What a ball on the table and the spindle show of a machine with rotary axes: the linear axes follow the ball while a
// rotary axis turns (R-test, or a probe that measures a ball; ISO 10791-6, BK1 to BK4), and readings of an error motion
// by itself. The poses are taken as reached: cold, unloaded, standing; no unit is there: it would know three axes.
// Does not live here: what the readings say of the machine (the host).
#pragma once

#include <array>
#include <vector>

#include "base/result.hpp"
#include "ecs_emulator/machine/simulation.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::emulator {

/// One rotary axis moves, there and back; the others stand.
struct Sweep {
  std::size_t axis = 0;  ///< A, B, C
  std::vector<double> targets_deg;
  Vector3 parked_deg{};
};

struct BallPlan {
  Vector3 ball_mm{};          ///< where the linear axes touch it, all angles 0
  Vector3 tool_offset_mm{};   ///< from the point at which the curves count to the ball in the spindle
  Vector3 off_um{};           ///< by which the ball on the table is off that place, along X, Y, Z of the table
  Vector3 tool_off_um{};      ///< by which that in the spindle is off
  std::vector<Sweep> sweeps;  ///< none: usual_sweeps(), as far as the ball is in reach
  int runs = 2;
  double noise_um = 0.3;      ///< standard deviation of a reading
  double seconds = 5.0;       ///< from one pose to the next
  bool on_workpiece = false;  ///< sensors turn with the table: readings along its X, Y, Z
};

/// Every rotary axis over its travel with the other at 0, and again with the other half way to the farther end: 12
/// targets, a turn without its end.
[[nodiscard]] std::vector<Sweep> usual_sweeps(const params::Machine& machine);

/// EX, EY, EZ at every pose. Refused: a machine without X, Y, Z or without rotary axes, an angle or a place beyond the
/// travels.
[[nodiscard]] Result<laser::MeasurementSet> ball_readings(Simulation& simulation, const BallPlan& plan);

struct TurnPlan {
  Sweep sweep;
  Sense sense = Sense::EC;
  int runs = 3;
  double noise = 0.3;  ///< um, um/m
  double seconds = 5.0;
};

/// Readings of an error motion by itself, counted from the first target.
[[nodiscard]] Result<laser::MeasurementSet> turn_readings(Simulation& simulation, const TurnPlan& plan);

/// "C=0:330:30" the axis that moves, "/A=-60" where another stands. A `usage` problem says what is wrong.
[[nodiscard]] Result<Sweep> sweep_in(std::string_view text);

}  // namespace ecs::emulator
