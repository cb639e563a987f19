// A shift c of all readings of a sense: datum or laser zero; and of single lines of it, for the readout is set to zero
// again when the optics move to another line, and when it is measured again in another session.
#include "model/effects/definition.hpp"
#include "model/effects/separations.hpp"

namespace ecs::model::effects {

namespace {

/// The first line of a sense has the shift of the sense; every other one may have one of its own, and so may every
/// later session of a line.
std::vector<EffectInstance> of_further_lines(const Site& site) {
  std::vector<EffectInstance> each;
  if (site.data.line.empty() || !site.data.paths.empty()) return each;
  if (site.data.natural_axis(site.sense) != site.axis) {
    each.push_back(site.once().front());
    each.back().line = 1;
  }
  for (EffectInstance& one : site.on_further_lines()) each.push_back(std::move(one));
  if (const auto starts = site.data.sessions.find({site.axis, site.sense}); starts != site.data.sessions.end())
    for (const int run : starts->second) {
      each.push_back(site.once().front());
      each.back().from_run = run;
    }
  return each;
}

}  // namespace

EffectDefinition offset() {
  return {
      .id = "offset",
      .title = "Datum shift",
      .formula = "c",
      .cause = "datum or laser zero shifted",
      .tells_apart = "the same everywhere and at all times or, if the zero was set again, in every run from then on",
      .check = "check where the readout was set to zero, and the repeatability of the datum switch",
      .headline = "a shift of {um} in all {readings}",
      .parameters = {{"um", "um", "constant offset"}},
      .carrier = Carrier::error_map,
      .how = "a constant in the map, or the zero shift of the datum (parameter null_offset_mm)",
      .separated_by = separations::kFinerTargets,
      .traits =
          {.shows_at_zero = true, .of_lines = true, .is_usual = true, .one_per_axis = true, .on_rotary_axes = true},
      .place = Place::sense,
      .preference = 0,
      .columns = [](const ReadingAt&, std::span<double> row) { row[0] = 1.0; },
      .of_sense = [](const Site& site) { return site.once(); },
      .along_axis = of_further_lines,
  };
}

}  // namespace ecs::model::effects
