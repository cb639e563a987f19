// A circular test from its file to its causes, for the verb and for the report.
// Does not live here: the values of ISO 230-4 (laser/standards/circle.hpp), how causes are found (model/circle).
#pragma once

#include <filesystem>

#include "base/result.hpp"
#include "laser/standards/circle.hpp"
#include "model/circle/diagnosis.hpp"
#include "params/machine.hpp"

namespace ecs::commissioning {

struct CircleWork {
  std::filesystem::path file;
  laser::CircleTest test;
  laser::CircleValues values;
  model::CircleDiagnosis diagnosis;
};

/// @param machine  for the pitches of its axes; null: none are known
/// Refused: a file that is no circular test, a plane with an axis that the machine does not have, too few readings.
[[nodiscard]] Result<CircleWork> circle_work(const std::filesystem::path& file, const params::Machine* machine);

}  // namespace ecs::commissioning
