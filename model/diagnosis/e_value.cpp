// Split likelihood ratio (universal inference: Wasserman, Ramdas and Balakrishnan 2020, PNAS 117, 16880): the effect is
// fitted to one half and judged on the other, there on contrasts that the model cannot take (Patterson and Thompson
// 1971), each side with its own size of the noise. Means of e-values over splits are e-values (Vovk and Wang 2021,
// Annals of Statistics 49, 1736). F test of added columns (Fisher 1922; Draper and Smith 1998, 6.1) on whitened
// readings (Aitken 1935), the best of many tests by Bonferroni's inequality with equal weights for candidates and,
// within each, for its tests.
#include "model/diagnosis/e_value.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <set>

#include "base/linear/decompositions.hpp"
#include "model/data/curve_basis.hpp"
#include "model/diagnosis/structure.hpp"
#include "model/effects/definition.hpp"
#include "model/effects/quantities.hpp"
#include "model/fit/held_out.hpp"
#include "model/fit/search.hpp"
#include "model/fit/statistics.hpp"

namespace ecs::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Readings that a half must have beyond what is fitted to it.
constexpr double kSpareInHalf = 4.0;
/// Share of a column that must be left beside the model in each half, in squares, for the half to show it.
constexpr double kLeastShown = 1e-6;
/// ln of the greatest e-value that is reported: a double ends beyond.
constexpr double kMostLn = 690.0;
/// Readings weighed at the utmost.
constexpr std::size_t kMostWeighed = 1200;

/// Of the wanders, this many of the likeliest without an effect, and with one that leaves little, are open to both
/// hypotheses: a choice; those that are far from all readings are far from a half of them too.
constexpr std::size_t kWanders = 8;

/// Deviances closer than this are equal: where the fitted half is one run, a level of its own for every run changes
/// nothing there. Of laws that suit it equally the first is taken, which is the noise without a wander.
constexpr double kSameDeviance = 0.01;

/// If an effect acts on no more readings than these, a half does not settle its sizes, noise and place or time: there
/// the judged half is weighed by the average over them, not by the best. Of a searched parameter so many values are
/// averaged.
constexpr std::size_t kFewReadings = 60, kValuesWeighed = 12;

bool acts_on_few(const Regressors& regressors, const EffectInstance& effect) {
  return regressors.acting(effect).rows.size() <= kFewReadings;
}

/// With more targets than this, the halves must also show a wave of four steps, which then has eight periods or more. A
/// choice.
constexpr std::size_t kManyTargets = 32;

/// True: the first half.
using Half = std::vector<bool>;

Half by_run(const Observations& data) {
  std::map<std::pair<Channel, Axis>, std::set<int>> runs;
  for (std::size_t k = 0; k < data.size(); ++k) runs[{data.channel(k), data.axis[k]}].insert(data.run[k]);
  Half half(data.size());
  for (std::size_t k = 0; k < data.size(); ++k) {
    const std::set<int>& of_line = runs[{data.channel(k), data.axis[k]}];
    half[k] = std::distance(of_line.begin(), of_line.find(data.run[k])) % 2 == 0;
  }
  return half;
}

Half by_target(const Observations& data) {
  std::map<std::pair<Channel, Axis>, std::vector<double>> targets;
  for (std::size_t k = 0; k < data.size(); ++k) targets[{data.channel(k), data.axis[k]}].push_back(data.along_of(k));
  for (auto& each : targets) each.second = distinct(std::move(each.second), kSamePlace_mm);
  Half half(data.size());
  for (std::size_t k = 0; k < data.size(); ++k) {
    const auto& list = targets[{data.channel(k), data.axis[k]}];
    const double p = data.along_of(k) + 0.1 * kSamePlace_mm;
    // pairs of neighbours go together: single ones would see a wave of two steps as a constant. Of many targets the
    // pairs follow the sequence of Thue and Morse, which has no period: alternating ones see a wave of four steps so.
    const auto pair = static_cast<std::size_t>(std::ranges::upper_bound(list, p) - list.begin()) / 2;
    half[k] = (list.size() > kManyTargets ? std::popcount(pair) : static_cast<int>(pair)) % 2 == 0;
  }
  return half;
}

/// Those of `more` that the readings which are not hidden show beyond `columns` and one another.
MatrixXd columns_beyond(const MatrixXd& columns, const MatrixXd& more, const std::vector<bool>& hidden) {
  MatrixXd seen = MatrixXd::Zero(columns.rows() + columns.cols() + more.cols(), columns.cols() + more.cols());
  seen.topRows(columns.rows()) = beside(columns, more);
  for (std::size_t k = 0; k < hidden.size(); ++k)
    if (hidden[k]) seen.row(static_cast<Index>(k)).setZero();
  const VectorXd own = beyond_those_before(seen);
  MatrixXd shown(columns.rows(), 0);
  for (Index j = 0; j < more.cols(); ++j) {
    const double length = seen.col(columns.cols() + j).norm();
    if (std::pow(own(columns.cols() + j), 2) > kLeastShown * length * length) shown = beside(shown, more.col(j));
  }
  return shown;
}

struct AveragedRatio {
  double ln = 0.0;
  double fitted = 0.0;  ///< deviance of the fitted readings with the effect
};
/// ln of the ratio of the densities of the judged readings, given the others, with the effect and without it. Both
/// average over all sizes of columns and noise (invariant e-statistics: Pérez-Ortiz, Lardy, de Heide and Grünwald 2024,
/// Annals of Statistics 52, 1410); the effect is given the law that suits the fitted readings best, the null hypothesis
/// the one that suits the judged ones best: readings of both halves may depend on each other.
/// @return nothing where a half does not show the effect
std::optional<AveragedRatio> ratio_beside_wander(const Evidence& on, const MatrixXd& columns, const Columns& own,
                                                 const VectorXd& target, const std::vector<Wander>& laws,
                                                 const std::vector<bool>& hidden_judged) {
  const Observations& data = on.regressors.data();
  const MatrixXd null = independent_columns(columns, on.left_out);
  const MatrixXd null_fitted = independent_columns(null, hidden_judged);
  const MatrixXd shown = columns_beyond(null_fitted, own.of, hidden_judged);
  if (shown.cols() < own.of.cols()) return std::nullopt;
  const MatrixXd effect = beside(null, shown), effect_fitted = beside(null_fitted, shown), none(null.rows(), 0);
  const auto fitted_readings = static_cast<double>(std::ranges::count(hidden_judged, false));
  if (fitted_readings < static_cast<double>(effect_fitted.cols()) + kSpareInHalf) return std::nullopt;
  const VectorXd rest = own.fixed.size() > 0 ? VectorXd(target - own.fixed) : target;
  double likeliest = kBeyondAll, of_effect = kBeyondAll, of_null = kBeyondAll;
  for (const Wander& law : laws) {
    const double fitted = deviance_of(data, law, hidden_judged, effect_fitted, none, rest);
    if (fitted < likeliest - kSameDeviance) {
      likeliest = fitted;
      of_effect = deviance_of(data, law, on.left_out, effect, none, rest) - fitted;
    }
    of_null = std::min(of_null, deviance_of(data, law, on.left_out, null, none, target) -
                                    deviance_of(data, law, hidden_judged, null_fitted, none, target));
  }
  return AveragedRatio{0.5 * (of_null - of_effect), likeliest};
}

/// The same averaged over the values of the searched parameter, each as likely as the fitted readings say.
/// @param values  best first, one at least
std::optional<double> ln_ratio_averaged(const Evidence& on, const Search& search, const std::vector<Choice>& values,
                                        const MatrixXd& columns, const VectorXd& target,
                                        const std::vector<Wander>& laws, const std::vector<bool>& hidden_judged) {
  std::vector<AveragedRatio> ratios;
  for (const Choice& value : values)
    if (const auto ratio = ratio_beside_wander(on, columns, search.columns_of(value), target, laws, hidden_judged))
      ratios.push_back(*ratio);
  if (ratios.empty()) return std::nullopt;
  const double least = std::ranges::min(ratios, {}, &AveragedRatio::fitted).fitted;
  const double most = std::ranges::max(ratios, {}, &AveragedRatio::ln).ln;
  double weights = 0.0, sum = 0.0;
  for (const AveragedRatio& ratio : ratios) {
    const double weight = std::exp(-0.5 * (ratio.fitted - least));
    weights += weight;
    sum += weight * std::exp(ratio.ln - most);
  }
  return most + std::log(std::max(sum / weights, kLeastDivisor));
}

/// ln of the ratio of likelihoods on the readings of `judged`; nothing where a half does not show the effect.
/// @param laws  of the noise; none: that of `on`
std::optional<double> ln_ratio(const Evidence& on, const MatrixXd& columns, const VectorXd& target,
                               const EffectInstance& effect, const std::vector<Wander>& laws, const Half& judged) {
  const Observations& data = on.regressors.data();
  std::vector<bool> hidden_judged = on.left_out, hidden_fitted = on.left_out;
  double count_judged = 0.0, count_fitted = 0.0;
  for (std::size_t k = 0; k < data.size(); ++k) {
    if (on.left_out[k]) continue;
    (judged[k] ? hidden_judged : hidden_fitted)[k] = true;
    (judged[k] ? count_judged : count_fitted) += 1.0;
  }
  const Whitener fit(data, on.noise, hidden_judged), judge(data, on.noise, hidden_fitted);
  const Search search(on.regressors, fit, columns, target, {effect});
  const std::vector<Choice> found = search.expand(search.base(), 1);
  const double freedom = static_cast<double>(search.base().q.cols());
  if (found.empty() || count_fitted < freedom + kSpareInHalf) return std::nullopt;
  const Columns own = search.columns_of(found.front());
  const VectorXd rest = own.fixed.size() > 0 ? VectorXd(target - own.fixed) : target;
  const MatrixXd white_fit = fit(beside(columns, own.of));
  const VectorXd sizes = least_squares(white_fit, fit(rest));
  const double spare = std::max(1.0, count_fitted - freedom - static_cast<double>(own.of.cols()));
  const double variance = std::max((fit(rest) - white_fit * sizes).squaredNorm() / spare, kLeastDivisor);

  // on the judged half what the model can take is taken off both: no size of it has to be carried over
  Space model;
  model.y = judge(target);
  model.q.resize(model.y.size(), 0);
  absorb(model, judge(columns));
  VectorXd raw = own.fixed.size() > 0 ? own.fixed : VectorXd(VectorXd::Zero(target.size()));
  if (own.of.cols() > 0) raw += own.of * sizes.tail(own.of.cols());
  const VectorXd contribution = judge(raw);
  const VectorXd beyond = without(model.q, contribution);
  if (beyond.squaredNorm() <= kLeastShown * contribution.squaredNorm()) return std::nullopt;
  const double freedom_judged = count_judged - static_cast<double>(model.q.cols());
  if (freedom_judged < kSpareInHalf) return std::nullopt;
  const double alone = std::max(model.chi2(), kLeastDivisor), left = (model.y - beyond).squaredNorm();
  if (!laws.empty()) {
    std::vector<Choice> values{found.front()};
    if (acts_on_few(on.regressors, effect) && !effect.definition().searched_parameter().empty())
      for (const Choice& value : search.peaks_of(search.base(), 0))
        if (values.size() < kValuesWeighed) values.push_back(value);
    return ln_ratio_averaged(on, search, values, columns, target, laws, hidden_judged);
  }
  return 0.5 * (freedom_judged * std::log(alone / freedom_judged / variance) + freedom_judged - left / variance);
}

/// The same on an even part of the readings: it costs less, and there is evidence enough.
std::optional<double> weighed_in_part(const Evidence& all, const MatrixXd& columns, const VectorXd& target,
                                      const EffectInstance& effect, NullHypothesis null) {
  const Observations& data = all.regressors.data();
  std::vector<std::size_t> chosen;
  std::vector<Index> place(data.size(), -1);
  for (std::size_t i = 0; i < kMostWeighed; ++i) {
    chosen.push_back(i * data.size() / kMostWeighed);
    place[chosen.back()] = static_cast<Index>(i);
  }
  const Observations part = subset(data, chosen);
  const Regressors regressors(part);
  NoiseModel noise = all.noise;
  for (NoiseGroup& group : noise.groups) {
    std::vector<std::size_t> rows;
    for (const std::size_t k : group.rows)
      if (place[k] >= 0) rows.push_back(static_cast<std::size_t>(place[k]));
    group.rows = std::move(rows);
  }
  if (!all.noise.relative.empty()) {
    noise.relative.clear();
    for (const std::size_t k : chosen) noise.relative.push_back(all.noise.relative[k]);
  }
  std::erase_if(noise.groups, [](const NoiseGroup& group) { return group.rows.empty(); });
  std::vector<bool> left_out(chosen.size());
  MatrixXd part_columns(static_cast<Index>(chosen.size()), columns.cols());
  VectorXd part_target(part_columns.rows());
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    left_out[i] = all.left_out[chosen[i]];
    part_columns.row(static_cast<Index>(i)) = columns.row(static_cast<Index>(chosen[i]));
    part_target(static_cast<Index>(i)) = target(static_cast<Index>(chosen[i]));
  }
  return e_value_of({regressors, noise, left_out}, part_columns, part_target, effect, null);
}

/// Whether half of the targets can show as many functions of a curve as all of them do, beside its mean and slope. Of
/// few targets they often cannot: the curve that is fitted to them is another one, and says nothing of this one.
bool half_of_targets_shows(const Evidence& on, const MatrixXd& columns, const VectorXd& target,
                           const EffectInstance& effect) {
  const EffectTraits& traits = effect.traits();
  if (!traits.is_curve || !effect.axis) return true;
  const std::size_t targets =
      acting_positions(on.regressors.motions(), on.regressors.acting(effect), *effect.axis).size();
  if (targets > kFreeTargets) return true;
  const Whitener whitener(on.regressors.data(), on.noise, on.left_out);
  const Search search(on.regressors, whitener, columns, target, {effect});
  const std::vector<Choice> best = search.expand(search.base(), 1);
  const std::size_t mean_and_slope = 2U - (traits.keeps_mean ? 1U : 0U) - (traits.keeps_slope ? 1U : 0U);
  return best.empty() || 2 * (best.front().columns.size() + mean_and_slope) <= targets;
}

}  // namespace

std::optional<double> e_value_of(const Evidence& on, const MatrixXd& columns, const VectorXd& target,
                                 const EffectInstance& effect, NullHypothesis null) {
  const Observations& data = on.regressors.data();
  if (data.size() > kMostWeighed) return weighed_in_part(on, columns, target, effect, null);
  std::vector<Wander> laws;
  const bool is_correlated =
      std::ranges::any_of(on.noise.groups, [](const NoiseGroup& g) { return g.correlated > 0.0; });
  if (null == NullHypothesis::noise_or_wander || is_correlated || acts_on_few(on.regressors, effect))
    laws.push_back({on.noise, 0.0});
  if (null == NullHypothesis::noise_or_wander) {
    const auto add_likely = [&](const MatrixXd& with, const VectorXd& rest) {
      std::vector<LikelyWander> likely = likely_wanders(data, on.noise, on.left_out, with, rest);
      likely.resize(std::min(kWanders, likely.size()));
      for (LikelyWander& one : likely) laws.push_back(std::move(one.law));
    };
    add_likely(columns, target);
    const Whitener whitener(data, on.noise, on.left_out);
    const Search search(on.regressors, whitener, columns, target, {effect});
    for (const Choice& best : search.expand(search.base(), 1)) {
      if (is_like_wander(effect) && search.solution({best}).space.chi2() > kMostBesideEffect * search.base().chi2())
        continue;
      const Columns own = search.columns_of(best);
      add_likely(beside(columns, own.of), own.fixed.size() > 0 ? VectorXd(target - own.fixed) : target);
    }
  }
  std::vector<double> ln;
  std::vector<Half> halves{by_run(data)};
  if (half_of_targets_shows(on, columns, target, effect)) halves.push_back(by_target(data));
  for (const Half& half : halves) {
    Half other = half;
    other.flip();
    for (const Half& judged : {half, other})
      if (const auto ratio = ln_ratio(on, columns, target, effect, laws, judged)) ln.push_back(*ratio);
  }
  if (ln.empty()) return std::nullopt;
  double mean = 0.0;
  for (const double one : ln) mean += std::exp(std::min(one, kMostLn)) / static_cast<double>(ln.size());
  return mean;
}

namespace {

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
  const auto kept = static_cast<double>(std::ranges::count(on.left_out, false));
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
