// Isolated readings that agree neither with their neighbours in the pass nor with their repeats.
// Internal to this room (Eigen). Does not live here: what a fit does with them (fit.cpp).
#pragma once

#include <vector>

#include <Eigen/Dense>

#include "model/data/observations.hpp"

namespace ecs::model {

/// @param residual  readings less what is believed
[[nodiscard]] std::vector<bool> isolated_outliers(const Observations& data, const Eigen::VectorXd& residual);

}  // namespace ecs::model
