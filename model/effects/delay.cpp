// Readings whose position and value are of different moments, because their channels are read one after the other or
// the drive follows its set position late: the error is what the reading channel moves meanwhile, -T·v·(1 + de/dp) (of
// a position loop T is the inverse of its velocity gain).
#include "base/units.hpp"
#include "laser/units.hpp"
#include "model/effects/definition.hpp"
#include "model/effects/quantities.hpp"

namespace ecs::model::effects {
namespace {

constexpr double kMsPerMinute = 60'000.0;

/// The position of a linear axis as it moves, the angle of a rotary one as it turns.
bool is_own_position(const Site& site) {
  return is_rotation(site.sense) == site.data.rotary && direction_of(site.sense) == site.axis;
}

}  // namespace

EffectDefinition delay() {
  return {
      .id = "delay",
      .title = "Delay between two channels",
      .formula = "-T v",
      .cause =
          "position and reading were not taken at the same moment: channels read one after the other, a filter, or a "
          "drive "
          "that follows late",
      .tells_apart =
          "in readings on the fly, proportional to the speed: absent at rest, small where the axis starts or "
          "stops; lost motion is the same at any speed",
      .check =
          "compare the sampling instants and filters of the two channels, and read the following error of the drive",
      .headline = "{readings} read {delay_ms} late while the axis moves",
      .parameters = {{"delay_ms", "ms", "time by which the reading is late"}},
      .carrier = Carrier::set_up,
      .how = "read both channels at the same moment; readings at rest do not show it",
      .separated_by = {40, "Repeat the {axis} line both ways at a quarter of the speed, or read it at rest."},
      .traits = {.in_motion = true, .one_per_axis = true, .on_rotary_axes = true},
      .needs = {Need::speed},
      .preference = 5,  // every reading on the fly has one, not every axis has lost motion
      .columns =
          [](const ReadingAt& at, std::span<double> row) {
            const double in_um = at.data.rotary ? laser::kUmPerMPerDegree : kUmPerMm;
            row[0] = at.data.axis[at.k] == *at.effect.axis
                         ? -speed_per_min(at.data, at.k) * reading_slope(at.data, at.k) / kMsPerMinute * in_um
                         : 0.0;
          },
      .of_sense = [](const Site& site) { return site.once(is_own_position(site) && site.data.through_chain.empty()); },
  };
}

}  // namespace ecs::model::effects
