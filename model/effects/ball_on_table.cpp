// A ball, sensor or artefact on the workpiece side that is not where its readings take it to be: a vector that turns
// with the workpiece (set-up of an R-test, ISO 10791-6; eccentricity of ISO 230-7 where a test bar turns on a table).
#include "model/effects/artefact_place.hpp"

namespace ecs::model::effects {

EffectDefinition ball_on_table() {
  return {
      .id = "ball_on_table",
      .title = "Position of the ball on the table",
      .formula = "-(x, y, z), turning with the workpiece",
      .cause = "the ball, sensor or artefact on the table is not at its assumed position, or off the axis line",
      .tells_apart = "a vector that turns with the workpiece; an error of an axis line does not",
      .check = "measure the ball with the probe at angles of 0, and use that position as its target",
      .headline = "an offset of the ball on the table by {x_um}, {y_um}, {z_um} along X, Y, Z",
      .parameters = {{"x_um", "um", "place along X of the workpiece at angles of 0"},
                     {"y_um", "um", "along Y"},
                     {"z_um", "um", "along Z"}},
      .carrier = Carrier::set_up,
      .how = "an error of the set-up: measure the position of the ball",
      .separated_by = kOtherPlaceOfBall,
      .traits = {.of_measurement = true, .is_usual = true, .on_rotary_axes = true},
      .place = Place::artefact,
      .preference = 92,
      .columns =
          [](const ReadingAt& at, std::span<double> row) {
            const ThroughChain& chain = at.data.through_chain[at.k];
            put(chain.ball == at.effect.ball ? chain.of_workpiece : Vector3{}, row);
          },
      .of_sense = [](const Site& site) { return each_for_ball(site, site.data.balls_mm.size()); },
  };
}

}  // namespace ecs::model::effects
