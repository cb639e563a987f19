// What a measurement must offer so that an error can be seen in it.
// Does not live here: the drawing of such a measurement (design.hpp).
#pragma once

namespace ecs::emulator {

struct Needs {
  bool temperature = false;  ///< sensors, and hours in which temperatures change
  bool air = false;          ///< pressure and humidity, changing
  bool feeds = false;        ///< several feeds
  bool loads = false;        ///< several loads
  bool travel = false;       ///< travel since reversal
  bool map = false;          ///< the unit was compensating
  bool known = false;        ///< a component measured separately
  bool one_axis = false;     ///< a single axis is moved
  bool bidirectional = false;
  bool fine = false;          ///< short periods can be seen
  bool along = false;         ///< positioning, along the axis that moves
  bool translations = false;  ///< no rotations are measured
  bool levers = false;        ///< lines at several places of a lever arm
  bool squares = false;       ///< one axis against another
  bool grid = false;          ///< lines at several places, whatever the levers
  bool constant = false;      ///< one temperature, one pressure, one feed, one load
  bool time = false;
  bool irregular = false;  ///< targets at uneven distances: no period hides between them
  int least_axes = 1;
  int least_runs = 1;
  bool one_run = false;     ///< no target is measured again
  bool whole_runs = false;  ///< one line: a run is one stretch of time
};
/// What both need.
[[nodiscard]] Needs operator|(const Needs& a, const Needs& b);

}  // namespace ecs::emulator
