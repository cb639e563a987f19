// Which effects the data can show at all: every instance of the library with its axes, senses, codes and sensors.
#pragma once

#include <vector>

#include "model/data/observations.hpp"
#include "model/effects/effect.hpp"

namespace ecs::model {

/// The axis that an effect without a position belongs to: the only one moved in this sense, or the sense's own.
[[nodiscard]] Axis natural_axis(const Observations& data, Sense sense);

/// Axes whose coordinate takes at least two values in readings of this sense.
[[nodiscard]] std::vector<Axis> varied_axes(const Observations& data, Sense sense);

/// In an order that depends on the library alone. Faults of the map only where a map was active; effects that need a
/// sensor, feed, load, time or a known component only where the data have it.
[[nodiscard]] std::vector<EffectInstance> candidate_instances(const Observations& data);

/// What every measured curve has, to begin a model with: an offset (each instrument begins at a zero of its own), for
/// each axis that moves a slope, and lost motion where both approaches were measured. One of them left out, a diagnosis
/// would explain it by several others.
[[nodiscard]] std::vector<EffectInstance> usual_effects(const Observations& data);

/// Effects left out because the data lack what they need, in words.
[[nodiscard]] std::vector<std::string> untried_effects(const Observations& data);

}  // namespace ecs::model
