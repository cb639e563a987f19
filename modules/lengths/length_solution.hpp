// Linear least squares of whitened observations: the solution, its covariance, and what the observations leave free.
// Does not live here: the noise by which they are whitened (shared_noise.hpp), what the unknowns mean (identify.hpp).
#pragma once

#include <Eigen/Dense>

namespace ecs::model {

struct LengthSolution {
  Eigen::VectorXd x;
  Eigen::MatrixXd covariance;  ///< where the whitened observations have unit variance
  Eigen::MatrixXd free;        ///< orthonormal basis of what is not determined, columns scaled by `norm`
  Eigen::VectorXd norm;        ///< of the columns
  Eigen::MatrixXd basis;       ///< orthonormal, of what the columns reach
  Eigen::MatrixXd back;        ///< from coordinates in it to unknowns; covariance = back · backᵀ
  double squares = 0.0;        ///< of the whitened residuals
  int rank = 0;
};

/// By orthogonal decomposition: of what is not determined, the solution of least norm.
[[nodiscard]] LengthSolution solution_of(const Eigen::MatrixXd& columns, const Eigen::VectorXd& y);

/// Values alone, by the normal equations: good enough to make linear about.
[[nodiscard]] Eigen::VectorXd near_solution_of(const Eigen::MatrixXd& columns, const Eigen::VectorXd& y);

/// Columns divided by their lengths; those of nothing but rounding become nothing, their `norm` 1.
[[nodiscard]] Eigen::MatrixXd scaled_columns(const Eigen::MatrixXd& columns, Eigen::VectorXd& norm);

/// Whether the observations leave a linear value of unknowns free. @param first  of the unknowns that `row` weighs
[[nodiscard]] bool is_free(const LengthSolution& solution, const Eigen::VectorXd& row, Eigen::Index first);

}  // namespace ecs::model
