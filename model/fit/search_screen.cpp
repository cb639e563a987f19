// What every candidate in the bank gains on a residual, and what chance alone lets the best of them gain. The fall of
// χ² by each further column: sequential sums of squares from the Cholesky factor of the products (Golub and Van Loan
// 2013, 4.2); the price per column is Schwarz's (1978), by the caller. Does not live here: the bank (search_bank.cpp).

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>

#include <Eigen/Cholesky>

#include "base/linear/decompositions.hpp"
#include "model/data/curve_basis.hpp"
#include "model/effects/definition.hpp"
#include "model/effects/quantities.hpp"
#include "model/fit/held_out.hpp"
#include "model/fit/search.hpp"
#include "model/fit/statistics.hpp"

namespace ecs::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Ref;
using Eigen::VectorXd;

/// Functions of a curve beyond its leading ones, at least: fewer are a line and a bow, which have effects of their own.
constexpr std::size_t kFewestCurveFunctions = 4;

/// Sets of at most this many columns are worked on without an allocation: a wave with its harmonic has four.
constexpr int kFewColumns = 6;

/// One step of the factor: what the columns up to here gain together.
struct Step {
  double gain = 0.0;
  std::size_t free = 0;  ///< independent columns so far
  double square = 0.0;   ///< of this column, what the ones before have taken off
  double right = 0.0;    ///< its product with what is left
  bool adds = false;     ///< anything is left of this column
};

/// @param error  of the column, in units of rounding
double least_square(Precision precision, double original, double error) {
  return std::max(precision.absorbed * original, precision.grown * error * error);
}

/// Cholesky column by column in this order, from products; columns that add nothing gain nothing.
template <int kMost, class Each>
void for_each_step(const Ref<const MatrixXd>& gram, const Ref<const VectorXd>& z, const std::vector<Index>& order,
                   const Ref<const VectorXd>& original, Precision precision, Each each) {
  const auto k = static_cast<Index>(order.size());
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMost, kMost> l(k, k);
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMost, 1> u(k), error(k);
  l.setZero();
  u.setZero();
  Step step;
  for (Index i = 0; i < k; ++i) {
    const Index column = order[static_cast<std::size_t>(i)];
    step.square = gram(column, column);
    step.right = z(column);
    error(i) = std::sqrt(std::max(original(column), 0.0));
    for (Index j = 0; j < i; ++j) {
      double v = gram(column, order[static_cast<std::size_t>(j)]);
      for (Index m = 0; m < j; ++m) v -= l(i, m) * l(j, m);
      l(i, j) = l(j, j) > 0.0 ? v / l(j, j) : 0.0;
      step.square -= l(i, j) * l(i, j);
      step.right -= l(i, j) * u(j);
      if (l(j, j) > 0.0) error(i) += std::abs(l(i, j)) / l(j, j) * error(j);
    }
    step.adds = step.square > least_square(precision, original(column), error(i)) && step.square > 0.0;
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
                const Ref<const VectorXd>& z, const Ref<const VectorXd>& original, Precision precision, Price price) {
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
  for_each_step<Eigen::Dynamic>(gram, z, variants.back(), original, precision, each);
  return best;
}

}  // namespace

Gain best_gain(const Family& family, const std::vector<std::vector<Index>>& variants, const Ref<const MatrixXd>& gram,
               const Ref<const VectorXd>& z, const Ref<const VectorXd>& original, Precision precision, Price price) {
  const EffectTraits& traits = family.effect.traits();
  if (variants.empty()) return {};
  if (traits.is_curve) return best_curve(variants, gram, z, original, precision, price);
  if (traits.periodic) precision.absorbed = std::max(precision.absorbed, kAbsorbedPeriod);
  Gain best;
  double best_score = -kBeyondAll;
  for (std::size_t v = 0; v < variants.size(); ++v) {
    const std::vector<Index>& variant = variants[v];
    if (variant.empty() || variant.back() >= z.size()) continue;
    Step last;
    const auto each = [&](Index, const Step& step) { last = step; };
    if (variant.size() <= kFewColumns)
      for_each_step<kFewColumns>(gram, z, variant, original, precision, each);
    else
      for_each_step<Eigen::Dynamic>(gram, z, variant, original, precision, each);
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

namespace {

using Eigen::MatrixXf;

/// Peaks of a scan are the same if they differ by less than this share of the period.
constexpr double kSamePeak = 0.02;
/// Refining a period that is known from its double or half raises its score by no more than this. A choice: its
/// frequency is off by half the rounding of the refinement.
constexpr double kRefinedRise = 10.0;

/// Values of a searched parameter that are tried in pairs.
constexpr std::size_t kValuesOfPair = 8;

double score_of(const Choice& choice) { return choice.score(); }

}  // namespace

std::vector<Choice> Search::scores_of(std::size_t f, const View& seen, std::size_t most) const {
  const Family& family = families_[f];
  const FamilyBank& bank = banks_[f];
  const MatrixXf& columns = bank.shapes->columns;
  const VectorXd z = (columns.transpose() * seen.y.cast<float>()).cast<double>();
  MatrixXd lost;
  if (seen.q.cols() > 0) lost = (seen.q.cast<float>().transpose() * columns).cast<double>();
  struct Scored {
    Gain gain;
    std::size_t item = 0;
  };
  std::vector<Scored> list;
  MatrixXd gram;
  for (std::size_t i = bank.first; i < bank.last; ++i) {
    const Item& item = items_[i];
    gram = Eigen::Map<const MatrixXd>(grams_.data() + item.gram, item.count, item.count);
    const Eigen::Map<const VectorXd> original(grams_.data() + item.gram + item.count * item.count, item.count);
    if (lost.size() > 0) {
      const auto part = lost.middleCols(item.start, item.count);
      gram -= part.transpose().lazyProduct(part);
    }
    Gain gain;
    if (!family.effect.traits().fixed_size)
      gain = best_gain(family, bank.variants, gram, z.segment(item.start, item.count), original,
                       precision_of_screening(f), item.price);
    else if (gram(0, 0) > kAbsorbedScreening * original(0))
      gain = {2.0 * z(item.start) - gram(0, 0), item.price.of(0), 0, 0};
    if (gain.gain > 0.0) list.push_back({gain, i});
  }
  sort_greatest_first(
      list, [](const Scored& scored) { return scored.gain.score(); }, most);
  std::vector<Choice> choices;
  for (const Scored& one : list)
    choices.push_back(completed(choice_of(one.gain, bank.variants), f, items_[one.item].nonlinear));
  return choices;
}

Choice Search::best_period(const Space& space, const std::vector<Choice>& peaks) const {
  const std::size_t f = peaks.front().family;
  Choice best = refined_choice(space, f, peaks.front().nonlinear);
  bool fits = best.gain > 0.0 && !too_steep(space, best);
  const auto take = [&](const Choice& other) {
    if ((fits && other.score() <= best.score()) || too_steep(space, other)) return;
    best = other;
    fits = true;
  };
  // the scan ranks by the coarse grid: the best of all may be a lower peak there, with its second harmonic
  std::vector<double> looked_at{peaks.front().nonlinear};
  for (const Choice& peak : peaks) {
    if (looked_at.size() == kMostPeaks) break;
    const auto is_same = [&](double value) { return std::abs(peak.nonlinear / value - 1.0) <= kSamePeak; };
    if (std::ranges::any_of(looked_at, is_same)) continue;
    looked_at.push_back(peak.nonlinear);
    take(refined_choice(space, f, peak.nonlinear));
  }
  // the period may be twice the one found (its second harmonic stronger) or half of it
  // of a turn only the fractions that are tried: others are no waves of that axis, or another effect
  const bool of_turn = families_[f].effect.rotary;
  const auto is_tried = [&](double value) {
    return std::ranges::any_of(families_[f].grid, [&](double one) { return std::abs(one / value - 1.0) < kSamePeak; });
  };
  for (const double value : {2.0 * best.nonlinear, 0.5 * best.nonlinear})
    if ((!of_turn || is_tried(value)) &&
        choice_at(space, f, value).score() > (fits ? best.score() - kRefinedRise : 0.0))
      take(refined_choice(space, f, value));
  if (!fits) best.gain = 0.0;
  return best;
}

/// Whether a periodic error of that size would make the reading run backwards within its period: short periods seen at
/// far targets pass for slow shapes, but not at any size.
bool Search::too_steep(const Space& space, const Choice& choice) const {
  const EffectInstance& effect = families_[choice.family].effect;
  if (effect.sense && is_rotation(*effect.sense)) return false;
  const MatrixXd wave = beside_base(choice.family, choice.nonlinear).columns(Eigen::all, choice.columns);
  const double amplitude_um = least_squares(left_beside(space, space.q.cols(), wave), space.y).norm();
  return 2.0 * std::numbers::pi * 1e-3 * amplitude_um > choice.nonlinear;
}

bool Search::beats_free_values(const Space& space, const Choice& choice) const {
  const Family& family = families_[choice.family];
  const EffectTraits& traits = family.effect.traits();
  if (!traits.shape_of_position || traits.is_curve || !data().paths.empty()) return true;
  const std::vector<double> places = acting_positions(data(), family.acting, *family.effect.axis);
  if (places.size() > kFreeTargets) return true;
  MatrixXd values = MatrixXd::Zero(static_cast<Index>(data().size()), static_cast<Index>(places.size()));
  for (const std::size_t k : family.acting.rows) {
    const auto at = std::ranges::lower_bound(places, data().p_mm(k, *family.effect.axis) - kSamePlace_mm);
    values(static_cast<Index>(k), std::min<Index>(at - places.begin(), values.cols() - 1)) = 1.0;
  }
  Space more = space;
  absorb(more, whitener_(values));
  // by the price of a coefficient that suits its size best (George and Foster 2000), at least that of a unit of
  // information
  const auto dearer = [&](double gain, double coefficients) {
    return coefficients * std::max(0.0, std::log(std::max(gain, 1.0) / coefficients) - family.ln_readings);
  };
  const Choice here = choice_at(space, choice.family, choice.nonlinear);
  const double gain = space.chi2() - more.chi2(), free = static_cast<double>(more.q.cols() - space.q.cols());
  return here.score() - dearer(here.gain, static_cast<double>(here.columns.size())) >=
         gain - free * family.ln_readings - dearer(gain, free) - 2.0 * std::log(kShapeBeforehand);
}

std::vector<Choice> Search::peaks_of(const Space& space, std::size_t f, std::size_t most) const {
  return scores_of(f, view_of(space, f), most);
}

std::vector<Choice> Search::expand(const Space& space, std::size_t exact) const {
  look_at(space);
  std::vector<std::vector<Choice>> peaks(candidates_);
  std::vector<Choice> list;
  for (std::size_t f = 0; f < candidates_; ++f) {
    heed_cancel();
    const View& view = latest_view(f);
    std::optional<std::vector<Choice>>& kept = answers_in(view, f).peaks;
    if (!kept) kept = scores_of(f, view, kMostPeaks);
    peaks[f] = *kept;
    if (!peaks[f].empty()) list.push_back(peaks[f].front());
  }
  sort_greatest_first(list, score_of);
  for (std::size_t i = 0; i < std::min(exact, list.size()); ++i) {
    heed_cancel();
    const std::size_t f = list[i].family;
    list[i] = families_[f].effect.traits().periodic ? best_period(space, peaks[f])
                                                    : refined_choice(space, f, list[i].nonlinear);
  }
  std::erase_if(list, [&](const Choice& choice) { return choice.gain <= 0.0; });
  // of equals the first of the library is first
  std::ranges::sort(list, [](const Choice& a, const Choice& b) { return a.family < b.family; });
  sort_greatest_first(list, score_of);
  return list;
}

std::vector<std::pair<Choice, Choice>> Search::pairs_of(const Space& space, std::size_t most, double alike) const {
  struct One {
    Choice choice;
    Index start = 0, count = 0;  ///< of its columns in `q`
  };
  std::vector<One> ones;
  std::vector<MatrixXd> columns;
  Index width = 0;
  for (std::size_t f = 0; f < candidates_; ++f) {
    heed_cancel();
    const Family& family = families_[f];
    const EffectTraits& traits = family.effect.traits();
    if (traits.periodic || traits.is_curve || traits.fixed_size || family.effect.is_user()) continue;
    const std::vector<double>& values = family.grid.empty() ? family.facts : family.grid;
    const std::size_t step = (values.size() + kValuesOfPair - 1) / kValuesOfPair;
    for (std::size_t v = 0; v < values.size(); v += step)
      for (const std::vector<Index>& variant : banks_[f].variants) {
        One one{{f, values[v], variant}, width};
        MatrixXd directions = added_by(space, whitener_(columns_of(one.choice).of)).q;
        one.count = directions.cols();
        if (one.count == 0) continue;
        one.choice.cost = price_of(family, values[v]).of(static_cast<std::size_t>(one.count));
        columns.push_back(std::move(directions));
        width += one.count;
        ones.push_back(std::move(one));
      }
  }
  MatrixXd q(space.y.size(), width);
  for (std::size_t i = 0; i < ones.size(); ++i) q.middleCols(ones[i].start, ones[i].count) = columns[i];
  const MatrixXd products = q.transpose() * q;
  const VectorXd z = q.transpose() * space.y;
  std::map<std::pair<std::size_t, std::size_t>, std::pair<Choice, Choice>> best;  // by families
  for (std::size_t i = 0; i < ones.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const One &a = ones[i], &b = ones[j];
      if (a.choice.family == b.choice.family) continue;
      const auto shared = products.block(b.start, a.start, b.count, a.count);
      if (shared.squaredNorm() < alike) continue;
      // of `a` what it adds to `b`
      MatrixXd square = MatrixXd::Identity(a.count, a.count) - shared.transpose() * shared;
      const VectorXd right = z.segment(a.start, a.count) - shared.transpose() * z.segment(b.start, b.count);
      const Eigen::LDLT<MatrixXd> solver(square);
      if (solver.vectorD().minCoeff() < kAbsorbedScreening) continue;
      Choice first = b.choice, second = a.choice;
      first.gain = z.segment(b.start, b.count).squaredNorm();
      second.gain = right.dot(solver.solve(right));
      const double score = first.score() + second.score();
      const auto [at, is_new] = best.try_emplace({b.choice.family, a.choice.family}, first, second);
      if (!is_new && score > at->second.first.score() + at->second.second.score()) at->second = {first, second};
    }
  std::vector<std::pair<Choice, Choice>> pairs;
  for (const auto& [families, pair] : best) pairs.push_back(pair);
  sort_greatest_first(pairs, [](const auto& pair) { return pair.first.score() + pair.second.score(); });
  if (pairs.size() > most) pairs.resize(most);
  return pairs;
}

Precision Search::precision_of_screening(std::size_t f) const {
  return has_places(f) ? kScreening : kScreeningOfDouble;
}

void Search::raise_by(const Item& item, const Eigen::Ref<const MatrixXf>& z, double dearer,
                      std::vector<double>& top) const {
  const Family& family = families_[item.family];
  const Eigen::Map<const MatrixXd> gram(grams_.data() + item.gram, item.count, item.count);
  const Eigen::Map<const VectorXd> original(grams_.data() + item.gram + item.count * item.count, item.count);
  const auto raise = [&](Index b, double score) {
    double& best = top[static_cast<std::size_t>(b)];
    best = std::max(best, score);
  };
  if (family.effect.traits().fixed_size) {
    const double cost = item.price.of(0);
    for (Index b = 0; b < z.cols(); ++b) raise(b, static_cast<double>(2.0F * z(0, b)) - gram(0, 0) - cost);
    return;
  }
  auto variants = banks_[item.family].variants;
  std::vector<bool> allowed(static_cast<std::size_t>(item.count) + 1, !family.effect.traits().is_curve);
  if (family.effect.traits().is_curve && !variants.empty()) {
    for (const auto& variant : variants) allowed[variant.size()] = true;
    variants = {variants.back()};
  }
  Precision precision = precision_of_screening(item.family);
  if (family.effect.traits().periodic) precision.absorbed = kAbsorbedPeriod;
  for (const std::vector<Index>& variant : variants) {
    const auto k = static_cast<Index>(variant.size());
    if (variant.back() >= item.count) continue;
    MatrixXd g(k, k), right(k, z.cols());
    for (Index i = 0; i < k; ++i) {
      right.row(i) = z.row(variant[static_cast<std::size_t>(i)]).cast<double>();
      for (Index j = 0; j < k; ++j)
        g(i, j) = gram(variant[static_cast<std::size_t>(i)], variant[static_cast<std::size_t>(j)]);
    }
    Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(z.cols());
    VectorXd error(k);
    for (Index i = 0; i < k; ++i) error(i) = std::sqrt(std::max(original(variant[static_cast<std::size_t>(i)]), 0.0));
    std::size_t free = 0;
    for (Index i = 0; i < k; ++i) {  // Gram-Schmidt on the products
      const double square = g(i, i);
      if (square > least_square(precision, original(variant[static_cast<std::size_t>(i)]), error(i)) && square > 0.0) {
        ++free;
        sum += right.row(i).cwiseAbs2() / square;
        for (Index j = i + 1; j < k; ++j) {
          const double share = g(j, i) / square;
          right.row(j) -= share * right.row(i);
          error(j) += std::abs(share) * error(i);
          for (Index m = j; m < k; ++m) g(m, j) -= share * g(m, i);
        }
      }
      const bool complete = family.effect.traits().is_curve ? allowed[static_cast<std::size_t>(i) + 1] : i + 1 == k;
      if (free == 0 || !complete) continue;
      const double cost = item.price.of(free) + dearer * static_cast<double>(free);
      for (Index b = 0; b < z.cols(); ++b) raise(b, sum(b) - cost);
    }
  }
}

std::vector<double> Search::best_scores(const MatrixXf& blanks, double dearer) const {
  std::vector<double> best(static_cast<std::size_t>(blanks.cols()), -1e300);
  const MatrixXd spread = at_motions(blanks.cast<double>());
  std::map<std::size_t, MatrixXf> seen_by;  // of the first family of the same nodes
  for (std::size_t f = 0; f < candidates_; ++f) {
    heed_cancel();
    const FamilyBank& bank = banks_[f];
    MatrixXf& seen = seen_by[bank.like];
    if (seen.size() == 0) seen = gathered(f, spread).cast<float>();
    constexpr Index kPiece = 256;
    for (std::size_t i = bank.first; i < bank.last;) {
      if (!items_[i].coarse) {
        ++i;
        continue;
      }
      std::size_t last = i;
      Index width = items_[i].count;
      while (last + 1 < bank.last && items_[last + 1].coarse && width + items_[last + 1].count <= kPiece)
        width += items_[++last].count;
      const MatrixXf z = bank.shapes->columns.middleCols(items_[i].start, width).transpose() * seen;
      for (std::size_t j = i; j <= last; ++j)
        raise_by(items_[j], z.middleRows(items_[j].start - items_[i].start, items_[j].count), dearer, best);
      i = last + 1;
    }
  }
  return best;
}

}  // namespace ecs::model
