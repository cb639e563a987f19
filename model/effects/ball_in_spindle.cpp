// A ball, probe or sensor in the spindle of a head with rotary axes that is not where its readings take it to be: a
// vector that turns with the tool, such as a wrong tool length.
#include "model/effects/artefact_place.hpp"

namespace ecs::model::effects {
namespace {

/// Without a rotary axis that carries the tool it is the zero of the readings.
bool head_turns(const Observations& data) {
  const std::string& letters = data.machine.rotary_configuration;  // behind the T: what carries the tool
  return letters.find_first_of("ABC", letters.find('T')) != std::string::npos;
}

}  // namespace

EffectDefinition ball_in_spindle() {
  return {
      .id = "ball_in_spindle",
      .title = "Position of the ball in the spindle",
      .formula = "x, y, z, turning with the tool",
      .cause = "the ball, probe or sensor in the spindle is not at its assumed position: length or run-out",
      .tells_apart = "a vector that turns with the tool; an error of an axis line does not",
      .check = "measure the length of the tool, and its run-out while the spindle turns",
      .headline = "an offset of the ball in the spindle by {x_um}, {y_um}, {z_um} along X, Y, Z",
      .parameters = {{"x_um", "um", "place along X of the tool at angles of 0"},
                     {"y_um", "um", "along Y"},
                     {"z_um", "um", "along Z"}},
      .carrier = Carrier::set_up,
      .how = "an error of the set-up: measure the length of the tool",
      .separated_by = kOtherPlaceOfBall,
      .traits = {.of_measurement = true, .is_usual = true, .on_rotary_axes = true},
      .place = Place::artefact,
      .preference = 93,
      .columns =
          [](const ReadingAt& at, std::span<double> row) {
            const ThroughChain& chain = at.data.through_chain[at.k];
            put(chain.tool == at.effect.ball ? chain.of_tool : Vector3{}, row);
          },
      .of_sense =
          [](const Site& site) {
            return head_turns(site.data) ? each_for_ball(site, site.data.tools_mm.size())
                                         : std::vector<EffectInstance>{};
          },
  };
}

}  // namespace ecs::model::effects
