#include "modules/lengths/length_solution.hpp"

#include <algorithm>
#include <utility>

#include "model/linear/decompositions.hpp"

namespace ecs::model {
namespace {

constexpr double kNoPivot = 1e-9;      ///< of the greatest pivot of scaled columns: not determined
constexpr double kInNullSpace = 1e-5;  ///< share of a value that the lengths leave free

}  // namespace

Eigen::MatrixXd scaled_columns(const Eigen::MatrixXd& columns, Eigen::VectorXd& norm) {
  constexpr double kRounding = 1e-11;
  norm = columns.colwise().norm().transpose();
  const double longest = norm.maxCoeff();
  Eigen::MatrixXd scaled = columns;
  for (Eigen::Index j = 0; j < columns.cols(); ++j) {
    if (norm(j) <= kRounding * longest) {
      norm(j) = 1.0;
      scaled.col(j).setZero();
    } else {
      scaled.col(j) /= norm(j);
    }
  }
  return scaled;
}

Eigen::VectorXd near_solution_of(const Eigen::MatrixXd& columns, const Eigen::VectorXd& y) {
  constexpr double kRidge = 1e-12;
  Eigen::VectorXd norm;
  const Eigen::MatrixXd scaled = scaled_columns(columns, norm);
  Eigen::MatrixXd normal = kRidge * Eigen::MatrixXd::Identity(scaled.cols(), scaled.cols());
  add_gram(normal, scaled);
  return SymmetricSolver(normal).solve(scaled.transpose() * y).cwiseQuotient(norm);
}

LengthSolution solution_of(const Eigen::MatrixXd& columns, const Eigen::VectorXd& y) {
  LengthSolution out;
  const Eigen::MatrixXd scaled = scaled_columns(columns, out.norm);
  RowSpace space = row_space_of(scaled, kNoPivot);
  out.rank = static_cast<int>(space.back.cols());
  out.back = out.norm.cwiseInverse().asDiagonal() * space.back;
  out.basis = scaled * space.back;
  out.x = out.back * (out.basis.transpose() * y);
  const Eigen::VectorXd left = y - columns * out.x;
  out.x += out.back * (out.basis.transpose() * left);  // once more, for what rounding lost
  out.covariance = out.back * out.back.transpose();
  out.free = std::move(space.free);
  out.squares = (y - columns * out.x).squaredNorm();
  return out;
}

bool is_free(const LengthSolution& solution, const Eigen::VectorXd& row, Eigen::Index first) {
  if (solution.free.cols() == 0) return false;
  const Eigen::VectorXd scaled = row.cwiseQuotient(solution.norm.segment(first, row.size()));
  const Eigen::VectorXd share = solution.free.middleRows(first, row.size()).transpose() * scaled;
  return share.norm() > kInNullSpace * std::max(scaled.norm(), 1e-30);
}

}  // namespace ecs::model
