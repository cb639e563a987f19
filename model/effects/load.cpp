// Mass m of a workpiece or of a moving part, c·m and c·m·p.
#include "model/effects/definition.hpp"

namespace ecs::model::effects {

EffectDefinition load() {
  return {
      .id = "load",
      .title = "Load",
      .formula = "c m, and c m p",
      .cause = "mass of the workpiece or of a moving part",
      .tells_apart = "changes with the load alone",
      .check =
          "repeat a line with and without the workpiece; check the counterbalance and the parts that bend under the "
          "mass",
      .headline = "a shift of {readings} with the load, {sizes}",
      .parameters = {{"um_per_kg", "um/kg", "shift"}, {"um_per_kg_m", "um/kg/m", "change of slope"}},
      .carrier = Carrier::inputs,
      .live = {{"um_per_kg", ThermalLaw::shift, LiveSource::load},
               {"um_per_kg_m", ThermalLaw::growth, LiveSource::load}},
      .how = "a thermal row of the map that follows the load",
      .separated_by = {70, "Repeat the {axis} line unloaded and with the full load."},
      .traits = {.of_condition = true, .shows_at_zero = true},
      .place = Place::sense,
      .needs = {Need::load},
      .preference = 120,
      .columns =
          [](const ReadingAt& at, std::span<double> row) {
            row[0] = at.data.load_kg[at.k];
            row[1] = at.data.load_kg[at.k] * at.p_m();
          },
      .column_sets = {{0}, {1}, {0, 1}},
      .column_sets_elsewhere = {{1}, {1, 0}},
      .of_sense = [](const Site& site) { return site.once(!site.any_axis_varies); },
      .along_axis = [](const Site& site) { return site.once(); },
  };
}

}  // namespace ecs::model::effects
