// Scale error of a rotary axis: gear ratio, tape or encoder. The error of an axis with an encoder of its own is the
// same again after a whole turn (ISO 230-7). Counted at the motor, a wrong ratio adds up from turn to turn.
#include <algorithm>

#include "model/effects/definition.hpp"

namespace ecs::model::effects {
namespace {

/// Angles over a turn at which a ramp is no sum of a few waves: the first five leave a ninth of its variance.
constexpr std::size_t kManyAngles = 12;

/// The readings distinguish it from waves: the axis cannot make a whole turn (by its travel where the machine file
/// gives it, else where the readings leave out a quarter of a turn, for an axis that turns fully is measured over all
/// of it), or the readings cover a whole turn, so that they show whether the error is the same again, or many angles
/// of it were measured without a ball.
bool is_seen(const Site& site) {
  if (site.data.through_chain.empty() && site.places >= kManyAngles) return true;
  constexpr double kWholeTurn_deg = 360.0, kMostOfReadings_deg = 270.0, kSamePlace_deg = 1e-6;
  double least = 0.0, greatest = 0.0;
  for (std::size_t k = 0; k < site.data.size(); ++k) {
    const double angle_deg = site.data.position_mm[k][index_of(site.axis)];
    least = k == 0 ? angle_deg : std::min(least, angle_deg);
    greatest = k == 0 ? angle_deg : std::max(greatest, angle_deg);
  }
  if (greatest - least >= kWholeTurn_deg - kSamePlace_deg) return true;
  if (const auto& axis = site.data.machine.rotary[index_of(site.axis)])
    return axis->travel_deg[1] - axis->travel_deg[0] < kWholeTurn_deg;
  return greatest - least <= kMostOfReadings_deg;
}

}  // namespace

EffectDefinition tilt_scale() {
  constexpr std::size_t kFewestAngles = 3;  // two angles are met by a line of any cause
  return {
      .id = "tilt_scale",
      .title = "Scale error of a rotary axis",
      .formula = "k b",
      .cause =
          "ratio or scale of the encoder or gear; on an axis that turns fully, a ratio between the motor's encoder and "
          "the axis",
      .tells_apart =
          "grows in proportion to the angle, both ways from zero, also beyond a whole turn, after which a wave repeats",
      .check =
          "compare the axis at its two ends, or before and after a whole turn, with a clinometer, a polygon or a laser "
          "with angular optics",
      .headline = "a scale error of {um_per_degree} in {where}",
      .parameters = {{"um_per_degree", "um/deg", "error per degree"}},
      .carrier = Carrier::error_map,
      .how = "a curve of the rotary axes in the map",
      .separated_by = {55, "Measure {axis} at both ends of its travel and in the middle."},
      .traits = {.is_smooth = true, .adds_up = true, .one_per_axis = true, .on_rotary_axes = true},
      .preference = 25,
      .columns_of_place = [](double angle_deg, double, std::span<double> row) { row[0] = angle_deg; },
      .along_axis =
          [](const Site& site) {
            const bool is_own = site.data.rotary && is_rotation(site.sense) && direction_of(site.sense) == site.axis;
            return site.once(is_own && site.places >= kFewestAngles && is_seen(site));
          },
  };
}

}  // namespace ecs::model::effects
