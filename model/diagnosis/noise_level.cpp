// The level from replicates of noise (parametric bootstrap: Efron and Tibshirani 1993, 6.5; the largest of all tests:
// Westfall and Young 1993; drawn until a bet on them is lost: Fischer and Ramdas 2025).
#include <algorithm>
#include <cmath>

#include "model/diagnosis/e_value.hpp"
#include "model/effects/quantities.hpp"
#include "model/fit/statistics.hpp"

namespace ecs::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXf;

/// What refining a period and adding harmonics may gain on noise, which the replicates are not given: χ² of two
/// degrees exceeds it in one case of twenty. A choice.
constexpr double kRefinement = 6.0;
/// Replicates of so few readings are searched as the readings are, not on the grid alone: a choice, for the time.
constexpr Index kFewReadings = 100;
/// An effect scores at least this (beyond kRefinement), whatever the replicates: e^(8/2) = 55 to 1 by Schwarz's
/// approximation of the Bayes factor.
constexpr double kLeastEntry = 8.0;
/// Scores of noise are between these; sixty halvings of that find the level to the last digit.
constexpr double kLowestScore = -50.0, kHighestScore = 1000.0;
constexpr int kHalvings = 60;
/// Replicates drawn before it is asked whether noise explains all: few, for most data sets of a healthy machine end
/// there. A bet that their chance is rare is lost with this wealth: it would be won back in one case of a hundred.
constexpr std::size_t kFirstReplicates = 40;
constexpr double kRareChance = 0.1, kLost = 0.01;
/// Noise is tried at sizes up to so many times the first, each so many times the one before: between two of them a
/// ratio is too small by a thirtieth of the freedom at most.
constexpr double kLargest = 64.0, kLarger = 1.6;

/// Least score that noise alone reaches with at most the given chance.
double score_at(const std::vector<double>& replicate_scores, double chance) {
  double low = kLowestScore, high = kHighestScore;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (tail_probability(replicate_scores, middle) > chance ? low : high) = middle;
  }
  return high;
}

/// Whether this many replicates of noise reach a value that it is not worth drawing more.
bool loses_to_noise(double value, const std::vector<double>& replicates) {
  const auto reached =
      static_cast<std::size_t>(std::ranges::count_if(replicates, [&](double replicate) { return replicate >= value; }));
  return wealth_of_bet(kRareChance, reached, replicates.size()) < kLost;
}

/// What an effect of k coefficients explains that takes this share of the squares of noise whose size is not known,
/// less its price: it falls with k as the chance of the F test rises, which is the integral of (1 - share)^((freedom -
/// k)/2).
double ratio_of(const Choice& one, double squares, double freedom) {
  const double spare = std::max(0.0, freedom - static_cast<double>(one.columns.size()));
  return -spare * std::log(std::max(1.0 - one.gain / squares, kLeastDivisor)) - one.cost;
}

/// The greatest ratio that an effect reaches on each column of noise. The ratio is the greatest of its tangents, and
/// one tangent is the score on noise of one size: K times the share, K from `freedom` on, where each coefficient costs
/// ln(K / freedom) more.
std::vector<double> best_ratios(const Search& search, const MatrixXf& noise, double freedom) {
  std::vector<double> best(static_cast<std::size_t>(noise.cols()), -kBeyondAll);
  bool rises = true;
  double larger = 1.0;
  while (rises && larger < kLargest) {
    MatrixXf sets = noise;
    for (Index b = 0; b < sets.cols(); ++b)
      sets.col(b) *=
          static_cast<float>(std::sqrt(larger * freedom / std::max<double>(sets.col(b).squaredNorm(), kLeastDivisor)));
    const std::vector<double> scores = search.best_scores(sets, std::log(larger));
    rises = false;
    for (std::size_t b = 0; b < best.size(); ++b) {
      const double at_tangent = scores[b] - freedom * (larger - 1.0 - std::log(larger));
      rises = rises || at_tangent > best[b];
      best[b] = std::max(best[b], at_tangent);
    }
    larger *= kLarger;
  }
  return best;
}

/// The greatest ratio that an effect reaches on one column of noise, the best effects refined as those on the readings
/// are, beside the model with its own terms as they are there.
double best_ratio(const Search& search, const Eigen::VectorXf& noise, double freedom) {
  const Eigen::MatrixXd& q = search.alone().space.q;
  const Eigen::VectorXd drawn = noise.cast<double>();
  const Space space{q, drawn - q * (q.transpose() * drawn)};
  double best = -kBeyondAll;
  for (const Choice& one : search.expand(space, kRefinedBesideNoise))
    best = std::max(best, ratio_of(one, space.chi2(), freedom));
  return best;
}

}  // namespace

void find_level(const Search& search, const Structure& structure, Replicates& replicates,
                const DiagnoseOptions& options, Found& found) {
  const Space& alone = search.alone().space;
  replicates.draw_up_to(std::min(kFirstReplicates, options.noise_replicates));
  found.replicate_scores = search.best_scores(replicates.all());
  found.entry_score = kBeyondAll;
  const MatrixXf what_is_left = alone.y.cast<float>();
  if (loses_to_noise(search.best_scores(what_is_left).front(), found.replicate_scores) &&
      loses_to_noise(largest_of(found.before), structure.largest_of(alone, replicates.beside(alone))))
    return;
  replicates.draw_up_to(options.noise_replicates);
  const auto more = static_cast<Index>(replicates.size() - found.replicate_scores.size());
  const std::vector<double> scores = search.best_scores(replicates.all().rightCols(more));
  found.replicate_scores.insert(found.replicate_scores.end(), scores.begin(), scores.end());
  found.entry_score = kRefinement + std::max(kLeastEntry, score_at(found.replicate_scores, options.false_naming_limit));
}

BesideNoise beside_noise_of_any_size(const Search& search, const OfOneNoise& readings, Replicates& replicates,
                                     const std::vector<Choice>& choices, const DiagnoseOptions& options) {
  const auto here = [&](const Choice& one) { return ratio_of(one, readings.squares, readings.freedom); };
  BesideNoise beside{*std::ranges::max_element(choices, {}, here)};
  const bool exactly = readings.counts.size() <= kFewReadings;
  std::vector<double> of_noise;
  const auto look_at = [&](std::size_t count) {
    replicates.draw_up_to(count);
    const auto more = static_cast<Index>(replicates.size() - of_noise.size());
    const MatrixXf noise = readings.counts.asDiagonal() * replicates.all().rightCols(more);
    if (exactly) {
      for (const auto& column : noise.colwise()) of_noise.push_back(best_ratio(search, column, readings.freedom));
      return;
    }
    const std::vector<double> ratios = best_ratios(search, noise, readings.freedom);
    of_noise.insert(of_noise.end(), ratios.begin(), ratios.end());
  };
  look_at(std::min(kFirstReplicates, options.noise_replicates));
  if (loses_to_noise(here(beside.best), of_noise)) return beside;
  look_at(options.noise_replicates);
  const bool refined_here_only = !exactly && is_searched(search.families()[beside.best.family].effect);
  beside.chance = tail_probability(of_noise, here(beside.best) - (refined_here_only ? kRefinement : 0.0));
  return beside;
}

}  // namespace ecs::model
