// Errors that no library holds: what a diagnosis should call structure, and not by the name of an effect.
// Does not live here: errors that have a name (ecs_emulator/effects/effect.hpp).
#pragma once

#include <string>
#include <vector>

#include "ecs_emulator/hidden_cases/choice.hpp"
#include "ecs_emulator/hidden_cases/design.hpp"

namespace ecs::emulator {

struct Structure {
  std::vector<double> value;           ///< one per stop, size about 1 um; empty: none
  std::vector<std::string> variables;  ///< columns of the data that it depends on: each is a right answer
  std::string text;                    ///< what it is, in words
};

enum class StructureKind : std::uint8_t {
  bad_run,
  bad_pass,
  wander,
  bumped_optics,
  random_runs,
  run_slopes,
  squared_temperature,
  humidity,
  product,
  chirp,
  burst,
  dent,
  graduation,
  growing_backlash,
  warm_backlash,
  squared_feed,
  squared_load,
};
inline constexpr std::size_t kStructureKinds = 17;

[[nodiscard]] Needs needs_of(StructureKind kind);
/// Draws one on this scene; without values where the scene has no room for it.
[[nodiscard]] Structure draw_structure(Random& random, const Scene& scene, const Ground& ground, StructureKind kind);

}  // namespace ecs::emulator
