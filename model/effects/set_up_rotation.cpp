// A plate, artefact or straight edge set up turned by a small angle c about an axis: a rigid rotation c × p of the
// readings, across the axis. In the plane XY (EC): EX −c·y, EY +c·x, and cyclically.
#include "model/effects/definition.hpp"

namespace ecs::model::effects {
namespace {

constexpr Axis next(Axis a) { return static_cast<Axis>((index_of(a) + 1) % kAxes); }
constexpr Sense translation_along(Axis a) { return static_cast<Sense>(index_of(a)); }
constexpr Sense rotation_about(Axis a) { return static_cast<Sense>(kAxes + index_of(a)); }

bool varies(const Observations& data, Sense sense, Axis axis) {
  std::optional<double> first;
  for (std::size_t k = 0; k < data.size(); ++k) {
    if (data.sense[k] != sense) continue;
    if (!first) first = data.p_mm(k, axis);
    if (data.p_mm(k, axis) != *first) return true;
  }
  return false;
}

/// Both rotations that act on this sense, where its cross coordinate varies; one that the other sense shows as well
/// belongs to the first of the two.
std::vector<EffectInstance> rotations(const Site& site) {
  std::vector<EffectInstance> all;
  for (const Axis about : kAllAxes) {
    const Axis one = next(about), other = next(one);
    const bool shows_in_one = varies(site.data, translation_along(one), other);
    const bool first = site.sense == translation_along(one) && shows_in_one;
    const bool second = site.sense == translation_along(other) && !shows_in_one && varies(site.data, site.sense, one);
    if (!first && !second) continue;
    all.emplace_back();
    all.back().sense = rotation_about(about);
  }
  return all;
}

}  // namespace

EffectDefinition set_up_rotation() {
  return {
      .id = "set_up_rotation",
      .title = "Turned set-up",
      .formula = "rotation EC: -c y in EX, c x in EY; likewise EA and EB",
      .cause = "plate, artefact or straight edge set up turned, not parallel to the axes",
      .tells_apart = "two directions lean equally and oppositely; changes with the set-up",
      .check =
          "move a dial gauge along the reference edge of the artefact, or turn the artefact by 180 degrees and measure "
          "again",
      .headline = "a set-up turned about {turn} by {um_per_m}",
      .parameters = {{"um_per_m", "um/m", "angle"}},
      .carrier = Carrier::set_up,
      .how = "an error of the measurement: align the artefact, or remove the rotation from its readings",
      .separated_by = {55,
                       "Remove the plate, artefact or straight edge, set it up again and repeat with column set_up = "
                       "2: a rotation of the set-up changes, an error of the machine does not."},
      .traits = {.until_new_set_up = true, .of_measurement = true},
      .place = Place::set_up,
      .preference = 90,
      .columns =
          [](const ReadingAt& at, std::span<double> row) {
            const Axis one = next(direction_of(*at.effect.sense)), other = next(one);
            const bool first = at.data.sense[at.k] == translation_along(one);
            row[0] = (first ? -at.data.p_mm(at.k, other) : at.data.p_mm(at.k, one)) / 1000.0;
          },
      .of_sense = rotations,
  };
}

}  // namespace ecs::model::effects
