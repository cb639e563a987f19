// Fall of χ² by each further column: sequential sums of squares from the Cholesky factor of the products (Golub and Van
// Loan 2013, 4.2); the price per column is Schwarz's (1978), by the caller.
#include "model/fit/gains.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "model/effects/definition.hpp"
#include "model/fit/statistics.hpp"

namespace ecs::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Functions of a curve beyond its leading ones, at least: fewer are a line and a bow, which have effects of their own.
constexpr std::size_t kFewestCurveFunctions = 4;

/// Gain of the first 1, 2, … columns in this order, from products; columns that add nothing gain nothing.
struct Gains {
  std::vector<double> gain;        ///< cumulative
  std::vector<std::size_t> free;   ///< independent columns so far
  double first_coefficient = 0.0;  ///< of a single column
  double first_square = 0.0;
};

Gains gains_in_order(const MatrixXd& gram, const VectorXd& z, const std::vector<Index>& order,
                     const Eigen::VectorXd& original_square, double absorbed) {
  // Cholesky column by column
  const std::size_t k = order.size();
  MatrixXd l = MatrixXd::Zero(static_cast<Index>(k), static_cast<Index>(k));
  VectorXd u = VectorXd::Zero(static_cast<Index>(k));
  Gains gains;
  double sum = 0.0;
  std::size_t free = 0;
  for (std::size_t i = 0; i < k; ++i) {
    const auto ii = static_cast<Index>(i);
    double square = static_cast<double>(gram(order[i], order[i]));
    double right = static_cast<double>(z(order[i]));
    for (Index j = 0; j < ii; ++j) {
      double v = static_cast<double>(gram(order[i], order[static_cast<std::size_t>(j)]));
      for (Index m = 0; m < j; ++m) v -= l(ii, m) * l(j, m);
      l(ii, j) = l(j, j) > 0.0 ? v / l(j, j) : 0.0;
      square -= l(ii, j) * l(ii, j);
      right -= l(ii, j) * u(j);
    }
    if (square > absorbed * original_square(order[i]) && square > 0.0) {
      l(ii, ii) = std::sqrt(square);
      u(ii) = right / l(ii, ii);
      sum += u(ii) * u(ii);
      ++free;
    }
    if (i == 0 && square > absorbed * original_square(order[i]) && square > 0.0) {
      gains.first_coefficient = right / square;
      gains.first_square = square;
    }
    gains.gain.push_back(sum);
    gains.free.push_back(free);
  }
  return gains;
}

/// Best set of columns by score, with the coefficient of a single one kept inside its physical range.
Choice best_variant(const Family& family, const std::vector<std::vector<Index>>& variants, const MatrixXd& gram,
                    const VectorXd& z, const VectorXd& original, double absorbed, const CostOf& cost) {
  Choice best;
  best.gain = -1.0;
  double best_score = -kBeyondAll;
  for (const std::vector<Index>& variant : variants) {
    if (variant.empty() || variant.back() >= static_cast<Index>(z.size())) continue;
    const Gains gains = gains_in_order(gram, z, variant, original, absorbed);
    double gain = gains.gain.back();
    const std::size_t free = gains.free.back();
    if (free == 0) continue;
    if (variant.size() == 1 && (family.least || family.greatest)) {
      double c = gains.first_coefficient;
      if (family.least) c = std::max(c, *family.least);
      if (family.greatest) c = std::min(c, *family.greatest);
      gain = c * gains.first_square * (2.0 * gains.first_coefficient - c);
    }
    // a wave has its amplitude and phase even where the targets show little of one
    const std::size_t priced = family.effect.traits().periodic ? variant.size() : free;
    const double score = gain - cost(priced);
    if (score > best_score) {
      best_score = score;
      best.columns = variant;
      best.gain = gain;
      best.cost = cost(priced);
      best.parameters = priced;
    }
  }
  return best;
}

/// Curves: all leading sets from one pass.
Choice best_curve(const std::vector<std::vector<Index>>& variants, const MatrixXd& gram, const VectorXd& z,
                  const VectorXd& original, double absorbed, const CostOf& cost) {
  Choice best;
  best.gain = -1.0;
  if (variants.empty()) return best;
  const Gains gains = gains_in_order(gram, z, variants.back(), original, absorbed);
  double best_score = -kBeyondAll;
  for (const std::vector<Index>& variant : variants) {
    const std::size_t last = variant.size() - 1;
    if (gains.free[last] == 0) continue;
    const double score = gains.gain[last] - cost(gains.free[last]);
    if (score <= best_score) continue;
    best_score = score;
    best.columns = variant;
    best.gain = gains.gain[last];
    best.cost = cost(gains.free[last]);
    best.parameters = gains.free[last];
  }
  return best;
}

}  // namespace

Choice best_choice(const Family& family, const std::vector<std::vector<Index>>& variants, const MatrixXd& gram,
                   const VectorXd& z, const VectorXd& original, double absorbed, const CostOf& cost) {
  if (family.effect.traits().periodic) absorbed = std::max(absorbed, kAbsorbedPeriod);
  if (family.effect.traits().is_curve) return best_curve(variants, gram, z, original, absorbed, cost);
  return best_variant(family, variants, gram, z, original, absorbed, cost);
}

std::vector<std::vector<Index>> variants_of(const EffectInstance& effect, const Columns& columns, bool natural) {
  const Index count = columns.of.cols();
  std::vector<Index> all(static_cast<std::size_t>(count));
  std::iota(all.begin(), all.end(), Index{0});
  const EffectDefinition& definition = effect.definition();
  if (!natural && !definition.column_sets_elsewhere.empty()) return definition.column_sets_elsewhere;
  if (!definition.column_sets.empty()) return definition.column_sets;
  if (!definition.traits.is_curve) return {all};
  std::vector<std::vector<Index>> orders;
  const auto leading = static_cast<Index>(columns.leading);
  for (Index j = 1; j <= leading; ++j) orders.emplace_back(all.begin(), all.begin() + j);
  const Index fewest = std::min<Index>(static_cast<Index>(kFewestCurveFunctions), count - leading);
  for (Index j = leading + std::max<Index>(fewest, 1); j <= count; ++j)
    orders.emplace_back(all.begin(), all.begin() + j);
  return orders;
}

}  // namespace ecs::model
