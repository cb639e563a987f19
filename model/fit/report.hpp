// A core fit told as a Fit. Internal (Eigen).
#pragma once

#include <optional>

#include "model/fit/core.hpp"
#include "model/fit/fit.hpp"

namespace ecs::model {

[[nodiscard]] Fit told(const Assembly& assembly, const Regressors& regressors, const CoreFit& core);

/// F test of the means at repeated places against the scatter of the repeats; nothing without enough repeats.
[[nodiscard]] std::optional<LackOfFit> lack_of_fit_of(const Observations& data, const Eigen::VectorXd& residual,
                                                      const NoiseModel& noise, const std::vector<bool>& left_out,
                                                      double fitted_parameters);

}  // namespace ecs::model
