// Scale error of a rotary axis that does not turn fully: gear ratio, tape or encoder of a tilting axis. What turns
// fully comes back to its start and has none (ISO 230-7).
#include <algorithm>

#include "model/effects/definition.hpp"

namespace ecs::model::effects {
namespace {

/// The axis cannot make a whole turn: by its travel where the machine file gives it, else where the readings leave a
/// quarter of a turn out, for an axis that turns fully is measured over all of it.
bool is_arc(const Site& site) {
  constexpr double kWholeTurn_deg = 360.0, kMostOfReadings_deg = 270.0;
  if (const auto& axis = site.data.machine.rotary[index_of(site.axis)])
    return axis->travel_deg[1] - axis->travel_deg[0] < kWholeTurn_deg;
  double least = 0.0, greatest = 0.0;
  for (std::size_t k = 0; k < site.data.size(); ++k) {
    const double angle_deg = site.data.position_mm[k][index_of(site.axis)];
    least = k == 0 ? angle_deg : std::min(least, angle_deg);
    greatest = k == 0 ? angle_deg : std::max(greatest, angle_deg);
  }
  return greatest - least <= kMostOfReadings_deg;
}

}  // namespace

EffectDefinition tilt_scale() {
  constexpr std::size_t kFewestAngles = 3;  // two angles are met by a line of any cause
  return {
      .id = "tilt_scale",
      .title = "Scale error of a tilting axis",
      .formula = "k b",
      .cause = "ratio or scale of the encoder or gear of an axis that does not turn fully",
      .tells_apart = "grows in proportion to the angle, both ways from zero; a wave of one turn bends",
      .check = "compare the axis at its two ends with a clinometer, a polygon or a laser with angular optics",
      .headline = "{where} with a scale error of {um_per_degree}",
      .parameters = {{"um_per_degree", "um/deg", "error of a degree"}},
      .carrier = Carrier::error_map,
      .how = "a curve of the rotary axes in the map",
      .separated_by = {55, "Measure {axis} at both ends of its travel and in the middle."},
      .traits = {.is_smooth = true, .one_per_axis = true, .on_rotary_axes = true},
      .preference = 25,
      .columns_of_place = [](double angle_deg, double, std::span<double> row) { row[0] = angle_deg; },
      .along_axis =
          [](const Site& site) {
            const bool is_own = site.data.rotary && is_rotation(site.sense) && direction_of(site.sense) == site.axis;
            return site.once(is_own && site.places >= kFewestAngles && is_arc(site));
          },
  };
}

}  // namespace ecs::model::effects
