// What every candidate in the bank gains on a residual, and what chance alone lets the best of them gain.
// Does not live here: the bank (search_bank.cpp).
#include <algorithm>
#include <cmath>
#include <numbers>

#include "model/effects/definition.hpp"
#include "model/fit/gains.hpp"
#include "model/fit/held_out.hpp"
#include "model/fit/search.hpp"
#include "model/fit/statistics.hpp"
#include "model/linear/decompositions.hpp"

namespace ecs::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::MatrixXf;
using Eigen::VectorXd;

/// Peaks of a scan looked at, and of them those that differ from the best by more than a share of its period.
constexpr std::size_t kMostPeaks = 6, kOtherPeaks = 2;
constexpr double kSamePeak = 0.02;
/// Refining a period that is known from its double or half raises its score by no more than this. A choice: its
/// frequency is off by half the rounding of the refinement.
constexpr double kRefinedRise = 10.0;

double score_of(const Choice& choice) { return choice.score(); }

/// What turns comes back: a period in degrees goes into a turn a whole number of times.
bool is_fraction_of_turn(double period_deg) {
  const double orders = 360.0 / period_deg;
  return orders > 0.5 && std::abs(orders - std::round(orders)) < 1e-6 * orders;
}

}  // namespace

std::vector<Choice> Search::scores_of(std::size_t f, const MatrixXd& more_q, const VectorXd& y,
                                      std::size_t most) const {
  const Family& family = families_[f];
  const FamilyBank& bank = banks_[f];
  const MatrixXf& columns = bank.shapes->columns;
  const VectorXd z = (columns.transpose() * gathered(f, y).cast<float>()).cast<double>();
  MatrixXd lost;
  if (more_q.cols() > 0) lost = (gathered(f, more_q).cast<float>().transpose() * columns).cast<double>();
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
      gain = best_gain(family, bank.variants, gram, z.segment(item.start, item.count), original, kAbsorbedScreening,
                       item.price);
    else if (gram(0, 0) > kAbsorbedScreening * original(0))
      gain = {2.0 * z(item.start) - gram(0, 0), item.price.of(0), 0, 0};
    if (gain.gain > 0.0) list.push_back({gain, i});
  }
  sort_greatest_first(list, [](const Scored& scored) { return scored.gain.score(); });
  std::vector<Choice> choices;
  for (const Scored& one : list) {
    if (choices.size() >= most) break;
    choices.push_back(completed(choice_of(one.gain, bank.variants), f, items_[one.item].nonlinear));
  }
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
  // the period may be twice the one found (its second harmonic stronger) or half of it, or another peak
  const bool of_turn = families_[f].effect.rotary;
  for (const double value : {2.0 * best.nonlinear, 0.5 * best.nonlinear})
    if ((!of_turn || is_fraction_of_turn(value)) &&
        choice_at(space, f, value).score() > (fits ? best.score() - kRefinedRise : 0.0))
      take(refined_choice(space, f, value));
  std::size_t tried = 0;
  for (std::size_t j = 1; j < std::min(peaks.size(), kMostPeaks) && tried < kOtherPeaks; ++j) {
    if (std::abs(peaks[j].nonlinear / best.nonlinear - 1.0) <= kSamePeak) continue;
    ++tried;
    take(refined_choice(space, f, peaks[j].nonlinear));
  }
  if (!fits) best.gain = 0.0;
  return best;
}

/// Whether a periodic error of that size would make the reading run backwards within its period: short periods seen at
/// far targets pass for slow shapes, but not at any size.
bool Search::too_steep(const Space& space, const Choice& choice) const {
  const EffectInstance& effect = families_[choice.family].effect;
  if (effect.sense && is_rotation(*effect.sense)) return false;
  const MatrixXd white = without(space.q, white_columns_of(choice));
  const double amplitude_um = least_squares(white, space.y).norm();
  return 2.0 * std::numbers::pi * 1e-3 * amplitude_um > choice.nonlinear;
}

std::vector<Choice> Search::peaks_of(const Space& space, std::size_t f) const {
  return scores_of(f, at_motions(MatrixXd(space.q.rightCols(space.q.cols() - base_.q.cols()))),
                   at_motions(MatrixXd(space.y)).col(0), items_.size());
}

std::vector<Choice> Search::expand(const Space& space, std::size_t exact) const {
  const VectorXd y = at_motions(MatrixXd(space.y)).col(0);
  const MatrixXd more_q = at_motions(MatrixXd(space.q.rightCols(space.q.cols() - base_.q.cols())));
  std::vector<std::vector<Choice>> peaks(candidates_);
  std::vector<Choice> list;
  for (std::size_t f = 0; f < candidates_; ++f) {
    heed_cancel();
    peaks[f] = scores_of(f, more_q, y, kMostPeaks);
    if (!peaks[f].empty()) list.push_back(peaks[f].front());
  }
  sort_greatest_first(list, score_of);
  for (std::size_t i = 0; i < std::min(exact, list.size()); ++i) {
    heed_cancel();
    const std::size_t f = list[i].family;
    list[i] = families_[f].effect.traits().periodic ? best_period(space, peaks[f])
                                                    : refined_choice(space, f, list[i].nonlinear);
  }
  std::erase_if(list, [](const Choice& choice) { return choice.gain <= 0.0; });
  // of equals the first of the library is first
  std::sort(list.begin(), list.end(), [](const Choice& a, const Choice& b) { return a.family < b.family; });
  sort_greatest_first(list, score_of);
  return list;
}

void Search::raise_by(const Item& item, const Eigen::Ref<const MatrixXf>& z, std::vector<double>& top) const {
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
  const double absorbed = family.effect.traits().periodic ? kAbsorbedPeriod : kAbsorbedScreening;
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
    std::size_t free = 0;
    for (Index i = 0; i < k; ++i) {  // Gram-Schmidt on the products
      const double square = g(i, i);
      if (square > absorbed * original(variant[static_cast<std::size_t>(i)]) && square > 0.0) {
        ++free;
        sum += right.row(i).cwiseAbs2() / square;
        for (Index j = i + 1; j < k; ++j) {
          const double share = g(j, i) / square;
          right.row(j) -= share * right.row(i);
          for (Index m = j; m < k; ++m) g(m, j) -= share * g(m, i);
        }
      }
      const bool complete = family.effect.traits().is_curve ? allowed[static_cast<std::size_t>(i) + 1] : i + 1 == k;
      if (free == 0 || !complete) continue;
      const double cost = item.price.of(free);
      for (Index b = 0; b < z.cols(); ++b) raise(b, sum(b) - cost);
    }
  }
}

std::vector<double> Search::best_scores(const MatrixXf& blanks) const {
  std::vector<double> best(static_cast<std::size_t>(blanks.cols()), -1e300);
  const MatrixXd spread = at_motions(blanks.cast<double>());
  for (std::size_t f = 0; f < candidates_; ++f) {
    heed_cancel();
    const FamilyBank& bank = banks_[f];
    const MatrixXf seen = gathered(f, spread).cast<float>();
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
        raise_by(items_[j], z.middleRows(items_[j].start - items_[i].start, items_[j].count), best);
      i = last + 1;
    }
  }
  return best;
}

}  // namespace ecs::model
