// The fit of an assembly to readings: outliers, noise, nonlinear parameters, one factorisation. Internal (Eigen).
// Does not live here: how the result is reported (fit.cpp).
#pragma once

#include <memory>
#include <vector>

#include "model/fit/assembly.hpp"
#include "model/fit/noise.hpp"

namespace ecs::model {

struct CoreFit {
  Eigen::VectorXd sizes;                            ///< of all fitted columns, slot after slot; 0 for undetermined ones
  Eigen::MatrixXd covariance;                       ///< of sizes, then of the free nonlinear parameters
  std::vector<bool> undetermined;                   ///< per column
  std::vector<std::vector<Eigen::Index>> collides;  ///< per column: columns that do the same together
  Eigen::VectorXd residual;
  double chi2 = 0.0;  ///< whitened, without outliers
  double condition = 1.0;
  Eigen::Index rank = 0;
  NoiseModel noise;
  std::vector<bool> left_out;
};

struct CoreOptions {
  bool plain = false;
  bool all_curve_functions = false;  ///< curves use every function instead of as many as the evidence asks for
  bool from_values = false;          ///< as in FitOptions
};

/// Columns that a smooth machine could produce, for noise without repeats.
[[nodiscard]] Eigen::MatrixXd smooth_columns(const Observations& data);

/// Fits; `assembly` ends with the nonlinear values found.
[[nodiscard]] CoreFit fitted(Assembly& assembly, const Regressors& regressors, const CoreOptions& options);

}  // namespace ecs::model
