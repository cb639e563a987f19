// A jump h·[p > p0] at one place: a joint in a scale, a damaged screw.
#include <algorithm>

#include "model/effects/definition.hpp"
#include "model/effects/quantities.hpp"

namespace ecs::model::effects {
namespace {

/// Targets on either side: fewer are readings that are wrong together, not a joint.
constexpr std::size_t kBesides = 3;

/// Halfway between neighbouring targets; no more than a choice of processor time allows.
TriedValues places(const Observations& data, const EffectInstance& effect, const Acting& acting, const SearchExtent&) {
  constexpr std::size_t kMost = 200;
  const std::vector<double> p = acting_positions(data, acting, *effect.axis);
  const std::size_t stride = std::max<std::size_t>(1, p.size() / kMost);
  TriedValues tried;
  for (std::size_t i = kBesides; i + kBesides <= p.size(); i += stride) tried.values.push_back(0.5 * (p[i] + p[i - 1]));
  tried.independent = static_cast<double>(p.size());
  return tried;
}

double middle(const Observations& plan, const EffectInstance& effect, const Acting& acting) {
  const auto [least, greatest] = acting_range(plan, acting, *effect.axis);
  return 0.5 * (least + greatest);
}

}  // namespace

EffectDefinition step() {
  return {
      .id = "step",
      .title = "Step",
      .formula = "h [p > p0]",
      .cause = "joint between two pieces of scale, damaged screw",
      .tells_apart = "a jump at one place, level on both sides",
      .check =
          "inspect that position for a joint of the scale or rack, a chip on the scale or a damaged track of the screw",
      .headline = "a step of {height_um} in {where}, {position_mm} from the datum",
      .parameters = {{"height_um", "um", "jump"},
                     {"position_mm", "mm", "position of the jump from the datum", Coding::searched}},
      .carrier = Carrier::error_map,
      .how = "a table of the error map",
      .separated_by = {110, "Measure {axis} in fine steps across the jump, both ways.", false},
      .turns_into = {{Limit::at_least, "offset"}, {Limit::at_greatest, "offset"}},
      .traits = {.shape_of_position = true, .one_per_axis = true, .on_rotary_axes = true},
      .preference = 40,
      .columns_of_place = [](double p_mm, double searched,
                             std::span<double> row) { row[0] = p_mm > searched ? 1.0 : 0.0; },
      .search = {.tried = places, .assumed = middle, .has_slope = false},
      .along_axis = [](const Site& site) { return site.once(site.places >= 2 * kBesides); },
  };
}

}  // namespace ecs::model::effects
