// What the places of a ball on the table and in the spindle share; which components of the machine its sizes belong to.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "model/effects/definition.hpp"

namespace ecs::model {

/// The parameter is the slope of a curve along its axis, or a squareness [um/m].
struct ComponentTerm {
  std::string_view parameter;
  Component component = Component::EXX;
};

/// Of an artefact that shows errors which the unit can carry; empty for all other effects.
[[nodiscard]] std::span<const ComponentTerm> components_of(const EffectDefinition& effect);

}  // namespace ecs::model

namespace ecs::model::effects {

inline constexpr SeparatingMeasurement kOtherPlaceOfBall{
    95, "Set the ball up at another position and repeat: its position changes, an error of the machine does not."};

inline void put(const Vector3& along, std::span<double> row) {
  for (std::size_t d = 0; d < row.size(); ++d) row[d] = along[d];
}

/// The rotary axis next to the tool, where one carries it. @param letters  "XTYZCB"
inline std::optional<Axis> tilting_axis(std::string_view letters) {
  const std::size_t last = letters.find_last_of("ABCT");
  return last == std::string::npos || letters[last] == 'T' ? std::nullopt
                                                           : std::optional(static_cast<Axis>(letters[last] - 'A'));
}
inline std::optional<Axis> tilting_axis(const Observations& data) {
  return tilting_axis(data.machine.rotary_configuration);
}

/// One for all senses, of readings through a chain.
inline std::vector<EffectInstance> once_for_ball(const Site& site) {
  if (site.data.through_chain.empty() || site.sense != site.data.sense.front()) return {};
  EffectInstance effect;
  effect.rotary = true;
  return {effect};
}

/// One for each of `count` balls on the table, or tools in the spindle.
inline std::vector<EffectInstance> each_for_ball(const Site& site, std::size_t count) {
  std::vector<EffectInstance> each;
  const auto one = once_for_ball(site);
  for (std::size_t number = 1; !one.empty() && number <= count; ++number) {
    each.push_back(one.front());
    each.back().ball = static_cast<int>(number);
  }
  return each;
}

}  // namespace ecs::model::effects
