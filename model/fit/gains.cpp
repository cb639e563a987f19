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
using Eigen::Ref;
using Eigen::VectorXd;

/// Functions of a curve beyond its leading ones, at least: fewer are a line and a bow, which have effects of their own.
constexpr std::size_t kFewestCurveFunctions = 4;

/// Sets of at most so many columns are worked on without an allocation: a wave with its harmonic has four.
constexpr int kFewColumns = 6;

/// One step of the factor: what the columns up to here gain together.
struct Step {
  double gain = 0.0;
  std::size_t free = 0;  ///< independent columns so far
  double square = 0.0;   ///< of this column, what the ones before have taken off
  double right = 0.0;    ///< its product with what is left
  bool adds = false;     ///< anything is left of this column
};

/// Cholesky column by column in this order, from products; columns that add nothing gain nothing.
template <int kMost, class Each>
void for_each_step(const Ref<const MatrixXd>& gram, const Ref<const VectorXd>& z, const std::vector<Index>& order,
                   const Ref<const VectorXd>& original, double absorbed, Each each) {
  const auto k = static_cast<Index>(order.size());
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMost, kMost> l(k, k);
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMost, 1> u(k);
  l.setZero();
  u.setZero();
  Step step;
  for (Index i = 0; i < k; ++i) {
    const Index column = order[static_cast<std::size_t>(i)];
    step.square = gram(column, column);
    step.right = z(column);
    for (Index j = 0; j < i; ++j) {
      double v = gram(column, order[static_cast<std::size_t>(j)]);
      for (Index m = 0; m < j; ++m) v -= l(i, m) * l(j, m);
      l(i, j) = l(j, j) > 0.0 ? v / l(j, j) : 0.0;
      step.square -= l(i, j) * l(i, j);
      step.right -= l(i, j) * u(j);
    }
    step.adds = step.square > absorbed * original(column) && step.square > 0.0;
    if (step.adds) {
      l(i, i) = std::sqrt(step.square);
      u(i) = step.right / l(i, i);
      step.gain += u(i) * u(i);
      ++step.free;
    }
    each(i, step);
  }
}

/// A single coefficient at its best inside the physical range; below 0 where noise does not put it so far outside.
double gain_inside(const ValueRange& range, const Step& only) {
  constexpr double kByNoise = 9.0;  // of a fall of χ²: three standard deviations
  const double free = only.right / only.square, c = std::clamp(free, range.least, range.greatest);
  if ((free - c) * (free - c) * only.square > kByNoise) return -1.0;
  return c * only.square * (2.0 * free - c);
}

/// Curves: all leading sets from one pass. @pre every variant is the beginning of the last
Gain best_curve(const std::vector<std::vector<Index>>& variants, const Ref<const MatrixXd>& gram,
                const Ref<const VectorXd>& z, const Ref<const VectorXd>& original, double absorbed, Price price) {
  Gain best;
  double best_score = -kBeyondAll;
  std::size_t next = 0;
  const auto each = [&](Index i, const Step& step) {
    if (static_cast<std::size_t>(i) + 1 != variants[next].size()) return;
    const double score = step.gain - price.of(step.free);
    if (step.free > 0 && score > best_score) {
      best_score = score;
      best = {step.gain, price.of(step.free), step.free, next};
    }
    ++next;
  };
  for_each_step<Eigen::Dynamic>(gram, z, variants.back(), original, absorbed, each);
  return best;
}

}  // namespace

Gain best_gain(const Family& family, const std::vector<std::vector<Index>>& variants, const Ref<const MatrixXd>& gram,
               const Ref<const VectorXd>& z, const Ref<const VectorXd>& original, double absorbed, Price price) {
  const EffectTraits& traits = family.effect.traits();
  if (variants.empty()) return {};
  if (traits.is_curve) return best_curve(variants, gram, z, original, absorbed, price);
  if (traits.periodic) absorbed = std::max(absorbed, kAbsorbedPeriod);
  Gain best;
  double best_score = -kBeyondAll;
  for (std::size_t v = 0; v < variants.size(); ++v) {
    const std::vector<Index>& variant = variants[v];
    if (variant.empty() || variant.back() >= z.size()) continue;
    Step last;
    const auto each = [&](Index, const Step& step) { last = step; };
    if (variant.size() <= kFewColumns)
      for_each_step<kFewColumns>(gram, z, variant, original, absorbed, each);
    else
      for_each_step<Eigen::Dynamic>(gram, z, variant, original, absorbed, each);
    if (last.free == 0) continue;
    const double gain = variant.size() == 1 && family.range ? gain_inside(*family.range, last) : last.gain;
    if (gain < 0.0) continue;
    // a wave has its amplitude and phase even where the targets show little of one
    const std::size_t priced = traits.periodic ? variant.size() : last.free;
    const double score = gain - price.of(priced);
    if (score <= best_score) continue;
    best_score = score;
    best = {gain, price.of(priced), priced, v};
  }
  return best;
}

Choice choice_of(const Gain& gain, const std::vector<std::vector<Index>>& variants) {
  Choice choice;
  choice.gain = gain.gain;
  choice.cost = gain.cost;
  choice.parameters = gain.parameters;
  if (gain.parameters > 0) choice.columns = variants[gain.variant];
  return choice;
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
