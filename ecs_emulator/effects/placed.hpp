// An effect of the emulator's own list at its place in a machine, with its size.
// Does not live here: what an effect of that kind is (definition.hpp).
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/axis.hpp"
#include "ecs_emulator/effects/smooth_curve.hpp"
#include "ecs_emulator/scene/scene.hpp"

namespace ecs::emulator {

struct EffectDefinition;

/// Parameters bear the names of docs/physics.md; curves have a shape instead.
struct PlacedEffect {
  const EffectDefinition* kind = nullptr;
  std::optional<Axis> axis;
  std::optional<Sense> sense;
  std::optional<Component> code;
  Approach approach = Approach::unknown;  ///< unknown: both
  std::string sensor;                     ///< of an effect that depends on one
  std::string sensor2;                    ///< of an effect that depends on two
  std::map<std::string, double, std::less<>> parameters;
  SmoothCurve curve;
  [[nodiscard]] double parameter(std::string_view name) const;  ///< 0 where there is none
};

/// "cyclic:X:EX", "angular:X:ECX", "map_polarity:X" (all curves of X), "map_polarity" (the whole map).
[[nodiscard]] std::string name_of(const PlacedEffect& effect);
/// The same with a contribution `factor` times as large. @pre not a fault of the map; an effect of one sign keeps it
[[nodiscard]] PlacedEffect scaled(PlacedEffect effect, double factor);
/// It acts on this reading at all.
[[nodiscard]] bool acts_on(const PlacedEffect& effect, const Stop& stop);
/// The effects of one component each that it consists of; mostly itself alone.
[[nodiscard]] std::vector<PlacedEffect> parts_of(const PlacedEffect& effect);
/// The component of the machine that carries it. @pre it has its seat in the machine and is a part
[[nodiscard]] Component carrier_of(const PlacedEffect& effect);

}  // namespace ecs::emulator
