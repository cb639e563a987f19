// Where the files lie that a plan asked for before and after compensation: the form of `laser table` is filled in with
// it.
#pragma once

#include <string>

namespace ecs::commissioning {

struct MeasuredPhases {
  std::string plan;    ///< file
  std::string before;  ///< folder; empty: not known
  std::string after;   ///< folder
};

/// Kept as long as the program runs.
void remember_measured_phases(const MeasuredPhases& phases);
/// Those remembered last; empty: none.
[[nodiscard]] MeasuredPhases measured_phases();

}  // namespace ecs::commissioning
