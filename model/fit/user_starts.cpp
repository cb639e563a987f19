// Starting values of the parameters of user formulas: taken from what the formulas read, tried in all combinations and
// refined from the best of them (multistart: Rinnooy Kan and Timmer 1987).

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "base/linear/decompositions.hpp"
#include "model/fit/core.hpp"

namespace ecs::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Formulas are evaluated at most at so many readings, over all combinations; a third of a second.
constexpr std::size_t kMostEvaluations = 400'000;
constexpr std::size_t kMostCombinations = 800, kLeastCombinations = 24;
/// So many of the best combinations are refined; minima of one shape lie beside each other in the list.
constexpr std::size_t kMostRefined = 6;
/// Of a stated range.
constexpr std::size_t kOverRange = 9;
/// A minimum is better by this share of its squares: of two equal ones, as where terms of one shape change places, the
/// one that the user wrote counts.
constexpr double kBetterMinimum = 1e-6;

/// Place i of a sequence that fills 0 … 1 evenly (radical inverse).
double filling(std::size_t i, std::size_t base) {
  double place = 0.0, part = 1.0;
  for (; i > 0; i /= base) {
    part /= static_cast<double>(base);
    place += part * static_cast<double>(i % base);
  }
  return place;
}

/// Places within a range that the formula reads, widths of it, and their inverses, as of a rate: without a stated range
/// a parameter may be any of these.
std::vector<double> starts_of(const UserParameter& parameter, const std::vector<ValueRange>& read) {
  std::vector<double> starts{start_of(parameter)};
  const double least = parameter.least.value_or(-HUGE_VAL), greatest = parameter.greatest.value_or(HUGE_VAL);
  if (parameter.least && parameter.greatest) {
    for (std::size_t i = 0; i < kOverRange; ++i)
      starts.push_back(std::lerp(least, greatest, (static_cast<double>(i) + 0.5) / kOverRange));
    return starts;
  }
  for (const double factor : {0.2, 0.5, 2.0, 5.0}) starts.push_back(factor * start_of(parameter));
  for (const auto& [from, to] : read) {
    for (std::size_t i = 0; i < kOverRange; ++i)
      starts.push_back(std::lerp(from, to, (static_cast<double>(i) + 0.5) / kOverRange));
    for (const double share : {0.03, 0.1, 0.3, 1.0}) {
      const double width = share * (to - from);
      starts.insert(starts.end(), {width, 1.0 / width, -1.0 / width});
    }
  }
  std::erase_if(starts, [&](double start) { return start < least || start > greatest; });
  if (starts.empty()) starts.push_back(start_of(parameter));
  return starts;
}

/// All combinations of the starts, or an even choice of them; the first is what the user wrote.
std::vector<std::vector<double>> combinations_of(const std::vector<std::vector<double>>& starts, std::size_t most) {
  constexpr std::size_t kBases[] = {2, 3, 5, 7, 11, 13};
  std::size_t all = 1;
  for (const auto& each : starts) all = std::min(all * each.size(), kMostCombinations + 1);
  const bool every = all <= most;
  std::vector<std::vector<double>> out;
  for (std::size_t i = 0; i < (every ? all : most); ++i) {
    std::vector<double> values;
    std::size_t rest = i;
    for (std::size_t d = 0; d < starts.size(); ++d) {
      const std::size_t count = starts[d].size();
      const double place = filling(i, kBases[d % std::size(kBases)]) * static_cast<double>(count);
      values.push_back(starts[d][every ? rest % count : std::min(count - 1, static_cast<std::size_t>(place))]);
      rest /= count;
    }
    out.push_back(std::move(values));
  }
  return out;
}

/// Combinations with the sum of squares that remains where everything linear is fitted, the least first.
std::vector<std::pair<double, std::vector<double>>> screened(const Model& with, const EffectInstance& candidate,
                                                             const std::vector<std::size_t>& places,
                                                             const Regressors& regressors) {
  std::vector<std::pair<double, std::vector<double>>> out;
  auto assembly = Assembly::of(with, regressors);
  const auto formulas = UserFormulas::compile(candidate, regressors.motions());
  if (!assembly || !formulas) return out;
  static_cast<void>(fitted(*assembly, regressors, {true, true}));
  Slot& slot = assembly->slots.back();
  const Observations& data = regressors.data();
  VectorXd rest = Eigen::Map<const VectorXd>(data.reading.data(), static_cast<Index>(data.size()));
  MatrixXd others(rest.size(), 0);
  for (std::size_t s = 0; s + 1 < assembly->slots.size(); ++s) {
    rest -= assembly->slots[s].fixed;
    const MatrixXd& columns = assembly->slots[s].columns;
    others.conservativeResize(Eigen::NoChange, others.cols() + columns.cols());
    others.rightCols(columns.cols()) = columns;
  }
  const MatrixXd q = PivotedQr(others).basis();
  const std::vector<ValueRange> read = formulas->ranges_read();
  std::vector<std::vector<double>> starts;
  for (const std::size_t place : places) starts.push_back(starts_of(candidate.user[place], read));
  const std::size_t most = std::clamp(kMostEvaluations / data.size(), kLeastCombinations, kMostCombinations);
  for (std::vector<double>& values : combinations_of(starts, most)) {
    for (std::size_t d = 0; d < places.size(); ++d) {
      const auto at = std::ranges::find(slot.user_nonlinear, places[d]);
      slot.nonlinear[static_cast<std::size_t>(at - slot.user_nonlinear.begin())] = values[d];
    }
    assembly->renew(assembly->slots.size() - 1, regressors);
    if (!slot.columns.allFinite() || !slot.fixed.allFinite()) continue;
    const VectorXd left = without(q, VectorXd(rest - slot.fixed));
    const MatrixXd columns = without(q, slot.columns);
    out.emplace_back((left - columns * PivotedQr(columns).solve(left)).squaredNorm(), std::move(values));
  }
  std::ranges::stable_sort(out, {}, [](const auto& one) { return one.first; });
  return out;
}

}  // namespace

std::vector<std::size_t> nonlinear_user_parameters(const EffectInstance& effect, const Observations& data) {
  std::vector<std::size_t> places;
  if (!effect.is_user()) return places;
  const auto formulas = UserFormulas::compile(effect, data);
  if (!formulas) return places;
  std::vector<double> start;
  for (const UserParameter& parameter : effect.user) start.push_back(start_of(parameter));
  const std::vector<bool> linear = formulas->linear_parameters(start);
  for (std::size_t i = 0; i < linear.size(); ++i)
    if (!linear[i] && !effect.user[i].value) places.push_back(i);
  return places;
}

EffectInstance with_best_start(const Model& model, const EffectInstance& candidate, const Regressors& regressors) {
  const std::vector<std::size_t> places = nonlinear_user_parameters(candidate, regressors.motions());
  EffectInstance best = candidate;
  if (places.empty()) return best;
  Model with = model;
  with.effects.push_back(candidate);
  std::vector<std::vector<double>> starts{{}};  // what the user wrote
  for (const std::size_t place : places) starts.front().push_back(start_of(candidate.user[place]));
  for (const auto& [squares, values] : screened(with, candidate, places, regressors))
    if (starts.size() <= kMostRefined) starts.push_back(values);
  double least = HUGE_VAL;
  for (const std::vector<double>& values : starts) {
    for (std::size_t d = 0; d < places.size(); ++d)
      with.effects.back().fitted[candidate.user[places[d]].name] = values[d];
    auto assembly = Assembly::of(with, regressors);
    if (!assembly) continue;  // a start from which its formula has no finite values
    const CoreFit fit = fitted(*assembly, regressors, {true, true});
    const double squares = fit.residual.squaredNorm();
    if (!std::isfinite(squares) || squares >= least * (1.0 - kBetterMinimum)) continue;
    least = squares;
    const Slot& slot = assembly->slots.back();
    for (std::size_t j = 0; j < slot.user_nonlinear.size(); ++j)
      if (slot.nonlinear_free[j]) best.user[slot.user_nonlinear[j]].start = slot.nonlinear[j];
  }
  return best;
}

Model with_best_starts(Model model, const Regressors& regressors) {
  for (std::size_t i = 0; i < model.effects.size(); ++i) {
    const EffectInstance effect = model.effects[i];
    if (!effect.is_user() || !effect.fitted.empty()) continue;
    Model others = model;
    others.effects.erase(others.effects.begin() + static_cast<std::ptrdiff_t>(i));
    model.effects[i].user = with_best_start(others, effect, regressors).user;
  }
  return model;
}

}  // namespace ecs::model
