#include "model/lengths/length_solution.hpp"

#include <algorithm>

namespace ecs::model {
namespace {

constexpr double kNoSingular = 1e-9;   ///< of the greatest singular value of scaled columns: not determined
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
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(scaled.cols(), scaled.cols());
  normal.selfadjointView<Eigen::Lower>().rankUpdate(scaled.transpose());
  normal.diagonal().array() += kRidge;
  return normal.selfadjointView<Eigen::Lower>().ldlt().solve(scaled.transpose() * y).cwiseQuotient(norm);
}

LengthSolution solution_of(const Eigen::MatrixXd& columns, const Eigen::VectorXd& y) {
  LengthSolution out;
  const Eigen::Index p = columns.cols();
  const Eigen::MatrixXd scaled = scaled_columns(columns, out.norm);
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(scaled);
  const Eigen::MatrixXd r = qr.matrixQR().topRows(std::min(p, scaled.rows())).template triangularView<Eigen::Upper>();
  const Eigen::BDCSVD<Eigen::MatrixXd> svd(r, Eigen::ComputeThinU | Eigen::ComputeFullV);
  const auto& s = svd.singularValues();
  while (out.rank < s.size() && s(out.rank) > kNoSingular * s(0)) ++out.rank;
  const Eigen::VectorXd inverse = s.head(out.rank).cwiseInverse();
  const Eigen::MatrixXd back_scaled = svd.matrixV().leftCols(out.rank) * inverse.asDiagonal();
  out.back = out.norm.cwiseInverse().asDiagonal() * back_scaled;
  out.basis = scaled * back_scaled;
  out.x = out.back * (out.basis.transpose() * y);
  const Eigen::VectorXd left = y - columns * out.x;
  out.x += out.back * (out.basis.transpose() * left);  // once more, for what rounding lost
  out.covariance = out.back * out.back.transpose();
  out.free = svd.matrixV().rightCols(p - out.rank);
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
