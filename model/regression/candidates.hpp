// The candidates of a data set: every effect of the library with its axes, senses, codes and sensors; and location
// errors of rotary axes that readings of a ball cannot tell from what a model has.
#pragma once

#include <vector>

#include "model/effects/definition.hpp"

namespace ecs::model {

/// The axis that an effect without a position belongs to: the only one moved in this sense, or the sense's own.
[[nodiscard]] Axis natural_axis(const Observations& data, Sense sense);

/// Axes whose coordinate takes at least two values in readings of this sense.
[[nodiscard]] std::vector<Axis> varied_axes(const Observations& data, Sense sense);

/// Every place at which the definitions of the library seek their effect, in an order that depends on the library
/// alone: by sense, then at its natural axis, along axes, at reversals, each by preference; then levers, then faults of
/// the map, where one was active. Effects whose needs the data lack are left out (untried_effects).
[[nodiscard]] std::vector<EffectInstance> candidate_instances(const Observations& data);

/// What every measured curve has, to begin a model with: an offset (each instrument begins at a zero of its own), for
/// each axis that moves a slope, and lost motion where both approaches were measured. One of them left out, a diagnosis
/// would explain it by several others. Of readings along paths nothing: what they have of an offset is taken out of
/// them, and a slope or lost motion is what such a test is made to find. Of a ball its place and location errors of the
/// rotary axes as far as the readings tell them from each other; what does the same as one of them is its alternative.
[[nodiscard]] std::vector<EffectInstance> usual_effects(const Observations& data);

struct Exchangeable {
  EffectInstance effect;
  double stands_for = 0.0;  ///< um, um/m: size at which it would do what fitted values of the model do in its place
  /// By how much a fitted location error would be larger if this one were 1 and not in the model.
  struct Share {
    EffectInstance of;
    double by = 0.0;
  };
  std::vector<Share> shares{};
};
/// Location errors, zeros of axes apart, that are not in the model and that the readings do not tell from its effects.
/// None without readings of a ball.
/// @param fitted  with the values of the fit; without them `stands_for` is 0
[[nodiscard]] std::vector<Exchangeable> exchangeable_locations(const Observations& data,
                                                               const std::vector<EffectInstance>& fitted);

}  // namespace ecs::model
