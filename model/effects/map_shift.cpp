// The map's datum is not the machine's: map(p + Δ) − map(p).
#include <algorithm>

#include "model/effects/definition.hpp"
#include "model/effects/quantities.hpp"
#include "model/effects/separations.hpp"

namespace ecs::model::effects {
namespace {

/// Shifts: half an increment each, no finer than this many over the map's range, up to half of the range; below half
/// an increment by a factor, from this part of the range on.
constexpr double kMostShifts = 240.0, kLargestShift = 0.5, kFinestShifts = 2000.0, kShiftFactor = 1.3;

TriedValues shifts(const Observations& data, const EffectInstance& effect, const Acting&, const SearchExtent&) {
  TriedValues tried;
  double widest = 0.0, increment = 1e300;
  for (const laser::MapTable& table : data.map->tables) {
    if (effect.axis && moving_axis(table.component) != *effect.axis) continue;
    if (table.position_mm.size() < 2) continue;
    widest = std::max(widest, table.position_mm.back() - table.position_mm.front());
    increment = std::min(increment, (table.position_mm.back() - table.position_mm.front()) /
                                        static_cast<double>(table.position_mm.size() - 1));
  }
  if (widest <= 0.0) return tried;
  const auto add = [&](double shift) {
    tried.values.push_back(shift);
    tried.values.push_back(-shift);
  };
  // its size is not fitted: a small shift tried twice too large looks worse than none
  const double step = std::max(0.5 * increment, widest / kMostShifts);
  for (double shift = widest / kFinestShifts; shift < step; shift *= kShiftFactor) add(shift);
  for (double shift = step; shift <= kLargestShift * widest; shift += step) add(shift);
  tried.independent = static_cast<double>(tried.values.size()) / 2.0;
  return tried;
}

}  // namespace

EffectDefinition map_shift() {
  return {
      .id = "map_shift",
      .title = "Map shifted along the axis",
      .formula = "map(p + delta) - map(p)",
      .cause = "datum of the map and of the machine differ",
      .tells_apart = "has the shape of the map's own slope",
      .check = "move the axis to its datum and compare the position of the unit with that of the control",
      .headline = "the {map} applied {shift_mm} off its place",
      .parameters = {{"shift_mm", "mm", "shift", Coding::searched}},
      .carrier = Carrier::parameters,
      .how = "the reference position",
      .separated_by = separations::kCompensationOff,
      .traits = {.fixed_size = true},
      .place = Place::map,
      .preference = 30,
      .fixed_part =
          [](const ReadingAt& at) {
            return map_compensation(at.data, at.k, at.effect, at.searched, at.data.approach[at.k]) -
                   map_compensation(at);
          },
      .search = {.tried = shifts,
                 .assumed = [](const Observations&, const EffectInstance&, const Acting&) { return 1.0; },
                 .either_sign = true},
  };
}

}  // namespace ecs::model::effects
