// Split likelihood ratio (universal inference: Wasserman, Ramdas and Balakrishnan 2020, PNAS 117, 16880): the effect is
// fitted to one half and judged on the other, there on contrasts that the model cannot take (Patterson and Thompson
// 1971), each side with its own size of the noise. Means of e-values over splits are e-values (Vovk and Wang 2021,
// Annals of Statistics 49, 1736).
#include "model/diagnosis/e_value.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "model/data/curve_basis.hpp"
#include "model/diagnosis/wander.hpp"
#include "model/effects/definition.hpp"
#include "model/fit/held_out.hpp"
#include "model/fit/statistics.hpp"
#include "model/linear/decompositions.hpp"

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

/// True: the first half.
using Half = std::vector<bool>;

Half by_run(const Observations& data) {
  const std::set<int> runs(data.run.begin(), data.run.end());
  Half half(data.size());
  for (std::size_t k = 0; k < data.size(); ++k) half[k] = std::distance(runs.begin(), runs.find(data.run[k])) % 2 == 0;
  return half;
}

Half by_target(const Observations& data) {
  std::map<std::pair<Sense, Axis>, std::vector<double>> targets;
  for (std::size_t k = 0; k < data.size(); ++k)
    targets[{data.sense[k], data.axis[k]}].push_back(data.p_mm(k, data.axis[k]));
  for (auto& each : targets) each.second = distinct(std::move(each.second), kSamePlace_mm);
  Half half(data.size());
  for (std::size_t k = 0; k < data.size(); ++k) {
    const auto& list = targets[{data.sense[k], data.axis[k]}];
    const double p = data.p_mm(k, data.axis[k]) + 0.1 * kSamePlace_mm;
    // pairs of neighbours go together: single ones would see a wave of two steps as a constant
    half[k] = (std::upper_bound(list.begin(), list.end(), p) - list.begin()) / 2 % 2 == 0;
  }
  return half;
}

/// ln of the ratio of likelihoods on the readings of `judged`; nothing where a half does not show the effect.
std::optional<double> ln_ratio(const Evidence& on, const MatrixXd& columns, const VectorXd& target,
                               const EffectInstance& effect, const std::optional<Wander>& wander, const Half& judged) {
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
  MatrixXd joint(columns.rows(), columns.cols() + own.of.cols());
  joint << columns, own.of;
  const MatrixXd white_fit = fit(joint);
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
  double fall = 0.0;  // of −2 ln of the likelihood, by a wander
  if (wander)
    fall = std::max(0.0, deviance_of(data, on.noise, hidden_fitted, columns, target) -
                             deviance_of(data, *wander, hidden_fitted, columns, target));
  return 0.5 * (freedom_judged * std::log(alone / freedom_judged / variance) + freedom_judged - left / variance - fall);
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

}  // namespace

std::optional<double> e_value_of(const Evidence& on, const MatrixXd& columns, const VectorXd& target,
                                 const EffectInstance& effect, NullHypothesis null) {
  const Observations& data = on.regressors.data();
  if (data.size() > kMostWeighed) return weighed_in_part(on, columns, target, effect, null);
  std::optional<Wander> wander;
  if (null == NullHypothesis::noise_or_wander && may_be_wander(on.noise, effect))
    wander = likeliest_wander(data, on.noise, on.left_out, columns, target).law;
  std::vector<double> ln;
  for (const Half& half : {by_run(data), by_target(data)}) {
    Half other = half;
    other.flip();
    for (const Half& judged : {half, other})
      if (const auto ratio = ln_ratio(on, columns, target, effect, wander, judged)) ln.push_back(*ratio);
  }
  if (ln.empty()) return std::nullopt;
  double mean = 0.0;
  for (const double one : ln) mean += std::exp(std::min(one, kMostLn)) / static_cast<double>(ln.size());
  return mean;
}

}  // namespace ecs::model
