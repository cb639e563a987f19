#include "model/circle/decays.hpp"

#include <algorithm>
#include <cmath>

#include "model/fit/statistics.hpp"

namespace ecs::model {
namespace {

using Eigen::Index, Eigen::MatrixXd, Eigen::VectorXd;

constexpr int kMostDecaySteps = 30;
constexpr int kMostDecayHalvings = 10;
/// The longest step of the logarithm of a decay, and the one below which it has arrived.
constexpr double kLongestDecayStep = 0.5;
constexpr double kShortestDecayStep = 1e-5;

/// Everything but decays is solved for at every place: sizes of the spikes, and of their derivatives where asked.
struct DecayFit {
  double squares = 0.0;
  VectorXd sizes, slopes;  ///< of each spike; slopes: empty without derivatives
};

DecayFit fit_at(const VectorXd& deviation, const MatrixXd& others, const SpikeColumns& columns,
                const std::vector<double>& decays_mm, bool derivatives) {
  const auto spikes = static_cast<Index>(decays_mm.size());
  MatrixXd all(deviation.size(), (derivatives ? 2 : 1) * spikes + others.cols());
  for (Index i = 0; i < spikes; ++i) {
    const MatrixXd own = columns(static_cast<std::size_t>(i), decays_mm[static_cast<std::size_t>(i)]);
    all.col(i) = own.col(0);
    if (derivatives) all.col(spikes + i) = own.col(1);
  }
  all.rightCols(others.cols()) = others;
  const VectorXd solved = all.colPivHouseholderQr().solve(deviation);
  return {(deviation - all * solved).squaredNorm(), solved.head(spikes),
          derivatives ? VectorXd(solved.segment(spikes, spikes)) : VectorXd()};
}

}  // namespace

std::vector<double> best_decays(const VectorXd& deviation, const MatrixXd& others, const SpikeColumns& columns,
                                std::vector<double> start_mm, const DecayLimits& limits) {
  std::vector<double> decays_mm = std::move(start_mm);
  double least = fit_at(deviation, others, columns, decays_mm, false).squares;
  for (int round = 0; round < kMostDecaySteps; ++round) {
    const DecayFit linear = fit_at(deviation, others, columns, decays_mm, true);
    double longest = 0.0;
    bool better = false;
    for (double share = 1.0; !better && share > std::pow(0.5, kMostDecayHalvings); share /= 2.0) {
      std::vector<double> tried = decays_mm;
      longest = 0.0;
      for (std::size_t i = 0; i < tried.size(); ++i) {
        const double size = linear.sizes[static_cast<Index>(i)], slope = linear.slopes[static_cast<Index>(i)];
        if (std::abs(size) < kLeastDivisor) continue;
        const double step = share * std::clamp(slope / size, -kLongestDecayStep, kLongestDecayStep);
        tried[i] = std::clamp(decays_mm[i] * std::exp(step), limits.least_mm, limits.greatest_mm);
        longest = std::max(longest, std::abs(std::log(tried[i] / decays_mm[i])));
      }
      const double squares = fit_at(deviation, others, columns, tried, false).squares;
      better = squares < least;
      if (!better) continue;
      least = squares;
      decays_mm = tried;
    }
    if (!better || longest < kShortestDecayStep) break;
  }
  return decays_mm;
}

}  // namespace ecs::model
