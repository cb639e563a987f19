// Decompositions of dense matrices, compiled here once for all: Eigen's templates take seconds and hundreds of MB in
// every source that calls them. Does not live here: least squares of a model (model/fit/core.hpp).
#pragma once

#include <Eigen/Dense>

namespace ecs {

/// Size of unit column j before a decomposition with pivoting: of columns that are equally large the first comes first,
/// whatever rounding says. The steps are far above rounding and far below what tells columns apart.
[[nodiscard]] constexpr double size_in_order(Eigen::Index j) { return 1.0 / (1.0 + 1e-6 * static_cast<double>(j)); }

/// QR of columns with pivoting (Businger and Golub 1965): the columns that are independent come first. There may be
/// none: rank 0, answers without entries.
class PivotedQr {
 public:
  /// @param threshold  pivots below this share of the largest count as 0; Eigen's default without it
  explicit PivotedQr(const Eigen::MatrixXd& columns);
  PivotedQr(const Eigen::MatrixXd& columns, double threshold);

  [[nodiscard]] Eigen::Index rank() const { return rank_; }
  /// Place in the matrix of the i-th column in the order of pivots.
  [[nodiscard]] Eigen::Index place(Eigen::Index i) const { return qr_.colsPermutation().indices()(i); }
  /// Coefficients of the independent columns, in the order of pivots (rank).
  [[nodiscard]] Eigen::VectorXd independent_sizes(const Eigen::VectorXd& y) const;
  /// What the i-th column, a dependent one, is made of: coefficients of the independent ones (rank).
  [[nodiscard]] Eigen::VectorXd share(Eigen::Index i) const;
  /// Least-squares solution, 0 for dependent columns.
  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& y) const;
  /// (RᵀR)⁻¹ of the independent columns, in the order of pivots (rank × rank).
  [[nodiscard]] Eigen::MatrixXd inverse_gram() const;
  /// Orthonormal basis of the columns (rows × rank).
  [[nodiscard]] Eigen::MatrixXd basis() const;
  /// Greatest singular value of the independent columns by the least; 1 where there is none.
  [[nodiscard]] double condition() const;

 private:
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr_;
  Eigen::Index rows_ = 0;
  Eigen::Index rank_ = 0;

  [[nodiscard]] Eigen::MatrixXd r() const;
};

/// Solves with a symmetric matrix that is positive definite or nearly so (LDLᵀ).
class SymmetricSolver {
 public:
  explicit SymmetricSolver(const Eigen::MatrixXd& matrix);
  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& right) const;

 private:
  Eigen::LDLT<Eigen::MatrixXd> ldlt_;
};

/// The same of several right sides, as columns.
[[nodiscard]] Eigen::MatrixXd solved_symmetric(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right);

/// A symmetric matrix that is positive definite as L·Lᵀ (Cholesky); its lower triangle is read.
class Cholesky {
 public:
  explicit Cholesky(const Eigen::MatrixXd& matrix);
  [[nodiscard]] bool is_positive() const { return llt_.info() == Eigen::Success; }
  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& right) const;
  [[nodiscard]] Eigen::MatrixXd inverse() const;
  /// L⁻¹·columns, L⁻ᵀ·columns
  [[nodiscard]] Eigen::MatrixXd by_l(Eigen::MatrixXd columns) const;
  [[nodiscard]] Eigen::MatrixXd by_l_transposed(Eigen::MatrixXd columns) const;
  /// Half of ln of the determinant.
  [[nodiscard]] double half_ln_determinant() const;

 private:
  Eigen::LLT<Eigen::MatrixXd> llt_;
};

/// Adds factor·XᵀX of columns X.
void add_gram(Eigen::MatrixXd& to, const Eigen::MatrixXd& columns, double factor = 1.0);
/// (XᵀX)⁻¹ of independent columns X.
[[nodiscard]] Eigen::MatrixXd inverse_gram(const Eigen::MatrixXd& columns);

/// Ordinary least squares; 0 for dependent columns.
struct LeastSquares {
  Eigen::VectorXd sizes;
  double squares_left = 0.0;
};
[[nodiscard]] LeastSquares least_squares(const Eigen::MatrixXd& columns, const Eigen::VectorXd& y);

/// X⁺, by a complete orthogonal decomposition.
[[nodiscard]] Eigen::MatrixXd pseudo_inverse(const Eigen::MatrixXd& columns);
/// a·b
[[nodiscard]] Eigen::MatrixXd product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

/// matrix = u·diag(values)·vᵀ, the greatest value first; u and v are square.
struct SingularValues {
  Eigen::MatrixXd u;
  Eigen::VectorXd values;
  Eigen::MatrixXd v;
};
[[nodiscard]] SingularValues singular_values_of(const Eigen::MatrixXd& matrix);

/// What the rows of a matrix X span: X·back is orthonormal and reaches what X reaches, X·free is nothing, and the
/// columns of `free` are orthonormal. back·backᵀ = (XᵀX)⁺.
struct RowSpace {
  Eigen::MatrixXd back, free;
};
/// By a complete orthogonal decomposition of the triangle of a QR (Golub and Van Loan 2013, 5.4.7).
/// @param threshold  pivots below this share of the largest count as 0
[[nodiscard]] RowSpace row_space_of(const Eigen::MatrixXd& columns, double threshold);

/// Eigenvalues of a symmetric matrix, least first, and its eigenvectors as columns.
struct Spectrum {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
[[nodiscard]] Spectrum spectrum_of(const Eigen::MatrixXd& symmetric);

/// Absolute diagonal of R in columns = Q·R, in the order given: what each column has beyond those before it.
/// @pre  at least as many rows as columns
[[nodiscard]] Eigen::VectorXd beyond_those_before(const Eigen::MatrixXd& columns);

/// The least-squares solution of least norm, by a complete orthogonal decomposition (Golub and Van Loan 2013, 5.5.2).
[[nodiscard]] Eigen::VectorXd least_norm_solution(const Eigen::MatrixXd& columns, const Eigen::VectorXd& y);
/// @param threshold  pivots below this share of the largest count as 0
[[nodiscard]] Eigen::VectorXd least_norm_solution(const Eigen::MatrixXd& columns, const Eigen::VectorXd& y,
                                                  double threshold);

/// Both, side by side.
[[nodiscard]] Eigen::MatrixXd beside(Eigen::MatrixXd columns, const Eigen::MatrixXd& more);

/// Columns less what an orthonormal basis spans: columns − q·qᵀ·columns.
[[nodiscard]] Eigen::MatrixXd without(const Eigen::MatrixXd& q, Eigen::MatrixXd columns);
[[nodiscard]] Eigen::VectorXd without(const Eigen::MatrixXd& q, Eigen::VectorXd column);

}  // namespace ecs
