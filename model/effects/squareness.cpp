// Two axes not square to each other: one direction leans with the position of another axis.
#include "model/effects/definition.hpp"
#include "model/effects/quantities.hpp"
#include "model/effects/separations.hpp"

namespace ecs::model::effects {

EffectDefinition squareness() {
  return {
      .id = "squareness",
      .title = "Squareness",
      .formula = "-C0Y y or B0Z z in EX, -A0Z z in EY",
      .cause = "two axes not square to each other",
      .tells_apart = "one direction leans in proportion to the position of another axis",
      .check = "set a granite square against both axes, or measure both diagonals of a square of equal travels",
      .headline = "{pair} out of square by {um_per_m}",
      .parameters = {{"um_per_m", "um/m", "angle"}},
      .carrier = Carrier::parameters,
      .how = "the squareness parameter",
      .separated_by = separations::kSecondLine,
      .traits = {.one_per_axis = true},
      .place = Place::squareness,
      .columns = [](const ReadingAt& at, std::span<double> row) { row[0] = lever_m(at.data, at.k, *at.effect.code); },
  };
}

}  // namespace ecs::model::effects
