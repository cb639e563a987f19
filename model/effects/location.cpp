// Place and direction of the axis line of a rotary axis (location errors XOC, YOC, AOC, BOC, COC … of ISO 230-7 and
// ISO 230-1), acting through the chain of the machine: what readings of a ball show (ISO 10791-6, BK1 to BK4; S.
// Ibaraki, W. Knapp, Int. J. Automation Technol. 6 (2012) 110).
#include <array>

#include "model/effects/definition.hpp"

namespace ecs::model::effects {
namespace {

constexpr std::array kLetters{Sense::EX, Sense::EY, Sense::EZ, Sense::EA, Sense::EB, Sense::EC};

bool shows(const Observations& data, Axis axis, Sense letter) {
  for (std::size_t k = 0; k < data.size(); ++k)
    if (data.share_of(k, axis, letter) != 0.0) return true;
  return false;
}

/// Five of each rotary axis, those of axes that moved first: a shift along its own line is none.
std::vector<EffectInstance> locations(const Site& site) {
  std::vector<EffectInstance> all;
  if (site.data.through_chain.empty() || site.sense != site.data.sense.front()) return all;  // once
  for (const Axis axis : site.data.rotary_axes)
    for (const Sense letter : kLetters) {
      const bool along_itself = !is_rotation(letter) && direction_of(letter) == axis;
      if (along_itself || !shows(site.data, axis, letter)) continue;
      all.emplace_back();
      all.back().axis = axis;
      all.back().rotary = true;
      all.back().sense = letter;
    }
  return all;
}

}  // namespace

EffectDefinition location() {
  return {
      .id = "location",
      .title = "Location error of a rotary axis",
      .formula = "shift of the tool by a location error such as XOC",
      .cause = "position or squareness of the axis of rotation other than the control assumes",
      .tells_apart =
          "the same at all angles of its axis in the directions of the part that does not turn; a displaced ball turns "
          "with the workpiece",
      .check =
          "check pivot and offsets of the rotary axis in the machine data of the control with a ball or a test bar: "
          "turn the axis by 180 degrees and halve the difference",
      .headline = "an offset of the {axis} axis line by {um} ({code})",
      .parameters = {{"um", "um", "position of the axis line; for AO., BO., CO. its direction or zero, um_per_m"}},
      .carrier = Carrier::error_map,
      .how = "location errors of the rotary axes in the map",
      .separated_by = {54,
                       "Measure the ball again over the whole turn of {axis} at another angle of the other rotary "
                       "axis; turn the spindle by 180 degrees between two readings to determine the zero of the probe. "
                       "Then measure the ball at another radius and height."},
      .traits = {.one_per_axis = true, .on_rotary_axes = true},
      .place = Place::location,
      .preference = -10,
      .columns = [](const ReadingAt& at,
                    std::span<double> row) { row[0] = at.data.share_of(at.k, *at.effect.axis, *at.effect.sense); },
      .of_sense = locations,
  };
}

}  // namespace ecs::model::effects
