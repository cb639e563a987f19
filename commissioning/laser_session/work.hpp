// Everything that follows from the choices: files read, lines, curves, the map. Worked out beside the screen; what did
// not change is taken over from before.
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "commissioning/laser_session/curves.hpp"
#include "commissioning/laser_session/lines.hpp"
#include "commissioning/laser_session/map_work.hpp"
#include "commissioning/session/task_runner.hpp"

namespace ecs::commissioning {

struct LaserWork {
  LaserChoices choices;  ///< what it was worked out from
  std::vector<LaserFile> files;
  std::vector<LaserLine> lines;
  LaserLineResults results;        ///< as many as lines
  std::vector<LaserCurve> curves;  ///< of the components that the map takes; of every line as long as there is no map
  LaserMapWork map;
  bool map_current = false;  ///< false: `map` is still that of older choices
};
using LaserWorkPtr = std::shared_ptr<const LaserWork>;

/// @param before   what was worked out last; null: nothing yet
/// @param folder   for files that a map needs prepared
/// @param with_map false: lines and curves of the readings alone, the map is taken over from before
[[nodiscard]] LaserWorkPtr worked_out(const LaserChoices& choices, const LaserWorkPtr& before,
                                      const std::filesystem::path& folder, bool with_map, JobControl& control);

}  // namespace ecs::commissioning
