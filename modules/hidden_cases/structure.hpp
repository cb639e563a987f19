// Errors that no library holds: what a diagnosis should call structure, and not by the name of an effect.
// Does not live here: errors that have a name (ecs_emulator/effects).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "ecs_emulator/random/random.hpp"
#include "ecs_emulator/scene/scene.hpp"

namespace ecs::emulator {

struct Structure {
  std::vector<double> value;           ///< one per stop, size about 1 um; empty: none
  std::vector<std::string> variables;  ///< columns of the data that it depends on: each is a right answer
  std::string text;                    ///< what it is, in words
};

class StructureDrawing;
struct StructureDefinition {
  std::string_view id;
  Needs needs;  ///< of the measurement that can show it
  Structure (*draw)(StructureDrawing& drawing) = nullptr;
};

/// The emulator's list of them. Hidden cases draw by its order.
[[nodiscard]] const std::vector<StructureDefinition>& structures();
/// Draws one on this scene; without values where the scene has no room for it.
[[nodiscard]] Structure draw_structure(Random& random, const Scene& scene, const Ground& ground,
                                       const StructureDefinition& definition);

}  // namespace ecs::emulator
