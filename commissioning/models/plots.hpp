// Figures of models: measured against predicted, what is left of it, the ladder of errors.
#pragma once

#include <optional>
#include <vector>

#include "commissioning/models/lines.hpp"
#include "model/diagnosis/diagnose.hpp"
#include "model/fit/compare.hpp"

namespace ecs::commissioning {

/// Readings (control) with the model through them (lines), forward and reverse. @param run  absent: all runs
[[nodiscard]] PlotPanel measured_panel(const model::Observations& data, const model::Fit& fit, const MeasuredLine& line,
                                       std::optional<int> run = {});
/// What the model leaves: readings as control, means as lines.
[[nodiscard]] PlotPanel residual_panel(const model::Observations& data, const model::Fit& fit, const MeasuredLine& line,
                                       std::optional<int> run = {});

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
