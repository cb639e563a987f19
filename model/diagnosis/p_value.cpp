// F test of added columns (Fisher 1922; Draper and Smith 1998, 6.1) on whitened readings (Aitken 1935), the best of
// many tests by Bonferroni's inequality with equal weights for candidates and, within each, for its tests.
#include "model/diagnosis/p_value.hpp"

#include <algorithm>
#include <cmath>

#include "model/fit/search.hpp"
#include "model/fit/statistics.hpp"

namespace ecs::model {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Shapes of noise that are less likely than the likeliest by more than this are left out: rarer than a name may be
/// false among a million machines.
constexpr double kLeastLikely = 1e-9;
/// ln of the least chance that is told: a double ends beyond.
constexpr double kLeastLn = -690.0;

NoiseModel of_shape(NoiseModel noise, const NoiseShape& shape) {
  for (std::size_t g = 0; g < noise.groups.size(); ++g) {
    NoiseGroup& group = noise.groups[g];
    group.white = std::sqrt((1.0 - shape.share) * shape.variance[g]);
    group.correlated = std::sqrt(shape.share * shape.variance[g]);
    group.time = shape.time;
  }
  return noise;
}

double ln_p(const Whitener& whitener, double kept, const MatrixXd& columns, const VectorXd& target,
            const MatrixXd& effect) {
  Space space;
  space.y = whitener(target);
  space.q.resize(space.y.size(), 0);
  absorb(space, whitener(columns));
  const double before = space.chi2();
  const auto taken = static_cast<double>(space.q.cols());
  absorb(space, whitener(effect));
  const double freedom = static_cast<double>(space.q.cols()) - taken, spare = kept - taken - freedom;
  if (freedom < 1.0 || spare < 1.0) return 0.0;
  const double left = std::max(space.chi2(), kLeastDivisor);
  return ln_f_tail((before - left) / freedom / (left / spare), freedom, spare);
}

}  // namespace

double p_value_of(const Evidence& on, const MatrixXd& columns, const VectorXd& target, const MatrixXd& effect,
                  double tests) {
  const auto kept = static_cast<double>(std::count(on.left_out.begin(), on.left_out.end(), false));
  double likeliest = 0.0, largest = kLeastLn;
  for (const NoiseShape& shape : on.noise.shapes) likeliest = std::max(likeliest, shape.weight);
  for (const NoiseShape& shape : on.noise.shapes) {
    if (shape.weight < kLeastLikely * likeliest) continue;
    const Whitener whitener(on.regressors.data(), of_shape(on.noise, shape), on.left_out);
    largest = std::max(largest, ln_p(whitener, kept, columns, target, effect));
  }
  return std::exp(std::clamp(largest + std::log(std::max(tests, 1.0)), kLeastLn, 0.0));
}

}  // namespace ecs::model
