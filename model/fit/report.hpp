// A core fit reported as a Fit, with units and names. Internal to model/ (Eigen).
#pragma once

#include <optional>

#include "model/fit/core.hpp"
#include "model/fit/fit.hpp"

namespace ecs::model {

/// Parameters with sigmas, correlations above one half, what is undetermined and why.
[[nodiscard]] Fit reported(const Assembly& assembly, const Regressors& regressors, const CoreFit& core);

/// F test of the means at repeated places against the scatter of the repeats; nothing without enough repeats.
/// @param residual  um or um/m, canonical order
/// @param fitted_parameters  rank of the fit, taken off the freedom of the means
[[nodiscard]] std::optional<LackOfFit> lack_of_fit_of(const Observations& data, const Eigen::VectorXd& residual,
                                                      const NoiseModel& noise, const std::vector<bool>& left_out,
                                                      double fitted_parameters);

}  // namespace ecs::model
