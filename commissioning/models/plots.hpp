// Figures of models: measured against predicted, what is left of it, the ladder of errors.
#pragma once

#include <optional>
#include <vector>

#include "commissioning/models/lines.hpp"
#include "model/diagnosis/diagnose.hpp"
#include "model/fit/compare.hpp"

namespace ecs::commissioning {

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
