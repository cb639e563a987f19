#include "model/lengths/noise_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "model/lengths/length_solution.hpp"

namespace ecs::model {
namespace {

constexpr int kMostNoiseSteps = 20;
constexpr double kLittleGain = 0.02;  ///< of the log likelihood: a step that promises less is not taken
constexpr double kLeastShare = 1e-6;  ///< of the variance of the readings: as good as nothing
constexpr double kMostShrink = 0.1;   ///< of a variance in one step
constexpr double kMostGrowth = 10.0;

using Scores = Eigen::Matrix<double, static_cast<int>(kScatters), 1>;
using Information = Eigen::Matrix<double, static_cast<int>(kScatters), static_cast<int>(kScatters)>;

/// The restricted likelihood at one choice of variances, with slopes and average information.
struct LikelihoodAt {
  ScatterVariances variances{};
  double half_deviance = std::numeric_limits<double>::max();  ///< −log likelihood, but for a constant
  Scores trace = Scores::Zero(), squares = Scores::Zero();    ///< tr(P·V_j), yᵀ·P·V_j·P·y
  Information average = Information::Zero();                  ///< ½·yᵀ·P·V_j·P·V_k·P·y
  Eigen::VectorXd x;
  [[nodiscard]] double slope(int j) const { return 0.5 * (trace(j) - squares(j)); }
};

class RestrictedLikelihood {
 public:
  RestrictedLikelihood(const SharedNoise& shared, const Eigen::MatrixXd& columns, const Eigen::VectorXd& y,
                       const Eigen::VectorXd& precision)
      : shared_(shared), unknowns_(columns.cols()) {
    const Eigen::MatrixXd scaled = scaled_columns(columns, norm_);
    precision_ = precision.cwiseQuotient(norm_.cwiseAbs2());
    Eigen::MatrixXd both(columns.rows(), unknowns_ + 1);
    both << scaled, y;
    for (const auto& block : shared.blocks()) rows_.push_back(rows_of(both, block.readings));
  }

  [[nodiscard]] LikelihoodAt at(const ScatterVariances& variances) const {
    LikelihoodAt out;
    out.variances = variances;
    const Eigen::Index p = unknowns_;
    std::vector<Eigen::LLT<Eigen::MatrixXd>> factors;
    std::vector<Eigen::MatrixXd> white = rows_;
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(p + 1, p + 1);
    double half_log_determinant = 0.0;
    for (std::size_t b = 0; b < white.size(); ++b) {
      factors.emplace_back(SharedNoise::covariance_of(shared_.blocks()[b], variances));
      if (factors.back().info() != Eigen::Success) return out;
      factors.back().matrixL().solveInPlace(white[b]);
      half_log_determinant += factors.back().matrixLLT().diagonal().array().log().sum();
      normal.selfadjointView<Eigen::Lower>().rankUpdate(white[b].transpose());
    }
    Eigen::MatrixXd inner = normal.topLeftCorner(p, p);
    inner.diagonal() += precision_;
    const double ridge = 1e-12 * inner.diagonal().maxCoeff();  // for what is not determined
    inner.diagonal().array() += ridge;
    const Eigen::LLT<Eigen::MatrixXd> factor(inner);
    const Eigen::VectorXd right = normal.row(p).head(p).transpose();
    const Eigen::VectorXd scaled_x = factor.solve(right);
    out.x = scaled_x.cwiseQuotient(norm_);
    out.half_deviance = half_log_determinant + factor.matrixLLT().diagonal().array().log().sum() +
                        0.5 * (normal(p, p) - right.dot(scaled_x));
    derive(out, white, factors, factor, scaled_x);
    return out;
  }

 private:
  void derive(LikelihoodAt& out, std::vector<Eigen::MatrixXd>& white,
              const std::vector<Eigen::LLT<Eigen::MatrixXd>>& factors, const Eigen::LLT<Eigen::MatrixXd>& factor,
              const Eigen::VectorXd& scaled_x) const {
    constexpr auto kCount = static_cast<Eigen::Index>(kScatters);
    const Eigen::Index p = unknowns_;
    Eigen::MatrixXd seen = Eigen::MatrixXd::Zero(p, kCount);  // of V_j·P·y, what the unknowns take up
    for (std::size_t b = 0; b < white.size(); ++b) {
      const auto& block = shared_.blocks()[b];
      const auto m = white[b].rows();
      Eigen::VectorXd residual = white[b].col(p) - white[b].leftCols(p) * scaled_x;
      Eigen::MatrixXd basis = white[b].leftCols(p);
      factor.matrixU().solveInPlace<Eigen::OnTheRight>(basis);
      Eigen::MatrixXd inside = Eigen::MatrixXd::Identity(m, m);  // L⁻¹ projects: P = L⁻ᵀ·(1 − basis·basisᵀ)·L⁻¹
      inside.selfadjointView<Eigen::Lower>().rankUpdate(basis, -1.0);
      inside.triangularView<Eigen::StrictlyUpper>() = inside.transpose();
      factors[b].matrixU().solveInPlace(inside);
      factors[b].matrixU().solveInPlace(residual);
      Eigen::MatrixXd projection = inside.transpose();
      factors[b].matrixU().solveInPlace(projection);
      Eigen::MatrixXd forces(m, kCount);
      forces.col(0) = residual;
      out.trace(0) += projection.trace();
      for (Eigen::Index j = 1; j < kCount; ++j) {
        const auto& unit = block.covariance[static_cast<std::size_t>(j - 1)];
        out.trace(j) += projection.cwiseProduct(unit).sum();
        forces.col(j) = unit * residual;
      }
      out.squares += forces.transpose() * residual;
      factors[b].matrixL().solveInPlace(forces);
      out.average += 0.5 * forces.transpose() * forces;
      seen += basis.transpose() * forces;
    }
    out.average -= 0.5 * seen.transpose() * seen;
  }

  const SharedNoise& shared_;
  Eigen::Index unknowns_;
  Eigen::VectorXd norm_, precision_;
  std::vector<Eigen::MatrixXd> rows_;  ///< by block: scaled columns and y
};

/// Newton's step by the average information, of those variances that are not at their least with the slope pressing.
ScatterVariances stepped(const LikelihoodAt& here, double least, double* promised) {
  std::vector<int> active;
  for (int j = 0; j < static_cast<int>(kScatters); ++j)
    if (here.trace(j) > 0.0 && (here.variances[static_cast<std::size_t>(j)] > least || here.slope(j) < 0.0))
      active.push_back(j);
  const auto count = static_cast<Eigen::Index>(active.size());
  Eigen::MatrixXd information(count, count);
  Eigen::VectorXd slope(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    slope(i) = here.slope(active[static_cast<std::size_t>(i)]);
    for (Eigen::Index k = 0; k < count; ++k)
      information(i, k) = here.average(active[static_cast<std::size_t>(i)], active[static_cast<std::size_t>(k)]);
    constexpr double kMore = 1e-6;
    information(i, i) *= 1.0 + kMore;
  }
  const Eigen::VectorXd step = -information.ldlt().solve(slope);
  ScatterVariances out = here.variances;
  *promised = 0.0;
  for (Eigen::Index i = 0; i < count; ++i) {
    double& variance = out[static_cast<std::size_t>(active[static_cast<std::size_t>(i)])];
    const double from = variance;
    variance = std::max(least, std::clamp(from + step(i), kMostShrink * from, kMostGrowth * from));
    *promised += std::abs(slope(i) * (variance - from));
  }
  return out;
}

/// Each variance by the root of what the residuals show over what they should: the likelihood never falls.
ScatterVariances safely_stepped(const LikelihoodAt& here, double least) {
  ScatterVariances out = here.variances;
  for (std::size_t j = 0; j < kScatters; ++j)
    if (const auto i = static_cast<Eigen::Index>(j); here.trace(i) > 0.0)
      out[j] = std::max(least, out[j] * std::sqrt(here.squares(i) / here.trace(i)));
  return out;
}

}  // namespace

NoiseFit fitted_noise(const SharedNoise& shared, const Eigen::MatrixXd& columns, const Eigen::VectorXd& y,
                      const Eigen::VectorXd& precision, const ScatterVariances& start) {
  const RestrictedLikelihood likelihood(shared, columns, y, precision);
  LikelihoodAt here = likelihood.at(start);
  NoiseFit out;
  for (; out.steps < kMostNoiseSteps; ++out.steps) {
    const double least = kLeastShare * shared.mean_variance(here.variances);
    double promised = 0.0;
    const ScatterVariances wanted = stepped(here, least, &promised);
    if (promised < kLittleGain) break;
    LikelihoodAt next = likelihood.at(wanted);
    if (!(next.half_deviance < here.half_deviance)) next = likelihood.at(safely_stepped(here, least));
    if (!(next.half_deviance < here.half_deviance)) break;
    here = std::move(next);
  }
  out.variances = here.variances;
  out.x = here.x;
  return out;
}

}  // namespace ecs::model
