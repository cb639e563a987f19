// The unknowns of a test by lengths as fitted: what identify.cpp solves and identified.cpp puts into words and numbers.
// Does not live here: least squares (length_solution.hpp), noise (noise_fit.hpp).
#pragma once

#include <vector>

#include "model/lengths/identify.hpp"
#include "model/lengths/length_solution.hpp"
#include "model/lengths/noise_certainty.hpp"
#include "model/lengths/noise_fit.hpp"

namespace ecs::model {

struct FittedLengths {
  FittedLengths(LengthTest measured, MachineCurves made) : test(std::move(measured)), curves(std::move(made)) {}

  LengthTest test;  ///< without what was left out
  MachineCurves curves;
  NuisanceColumns nuisance;
  Linearised linear;
  LengthSolution solution;
  NoiseCertainty certainty;     ///< covariance of all unknowns
  Eigen::VectorXd residual_um;  ///< plain
  Eigen::VectorXd sigmas;       ///< of each residual, of the standard deviation that it has without its own reading
  ScatterVariances variances{};
  double single_um = 0.0;  ///< standard deviation of a single reading, all scatter together
  std::vector<LengthOutlier> outliers;
  int degrees_of_freedom = 0;
};

/// Fills in what the unknowns mean: curves, squareness, set-ups, the volume; what is not determined, and why.
void report_on(const FittedLengths& fitted, Identification& out);

}  // namespace ecs::model
