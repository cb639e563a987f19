// A joint of a scale or rail: h where p > p₀.
#include <algorithm>

#include "ecs_emulator/effects/definition.hpp"

namespace ecs::emulator {
namespace {

std::vector<double> between_targets_mm(const Scene&, const Ground& ground, const PlacedEffect& effect) {
  std::vector<double> middles;
  const auto& places = ground.cover(*effect.sense, *effect.axis).places_mm;
  for (std::size_t k = 1; k < places.size(); ++k) middles.push_back(0.5 * (places[k - 1] + places[k]));
  return middles;
}

/// Between two targets, three of them at least on either side and not near the ends: fewer are readings that are wrong
/// together.
bool draw_step(const Drawing& drawing, PlacedEffect& e) {
  const auto& places = places_under(drawing.ground, e);
  const int count = static_cast<int>(places.size());
  if (count < 8) return false;
  const int beyond = std::max(2, count / 5);
  const auto k = static_cast<std::size_t>(whole(drawing.random, beyond, count - 2 - beyond));
  e.parameters = {{"height_um", 2.0 * drawing.sign},
                  {"position_mm", rounded(between(drawing.random, places[k], places[k + 1]), 1000.0)}};
  return e.parameters["position_mm"] > places[k] && e.parameters["position_mm"] < places[k + 1];
}

}  // namespace

extern const EffectDefinition kStep{
    .id = "step",
    .parameters = {{.name = "height_um", .unit = "um", .growth = Growth::linear},
                   {.name = "position_mm", .unit = "mm", .search = between_targets_mm}},
    .needs_axis = true,
    .value = [](const PlacedEffect& e,
                const Conditions& at) { return at.p_mm > e.parameter("position_mm") ? e.parameter("height_um") : 0.0; },
    .places = on_all_axes,
    .draw = draw_step,
    .base_probability = 0.05,
    .excluded_from = Design::kOneLever,
};

}  // namespace ecs::emulator
