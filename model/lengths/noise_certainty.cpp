#include "model/lengths/noise_certainty.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace ecs::model {
namespace {

/// Eigenvalues of the information, scaled to a diagonal of 1, below which two variances cannot be told apart: then
/// neither does their share change what is wanted.
constexpr double kNotTold = 1e-8;

/// Inverse of what the readings tell of the variances; nothing for what they do not tell.
Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& information) {
  const auto n = information.rows();
  Eigen::VectorXd scale = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = 0; i < n; ++i)
    if (information(i, i) > 0.0) scale(i) = 1.0 / std::sqrt(information(i, i));
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scale.asDiagonal() * information * scale.asDiagonal());
  Eigen::VectorXd inverse = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = 0; i < n; ++i)
    if (eigen.eigenvalues()(i) > kNotTold) inverse(i) = 1.0 / eigen.eigenvalues()(i);
  const Eigen::MatrixXd directions = scale.asDiagonal() * eigen.eigenvectors();
  return directions * inverse.asDiagonal() * directions.transpose();
}

/// trace(a · b)
double trace_of_product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.cwiseProduct(b.transpose()).sum();
}

/// Share of Student's t within ±k.
double share_within(double k, double freedom) {
  constexpr int kSteps = 64;  // Simpson's rule in the angle of which k/√freedom is the tangent
  const double end = std::atan(k / std::sqrt(freedom)), h = end / kSteps;
  double sum = 0.0;
  for (int i = 0; i <= kSteps; ++i)
    sum += (i == 0 || i == kSteps ? 1.0 : i % 2 == 1 ? 4.0 : 2.0) * std::pow(std::cos(i * h), freedom - 1.0);
  constexpr double kSquareRootOfPi = 1.7724538509055160;
  return sum * h / 3.0 * 2.0 / kSquareRootOfPi *
         std::exp(std::lgamma(0.5 * freedom + 0.5) - std::lgamma(0.5 * freedom));
}

}  // namespace

// In coordinates in which the covariance of the unknowns is 1, B the orthonormal basis of the whitened columns, A_j the
// whitened share of variance j: T_j = Bᵀ·A_j·B, Q_jk = Bᵀ·A_j·A_k·B; with W the covariance of the estimated variances
// the covariance becomes 1 + 2·Σ W_jk·(Q_jk − T_j·T_k) (Kenward and Roger; V is linear in the variances).
NoiseCertainty::NoiseCertainty(const SharedNoise& shared, const Eigen::MatrixXd& basis, const Eigen::MatrixXd& back,
                               const ScatterVariances& variances, const std::array<bool, kScatters>& estimated) {
  std::vector<std::size_t> which;
  for (std::size_t j = 0; j < kScatters; ++j)
    if (estimated[j]) which.push_back(j);
  const std::size_t count = which.size();
  const Eigen::Index p = basis.cols();
  std::vector<Eigen::MatrixXd> inside(count, Eigen::MatrixXd::Zero(p, p));            // T_j
  std::vector<Eigen::MatrixXd> products(count * count, Eigen::MatrixXd::Zero(p, p));  // Q_jk, k ≤ j
  Eigen::MatrixXd information =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(count), static_cast<Eigen::Index>(count));
  for (const auto& block : shared.blocks()) {
    const auto m = static_cast<Eigen::Index>(block.readings.size());
    const Eigen::LLT<Eigen::MatrixXd> factor(SharedNoise::covariance_of(block, variances));
    const Eigen::MatrixXd inverse = factor.solve(Eigen::MatrixXd::Identity(m, m));
    const Eigen::MatrixXd pushed = factor.matrixU().solve(rows_of(basis, block.readings));
    std::vector<Eigen::MatrixXd> shares, seen;  // V⁻¹·V_j, L⁻¹·V_j·L⁻ᵀ·B
    for (std::size_t j = 0; j < count; ++j) {
      Eigen::MatrixXd own = pushed;
      if (which[j] == 0) {
        shares.push_back(inverse);
      } else {
        const Eigen::MatrixXd& unit = block.covariance[which[j] - 1];
        shares.push_back(inverse * unit);
        own = unit * pushed;
      }
      inside[j] += pushed.transpose() * own;
      factor.matrixL().solveInPlace(own);
      seen.push_back(std::move(own));
      for (std::size_t k = 0; k <= j; ++k) {
        products[j * count + k] += seen[j].transpose() * seen[k];
        information(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(k)) +=
            0.5 * trace_of_product(shares[j], shares[k]);
      }
    }
  }
  for (std::size_t j = 0; j < count; ++j)
    for (std::size_t k = 0; k <= j; ++k) {
      const auto row = static_cast<Eigen::Index>(j), column = static_cast<Eigen::Index>(k);
      information(row, column) += 0.5 * trace_of_product(inside[j], inside[k]) - products[j * count + k].trace();
      information(column, row) = information(row, column);
    }
  spread_ = inverse_of(information);
  Eigen::MatrixXd added = Eigen::MatrixXd::Zero(p, p);
  for (std::size_t j = 0; j < count; ++j)
    for (std::size_t k = 0; k <= j; ++k) {
      const double w = spread_(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(k));
      const Eigen::MatrixXd one = products[j * count + k] - inside[j] * inside[k];
      added += 2.0 * w * one;
      if (k < j) added += 2.0 * w * one.transpose();
    }
  plain_ = back * back.transpose();
  covariance_ = plain_ + back * added * back.transpose();
  for (const Eigen::MatrixXd& one : inside) change_.push_back(back * one * back.transpose());
}

double NoiseCertainty::freedom_of(double variance, const Eigen::VectorXd& slopes) const {
  const double of_variance = slopes.dot(spread_ * slopes);
  return of_variance > 0.0 ? 2.0 * variance * variance / of_variance : std::numeric_limits<double>::infinity();
}

double NoiseCertainty::degrees_of_freedom(const Eigen::MatrixXd& weights, Eigen::Index first) const {
  if (change_.empty()) return std::numeric_limits<double>::infinity();
  const auto n = weights.rows();
  Eigen::VectorXd slopes(static_cast<Eigen::Index>(change_.size()));
  for (std::size_t j = 0; j < change_.size(); ++j)
    slopes(static_cast<Eigen::Index>(j)) = weights.cwiseProduct(change_[j].block(first, first, n, n)).sum();
  return freedom_of(weights.cwiseProduct(plain_.block(first, first, n, n)).sum(), slopes);
}

double NoiseCertainty::degrees_of_freedom(const Eigen::VectorXd& row, Eigen::Index first) const {
  return degrees_of_freedom(Eigen::MatrixXd(row * row.transpose()), first);
}

double coverage_factor(double degrees_of_freedom) {
  constexpr double kNormal = 2.0, kShare = 0.954499736103642, kMany = 1e6, kLeast = 1.0, kGreatest = 20.0;
  if (!(degrees_of_freedom < kMany)) return kNormal;
  const double freedom = std::max(kLeast, degrees_of_freedom);
  double low = kNormal, high = kGreatest;
  while (high - low > 1e-5) {
    const double middle = 0.5 * (low + high);
    (share_within(middle, freedom) < kShare ? low : high) = middle;
  }
  return high;
}

}  // namespace ecs::model
