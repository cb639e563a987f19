#include "model/fit/search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

#include "model/effects/definition.hpp"
#include "model/effects/tried_values.hpp"
#include "model/fit/gains.hpp"
#include "model/fit/statistics.hpp"
#include "model/fit/user_start.hpp"

namespace ecs::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Price of a period that the targets cannot follow: it takes on any slower shape.
constexpr double kUnseenPeriod = 8.0;
/// Different values of a user's parameter that fit a data set by chance.
constexpr double kUserTrials = 12.0;
/// A refinement goes so far beyond the neighbours on the grid, in distances to the nearer one.
constexpr double kBeyondNeighbour = 1.2;
/// A value this close to a limit, as a share of it, is at the limit: a refinement ends within a thousandth.
constexpr double kAtLimit = 0.005;
constexpr std::size_t kMostBankColumns = 10'000;
constexpr std::size_t kMostValues = 1500;  ///< of one searched parameter

MatrixXd without(const MatrixXd& q, MatrixXd columns) {
  if (q.cols() == 0) return columns;
  columns.noalias() -= q * (q.transpose() * columns);
  columns.noalias() -= q * (q.transpose() * columns);
  return columns;
}

double mean_step(const Observations& data, const Family& family) {
  std::vector<double> p;
  for (const std::size_t k : family.acting.rows) p.push_back(data.p_mm(k, *family.effect.axis));
  p = distinct(std::move(p), 1e-6);
  return p.size() < 2 ? 0.0 : (p.back() - p.front()) / static_cast<double>(p.size() - 1);
}

}  // namespace

void absorb(Space& space, const MatrixXd& white_columns) {
  const VectorXd before = white_columns.colwise().squaredNorm();
  const MatrixXd left = without(space.q, white_columns);
  MatrixXd fresh(left.rows(), left.cols());
  Index count = 0;
  for (Index j = 0; j < left.cols(); ++j) {
    VectorXd v = left.col(j);
    const auto taken = fresh.leftCols(count);
    for (int twice = 0; twice < 2 && count > 0; ++twice) v.noalias() -= taken * (taken.transpose() * v).eval();
    const double square = v.squaredNorm();
    if (square <= kAbsorbed * before(j) || square <= 0.0) continue;
    v /= std::sqrt(square);
    fresh.col(count++) = v;
    space.y -= v * v.dot(space.y);
  }
  if (count == 0) return;
  const Index had = space.q.cols();
  space.q.conservativeResize(space.y.size(), had + count);
  space.q.rightCols(count) = fresh.leftCols(count);
}

Search::Search(const Regressors& regressors, const Whitener& whitener, const MatrixXd& base, const VectorXd& residual,
               const std::vector<EffectInstance>& candidates, const std::vector<EffectInstance>& own,
               const std::atomic<bool>* cancelled)
    : regressors_(regressors), whitener_(whitener), cancelled_(cancelled) {
  base_.y = whitener(residual);
  base_.q.resize(base_.y.size(), 0);
  absorb(base_, whitener(base));
  const Observations& data = regressors.data();
  for (const Axis a : kAllAxes) {
    std::vector<double> p;
    for (std::size_t k = 0; k < data.size(); ++k)
      if (data.axis[k] == a) p.push_back(data.p_mm(k, a));
    targets_[index_of(a)] = distinct(std::move(p), 1e-4).size();
  }
  build_families(candidates);
  candidates_ = families_.size();
  build_families(own);
  build_bank();
  alone_ = best_alone();
}

void Search::build_families(const std::vector<EffectInstance>& candidates) {
  std::size_t scans = 0;
  for (const EffectInstance& effect : candidates) scans += effect.traits().periodic ? std::size_t{1} : std::size_t{0};
  const std::size_t most = kMostBankColumns / 2 / std::max<std::size_t>(scans, 1);
  for (const EffectInstance& effect : candidates) {
    Family family;
    family.effect = effect;
    family.acting = regressors_.acting(effect);
    if (family.acting.rows.size() < 2) continue;
    const EffectDefinition& definition = effect.definition();
    const TriedValues tried =
        tried_values(regressors_.data(), effect, family.acting, std::min<std::size_t>(most, kMostValues));
    family.grid = tried.values;
    family.facts = tried.facts;
    if (family.grid.empty() && family.facts.empty()) continue;
    const bool searched = !definition.searched_parameter().empty();
    family.search_cost = searched ? 2.0 * std::log(std::max(2.0, tried.independent)) : 0.0;
    family.fact_cost = searched ? 2.0 * std::log(1.0 + static_cast<double>(tried.facts.size())) : 0.0;
    if (definition.traits.periodic) family.shortest_seen = 2.0 * mean_step(regressors_.data(), family);
    family.ln_readings = std::log(std::max(8.0, static_cast<double>(family.acting.rows.size())));
    if (effect.is_user())
      family.search_cost = static_cast<double>(nonlinear_user_parameters(effect, regressors_.data())) *
                           (family.ln_readings + 2.0 * std::log(kUserTrials));
    family.least = definition.least_coefficient;
    family.greatest = definition.greatest_coefficient;
    if (definition.place == Place::map) {
      const Columns columns = regressors_.columns(effect, family.grid.front(), family.acting);
      if (columns.fixed.squaredNorm() + columns.of.squaredNorm() <= 0.0) continue;
    }
    families_.push_back(std::move(family));
  }
}

double Search::cost_of(const Family& family, double nonlinear, std::size_t linear) const {
  double cost = family.ln_readings * static_cast<double>(linear);
  if (family.effect.is_user()) return cost + family.search_cost;
  if (family.grid.size() + family.facts.size() <= 1) return cost;
  if (nonlinear < family.shortest_seen) cost += kUnseenPeriod;
  bool fact = false;
  for (const double value : family.facts) fact = fact || std::abs(nonlinear - value) < 5e-3 * value;
  return cost + (fact ? std::min(family.fact_cost, family.search_cost) : family.search_cost);
}

Choice Search::completed(Choice choice, std::size_t f, double nonlinear) const {
  const Family& family = families_[f];
  choice.family = f;
  choice.nonlinear = nonlinear;
  if (family.grid.size() + family.facts.size() > 1) ++choice.parameters;
  return choice;
}

Choice Search::choice_at(const Space& space, std::size_t f, double nonlinear) const {
  if (has_places(f)) return choice_in(view_of(space, f), f, nonlinear);
  const Family& family = families_[f];
  const Columns columns = regressors_.columns(family.effect, nonlinear, family.acting);
  const auto cost = [&](std::size_t linear) { return cost_of(family, nonlinear, linear); };
  Choice choice;
  if (columns.fixed.size() > 0) {
    const VectorXd white = whitener_(columns.fixed);
    const VectorXd left = without(space.q, white);
    choice.gain =
        left.squaredNorm() <= kAbsorbed * white.squaredNorm() ? -1.0 : 2.0 * left.dot(space.y) - left.squaredNorm();
    choice.cost = cost(0);
  } else {
    const MatrixXd white = whitener_(columns.of);
    const VectorXd original = white.colwise().squaredNorm();
    const MatrixXd left = without(space.q, white);
    choice = best_choice(family, banks_[f].variants, left.transpose() * left, left.transpose() * space.y, original,
                         kAbsorbed, cost);
  }
  return completed(choice, f, nonlinear);
}

Choice Search::refined_choice(const Space& space, std::size_t f, double nonlinear) const {
  const Family& family = families_[f];
  const EffectDefinition& definition = family.effect.definition();
  const bool places = has_places(f);
  const View view = places ? view_of(space, f) : View{};
  const auto exactly = [&](double v) { return places ? choice_in(view, f, v) : choice_at(space, f, v); };
  Choice best = exactly(nonlinear);
  if (definition.searched_parameter().empty() || family.grid.size() + family.facts.size() <= 1 ||
      !definition.search.has_slope)
    return best;
  // periods are searched in frequency
  const bool inverse = family.effect.traits().periodic;
  const auto to = [&](double v) { return inverse ? 1.0 / v : v; };
  const double centre = to(nonlinear);
  double low = -std::numeric_limits<double>::max(), high = std::numeric_limits<double>::max();
  if (definition.search.limits != nullptr) {
    const ValueRange range = definition.search.limits(regressors_.data(), family.effect, family.acting, nonlinear);
    std::tie(low, high) = std::minmax({to(range.least), to(range.greatest)});
  }
  if (!inverse) {  // neighbours on the grid bound the search
    double width = kBeyondAll;
    for (const double value : family.grid)
      if (value != nonlinear) width = std::min(width, std::abs(value - nonlinear));
    low = std::max(low, centre - kBeyondNeighbour * width);
    high = std::min(high, centre + kBeyondNeighbour * width);
  }
  const auto at = [&](double v) { return exactly(to(v)); };
  constexpr double kGolden = 0.6180339887498949;
  double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
  Choice at_a = at(a), at_b = at(b);
  for (int i = 0; i < 14; ++i) {
    if (at_a.gain > at_b.gain) {
      high = b;
      b = a;
      at_b = at_a;
      a = high - kGolden * (high - low);
      at_a = at(a);
    } else {
      low = a;
      a = b;
      at_a = at_b;
      b = low + kGolden * (high - low);
      at_b = at(b);
    }
    for (const Choice* c : {&at_a, &at_b})
      if (c->score() > best.score()) best = *c;
  }
  if (at_limit(f, best.nonlinear)) best.gain = 0.0;
  return best;
}

bool Search::at_limit(std::size_t f, double nonlinear) const {
  const Family& family = families_[f];
  const EffectDefinition& definition = family.effect.definition();
  if (definition.search.limits == nullptr || family.grid.size() + family.facts.size() <= 1) return false;
  const ValueRange range = definition.search.limits(regressors_.data(), family.effect, family.acting, kBeyondAll);
  const auto is_another = [&](Limit limit) {
    return std::any_of(definition.turns_into.begin(), definition.turns_into.end(),
                       [&](const Becomes& becomes) { return becomes.limit == limit; });
  };
  return (nonlinear > (1.0 - kAtLimit) * range.greatest && is_another(Limit::at_greatest)) ||
         (nonlinear < (1.0 + kAtLimit) * range.least && is_another(Limit::at_least));
}

Columns Search::columns_of(const Choice& choice) const {
  const Family& family = families_[choice.family];
  Columns all = regressors_.columns(family.effect, choice.nonlinear, family.acting);
  if (all.fixed.size() > 0) return all;
  Columns chosen;
  chosen.of.resize(all.of.rows(), static_cast<Index>(choice.columns.size()));
  for (std::size_t j = 0; j < choice.columns.size(); ++j)
    chosen.of.col(static_cast<Index>(j)) = all.of.col(choice.columns[j]);
  return chosen;
}

Solution Search::solution(const std::vector<Choice>& chosen, const std::vector<Choice>& own) const {
  Solution solution;
  solution.chosen = chosen;
  solution.own = own;
  solution.space = base_;
  for (const Choice& choice : own) absorb(solution.space, whitener_(columns_of(choice).of));
  solution.chi2_before = own.empty() ? base_.chi2() : alone_.space.chi2();
  for (Choice& choice : solution.chosen) {
    const Columns columns = columns_of(choice);
    const double before = solution.space.chi2();
    if (columns.fixed.size() > 0) {
      const VectorXd white = whitener_(columns.fixed);
      solution.space.y -= without(solution.space.q, white);
    } else {
      absorb(solution.space, whitener_(columns.of));
    }
    choice.gain = before - solution.space.chi2();
    solution.cost += choice.cost;
  }
  return solution;
}

Choice Search::best_own(const Space& space, std::size_t f) const {
  const std::vector<Choice> peaks = peaks_of(space, f);
  const Family& family = families_[f];
  Choice best;
  best.family = f;
  best.nonlinear = family.grid.empty() ? family.facts.front() : family.grid.front();
  if (!peaks.empty())
    best =
        family.effect.traits().periodic ? best_period(space, peaks) : refined_choice(space, f, peaks.front().nonlinear);
  best.columns.resize(family.effect.definition().column_count());
  std::iota(best.columns.begin(), best.columns.end(), Index{0});
  return best;
}

Solution Search::best_alone() const {
  std::vector<Choice> own;
  for (std::size_t f = candidates_; f < families_.size(); ++f) own.push_back(best_own(solution({}, own).space, f));
  Solution best = own.size() > 1 ? refined({}, own) : solution({}, own);
  best.chi2_before = best.space.chi2();
  return best;
}

namespace {

std::vector<Choice> with_one(std::vector<Choice> choices, std::size_t i, const Choice& one) {
  choices[i] = one;
  return choices;
}
std::vector<Choice> without_one(std::vector<Choice> choices, std::size_t i) {
  choices.erase(choices.begin() + static_cast<std::ptrdiff_t>(i));
  return choices;
}

}  // namespace

Solution Search::refined(const std::vector<Choice>& chosen, const std::vector<Choice>& own) const {
  Solution best = solution(chosen, own);
  const bool movable = std::any_of(chosen.begin(), chosen.end(), [&](const Choice& c) {
    const EffectDefinition& definition = families_[c.family].effect.definition();
    return definition.traits.is_curve || !definition.searched_parameter().empty();
  });
  const auto take = [&](Solution tried) {
    if (tried.score() > best.score()) best = std::move(tried);
  };
  if (own.empty() && (chosen.size() < 2 || !movable)) return best;
  for (int round = 0; round < 3; ++round) {
    const double before = best.score();
    for (std::size_t i = 0; i < own.size(); ++i) {
      const Solution rest = solution(best.chosen, without_one(best.own, i));
      take(solution(best.chosen, with_one(best.own, i, best_own(rest.space, best.own[i].family))));
    }
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      const Solution rest = solution(without_one(best.chosen, i), best.own);
      const std::size_t f = best.chosen[i].family;
      const std::vector<Choice> peaks =
          round == 0 && families_[f].effect.traits().periodic ? peaks_of(rest.space, f) : std::vector<Choice>{};
      const Choice again =
          peaks.empty() ? refined_choice(rest.space, f, best.chosen[i].nonlinear) : best_period(rest.space, peaks);
      if (again.gain > 0.0) take(solution(with_one(best.chosen, i, again), best.own));
    }
    if (best.score() - before < 0.5) break;
  }
  return best;
}

EffectInstance effect_of(EffectInstance effect, const Choice& choice) {
  const EffectDefinition& definition = effect.definition();
  if (const std::string searched(definition.searched_parameter()); !searched.empty())
    effect.fitted[searched] = choice.nonlinear;
  if (definition.column_sets.empty()) return effect;
  for (std::size_t j = 0; j < definition.column_count(); ++j)
    if (std::find(choice.columns.begin(), choice.columns.end(), static_cast<Index>(j)) == choice.columns.end())
      effect.parameters[parameter_of_coefficient(definition, j)] = 0.0;
  return effect;
}

}  // namespace ecs::model
