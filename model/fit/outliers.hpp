// Isolated readings that agree neither with their neighbours in the pass nor with their repeats.
// Internal to model/ (Eigen). Does not live here: what a fit does with them (fit.cpp).
#pragma once

#include <vector>

#include <Eigen/Dense>

#include "model/data/observations.hpp"

namespace ecs::model {

/// One flag per reading, canonical order; none is set below 12 readings, nor where three follow each other in a pass,
/// and in a sense at most one in twenty: of more only the oddest that stand apart from the rest. Source: outliers.cpp.
/// @param residual  readings less what the model says, um or um/m
[[nodiscard]] std::vector<bool> isolated_outliers(const Observations& data, const Eigen::VectorXd& residual);

/// Readings of unknown approach in a run whose other readings, four fifths or more, have one, as its first reading: an
/// effect of approach acts on them with a sign that nobody knows, so they judge none.
[[nodiscard]] std::vector<bool> of_unknown_approach(const Observations& data);

/// Both of these.
[[nodiscard]] std::vector<bool> rows_left_out(const Observations& data, const Eigen::VectorXd& residual);

}  // namespace ecs::model
