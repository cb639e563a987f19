// Figures of models: measured against predicted, what is left of it, the ladder of errors. Between the targets the
// fitted model is shown dense: joined at the targets alone, a wave of 10 mm would look like one of three steps.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "commissioning/models/view.hpp"
#include "commissioning/plot/figure.hpp"
#include "model/diagnosis/diagnose.hpp"
#include "model/fit/compare.hpp"
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

/// "µm/m" of "um/m".
[[nodiscard]] std::string plot_unit(std::string_view unit);

/// Which readings of a line a panel shows: the means per target, those of one run, or all.
struct ShownReadings {
  std::optional<int> run;
  bool means = true;  ///< where no run is given
  friend bool operator==(const ShownReadings&, const ShownReadings&) = default;
};
/// Readings (dots) with the model through them (lines), forward and reverse.
[[nodiscard]] PlotPanel measured_panel(const model::Observations& data, const model::Fit& fit, const MeasuredLine& line,
                                       const ShownReadings& shown = {});
/// What the model leaves: readings as dots, means as lines.
[[nodiscard]] PlotPanel residual_panel(const model::Observations& data, const model::Fit& fit, const MeasuredLine& line,
                                       const ShownReadings& shown = {});
/// The same over each period of the model, and against run, time, travel since reversal and every sensor, as far as the
/// readings of the line differ in it.
[[nodiscard]] std::vector<PlotPanel> residual_panels_of_variables(const model::Observations& data,
                                                                  const model::Fit& fit, const MeasuredLine& line);

/// The lines with the largest residuals: readings against model, and the residual; each periodic effect over its
/// period.
[[nodiscard]] PlotFigure fit_figure(const model::Fit& fit, const model::Observations& data, const std::string& title);

/// The same with what the named effects of a diagnosis would explain of the residual, and the residual against the
/// variable on which it depends most.
[[nodiscard]] Result<PlotFigure> diagnosis_figure(const model::Model& model, const model::Observations& data,
                                                  const model::Diagnosis& diagnosis, bool plain);

/// Bars of the rms falling step by step towards the noise floor.
[[nodiscard]] PlotFigure ladder_figure(const std::vector<model::LadderStep>& history, const std::string& title);

}  // namespace ecs::commissioning
