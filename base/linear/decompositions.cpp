#include "base/linear/decompositions.hpp"

#include <algorithm>
#include <limits>

namespace ecs {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Eigen decomposes no matrix without columns: it looks for the greatest norm among none.
PivotedQr::PivotedQr(const MatrixXd& columns) : rows_(columns.rows()) {
  if (columns.cols() == 0) return;
  qr_.compute(columns);
  rank_ = qr_.rank();
}

PivotedQr::PivotedQr(const MatrixXd& columns, double threshold) : rows_(columns.rows()) {
  if (columns.cols() == 0) return;
  qr_.setThreshold(threshold);
  qr_.compute(columns);
  rank_ = qr_.rank();
}

MatrixXd PivotedQr::r() const { return qr_.matrixR().topLeftCorner(rank_, rank_).triangularView<Eigen::Upper>(); }

VectorXd PivotedQr::independent_sizes(const VectorXd& y) const {
  if (rank_ == 0) return VectorXd(0);
  const VectorXd turned = (qr_.householderQ().transpose() * y).head(rank_);
  return qr_.matrixR().topLeftCorner(rank_, rank_).triangularView<Eigen::Upper>().solve(turned);
}

VectorXd PivotedQr::share(Index i) const {
  const VectorXd column = qr_.matrixR().col(i).head(rank_);
  return qr_.matrixR().topLeftCorner(rank_, rank_).triangularView<Eigen::Upper>().solve(column);
}

VectorXd PivotedQr::solve(const VectorXd& y) const {
  VectorXd sizes = VectorXd::Zero(qr_.cols());  // Eigen's own divides by pivots that are nothing but rounding
  const VectorXd independent = independent_sizes(y);
  for (Index i = 0; i < rank_; ++i) sizes(place(i)) = independent(i);
  return sizes;
}

MatrixXd PivotedQr::inverse_gram() const {
  if (rank_ == 0) return MatrixXd(0, 0);
  const MatrixXd inverse = r().triangularView<Eigen::Upper>().solve(MatrixXd::Identity(rank_, rank_));
  return inverse * inverse.transpose();
}

MatrixXd PivotedQr::basis() const {
  if (rank_ == 0) return MatrixXd(rows_, 0);
  return qr_.householderQ() * MatrixXd::Identity(rows_, rank_);
}

double PivotedQr::condition() const {
  if (rank_ == 0) return 1.0;
  const VectorXd values = Eigen::JacobiSVD<MatrixXd, Eigen::NoQRPreconditioner>(r()).singularValues();
  return values(0) / std::max(values(rank_ - 1), std::numeric_limits<double>::min());
}

SymmetricSolver::SymmetricSolver(const MatrixXd& matrix) : ldlt_(matrix) {}
VectorXd SymmetricSolver::solve(const VectorXd& right) const { return ldlt_.solve(right); }

MatrixXd solved_symmetric(const MatrixXd& matrix, const MatrixXd& right) {
  return Eigen::LDLT<MatrixXd>(matrix).solve(right);
}

Cholesky::Cholesky(const MatrixXd& matrix) : llt_(matrix) {}
VectorXd Cholesky::solve(const VectorXd& right) const { return llt_.solve(right); }
MatrixXd Cholesky::inverse() const { return llt_.solve(MatrixXd::Identity(llt_.rows(), llt_.cols())); }
double Cholesky::half_ln_determinant() const { return llt_.matrixLLT().diagonal().array().log().sum(); }

MatrixXd Cholesky::by_l(MatrixXd columns) const {
  llt_.matrixL().solveInPlace(columns);
  return columns;
}

MatrixXd Cholesky::by_l_transposed(MatrixXd columns) const {
  llt_.matrixU().solveInPlace(columns);
  return columns;
}

void add_gram(MatrixXd& to, const MatrixXd& columns, double factor) {
  to.selfadjointView<Eigen::Lower>().rankUpdate(columns.transpose(), factor);
  to.triangularView<Eigen::StrictlyUpper>() = to.transpose();
}

MatrixXd inverse_gram(const MatrixXd& columns) {
  MatrixXd gram = MatrixXd::Zero(columns.cols(), columns.cols());
  add_gram(gram, columns);
  return Cholesky(gram).inverse();
}

LeastSquares least_squares(const MatrixXd& columns, const VectorXd& y) {
  LeastSquares fit{PivotedQr(columns).solve(y), 0.0};
  fit.squares_left = (y - columns * fit.sizes).squaredNorm();
  return fit;
}

MatrixXd pseudo_inverse(const MatrixXd& columns) {
  return Eigen::CompleteOrthogonalDecomposition<MatrixXd>(columns).pseudoInverse();
}

MatrixXd product(const MatrixXd& a, const MatrixXd& b) { return a * b; }

SingularValues singular_values_of(const MatrixXd& matrix) {
  const Eigen::JacobiSVD<MatrixXd, Eigen::FullPivHouseholderQRPreconditioner> svd(
      matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return {svd.matrixU(), svd.singularValues(), svd.matrixV()};
}

RowSpace row_space_of(const MatrixXd& columns, double threshold) {
  const Eigen::HouseholderQR<MatrixXd> qr(columns);
  const MatrixXd r = qr.matrixQR().topRows(std::min(columns.rows(), columns.cols())).triangularView<Eigen::Upper>();
  Eigen::CompleteOrthogonalDecomposition<MatrixXd> decomposition;
  decomposition.setThreshold(threshold);
  decomposition.compute(r);
  const Index rank = decomposition.rank();
  MatrixXd turned = decomposition.colsPermutation();
  if (rank < columns.cols()) turned *= decomposition.matrixZ().transpose();  // without a meaning at full rank
  MatrixXd back = turned.leftCols(rank).transpose();
  decomposition.matrixT().topLeftCorner(rank, rank).triangularView<Eigen::Upper>().transpose().solveInPlace(back);
  return {back.transpose(), turned.rightCols(columns.cols() - rank)};
}

Spectrum spectrum_of(const MatrixXd& symmetric) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

VectorXd beyond_those_before(const MatrixXd& columns) {
  // products have all digits of what keeps this share of its square but six (Golub and Van Loan 2013, 5.3)
  constexpr double kKept = 1e-6;
  MatrixXd products = MatrixXd::Zero(columns.cols(), columns.cols());
  add_gram(products, columns);
  const Eigen::LLT<MatrixXd> cholesky(products);
  const VectorXd own = cholesky.matrixLLT().diagonal();
  if (cholesky.info() == Eigen::Success && (own.array().square() > kKept * products.diagonal().array()).all())
    return own;
  return Eigen::HouseholderQR<MatrixXd>(columns).matrixQR().diagonal().cwiseAbs();
}

VectorXd least_norm_solution(const MatrixXd& columns, const VectorXd& y) {
  if (columns.cols() == 0) return VectorXd(0);
  return Eigen::CompleteOrthogonalDecomposition<MatrixXd>(columns).solve(y);
}

VectorXd least_norm_solution(const MatrixXd& columns, const VectorXd& y, double threshold) {
  if (columns.cols() == 0) return VectorXd(0);
  Eigen::CompleteOrthogonalDecomposition<MatrixXd> decomposition;
  decomposition.setThreshold(threshold);
  decomposition.compute(columns);
  return decomposition.solve(y);
}

MatrixXd beside(MatrixXd columns, const MatrixXd& more) {
  columns.conservativeResize(Eigen::NoChange, columns.cols() + more.cols());
  columns.rightCols(more.cols()) = more;
  return columns;
}

MatrixXd without(const MatrixXd& q, MatrixXd columns) {
  if (q.cols() > 0) columns.noalias() -= q * (q.transpose() * columns).eval();
  return columns;
}

VectorXd without(const MatrixXd& q, VectorXd column) {
  if (q.cols() > 0) column.noalias() -= q * (q.transpose() * column).eval();
  return column;
}

}  // namespace ecs
