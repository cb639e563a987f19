// What the places of a ball on the table and in the spindle share.
#pragma once

#include "model/effects/definition.hpp"

namespace ecs::model::effects {

inline constexpr SeparatingMeasurement kOtherPlaceOfBall{
    95, "Set the ball up at another position and repeat: its position changes, an error of the machine does not."};

inline void put(const Vector3& along, std::span<double> row) {
  for (std::size_t d = 0; d < row.size(); ++d) row[d] = along[d];
}

/// One for all senses, of readings through a chain.
inline std::vector<EffectInstance> once_for_ball(const Site& site) {
  if (site.data.through_chain.empty() || site.sense != site.data.sense.front()) return {};
  EffectInstance effect;
  effect.rotary = true;
  return {effect};
}

}  // namespace ecs::model::effects
