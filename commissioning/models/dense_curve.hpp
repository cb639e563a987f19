// A fitted model between the targets, as pictures show it: joined at the targets alone, a wave of 10 mm would look like
// one of three steps.
#pragma once

#include <cstddef>
#include <vector>

#include "commissioning/plot/figure.hpp"
#include "model/fit/fit.hpp"

namespace ecs::commissioning {

/// Readings of one line and one approach, of equal sense and moving axis.
struct LineReadings {
  const model::Observations& data;
  Axis axis = Axis::X;            ///< the moving axis
  std::vector<std::size_t> rows;  ///< canonical order
};

/// The targets and places between them [mm, machine coordinates], ascending: so close that a twelfth of the shortest
/// period of `effects` along the axis is seen, up to some thousands.
[[nodiscard]] std::vector<double> dense_places(const LineReadings& line, const std::vector<model::EffectFit>& effects);

/// Whether a picture can show the shortest period of `effects` along the axis: more than some dozens over the travel
/// fill it.
[[nodiscard]] bool can_be_seen(const LineReadings& line, const std::vector<model::EffectFit>& effects);

/// The model at these places: between two targets with the conditions of the readings at both, weighed by distance, so
/// that at a target it is the mean over its readings. Empty where the model cannot be evaluated there.
/// @param places_mm  inside the targets, ascending
[[nodiscard]] std::vector<PlotPoint> dense_curve(const LineReadings& line, const std::vector<model::EffectFit>& effects,
                                                 const std::vector<double>& places_mm);

/// Readings less everything but one periodic effect, and the effect itself, over one period [mm, from the datum].
/// @pre effect < fit.effects.size(), periodic, with a value of its period
[[nodiscard]] PlotPanel folded_panel(const model::Fit& fit, const model::Observations& data, std::size_t effect);
/// Numbers of the effects that fold, from `first` on.
[[nodiscard]] std::vector<std::size_t> folding_effects(const model::Fit& fit, std::size_t first);

}  // namespace ecs::commissioning
