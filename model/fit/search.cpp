#include "model/fit/search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "base/linear/decompositions.hpp"
#include "model/effects/definition.hpp"
#include "model/effects/quantities.hpp"
#include "model/fit/core.hpp"
#include "model/fit/statistics.hpp"

namespace ecs::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Price of a period that the targets cannot follow and no fact of the machine speaks for: it takes on any slower
/// shape. Beyond, all octaves are as likely as one another beforehand (Jeffreys 1946).
constexpr double kUnseenPeriod = 8.0;
/// A period is a pitch of the machine to a percent, as a fit on a short travel knows it, and if they part by less than
/// a quarter of a turn over the travel: beyond that a wave of the pitch no longer follows it.
constexpr double kSamePeriod = 0.01, kMostSlip = 0.25;
/// Different values of a user's parameter that fit a data set by chance.
constexpr double kUserTrials = 12.0;
/// A refinement goes so far beyond the neighbours on the grid, in distances to the nearer one.
constexpr double kBeyondNeighbour = 1.2;
/// A value this close to a limit, as a share of it, is at the limit: a refinement ends within a thousandth.
constexpr double kAtLimit = 0.005;
/// A refinement ends at this share of its range: a peak is missed by the square of it, 1e-10 of its height, which no
/// answer shows.
constexpr double kRefined = 1e-5;
constexpr std::size_t kMostKept = 256;  ///< values of families beside the base
/// Of all families; half of them for scans of periods, which end at a longer period where they are more. A choice, for
/// the time: 27 scans of three metres at 24 targets reach the shortest.
constexpr std::size_t kMostBankColumns = 20'000;
constexpr std::size_t kMostValues = 1500;  ///< of one searched parameter

/// Takes off columns what a basis spans; twice where less than half of a square is left, which is enough for all digits
/// (Daniel, Gragg, Kaufman and Stewart 1976; Parlett 1980, 6.9).
template <class Basis, class Columns>
void take_off(const Basis& q, Columns& columns) {
  constexpr double kHalf = 0.5;
  if (q.cols() == 0) return;
  const Eigen::RowVectorXd before = columns.colwise().squaredNorm();
  columns.noalias() -= q * (q.transpose() * columns).eval();
  if ((columns.colwise().squaredNorm().array() < kHalf * before.array()).any())
    columns.noalias() -= q * (q.transpose() * columns).eval();
}

/// What is left of columns beside a basis.
template <class Basis>
MatrixXd left_beside_basis(const Basis& q, MatrixXd columns) {
  take_off(q, columns);
  return columns;
}

/// Adds columns to what is absorbed of which that is taken off. @param before  their squares before it was
/// @param had  columns of `space.q` that are in use; there is room for more. Returns how many are then.
Index absorb_left(Space& space, Index had, const MatrixXd& left, const VectorXd& before) {
  Index used = had;
  for (Index j = 0; j < left.cols(); ++j) {
    auto v = space.q.col(used);
    v = left.col(j);
    take_off(space.q.middleCols(had, used - had), v);
    const double square = v.squaredNorm();
    if (square <= kAbsorbed * before(j) || square <= 0.0) continue;
    v /= std::sqrt(square);
    space.y -= v * v.dot(space.y);
    ++used;
  }
  return used;
}

bool same_value(const Choice& one, const Choice& other) {
  return one.family == other.family && one.nonlinear == other.nonlinear && one.columns == other.columns;
}
bool same_values(const std::vector<Choice>& a, const std::vector<Choice>& b) {
  return std::ranges::equal(a, b, same_value);
}

/// Seeks the greatest value of `f` in a range, to `tolerance`, from a start inside where it is known: parabolas through
/// the best three points, golden sections where they do not serve (Brent 1973, 5.8).
template <class Function>
void seek_maximum(ValueRange range, double start, double f_start, double tolerance, const Function& f) {
  constexpr double kSection = 0.3819660112501051;  // 1 - golden ratio
  constexpr int kMostSteps = 24;
  double low = range.least, high = range.greatest;
  double best = start, second = start, third = start;
  double f_best = f_start, f_second = f_best, f_third = f_best;
  double step = 0.0, step_before = 0.0;
  for (int i = 0; i < kMostSteps; ++i) {
    const double middle = 0.5 * (low + high);
    if (std::abs(best - middle) <= 2.0 * tolerance - 0.5 * (high - low)) return;
    const double r = (best - second) * (f_best - f_third);
    double q = (best - third) * (f_best - f_second);
    double p = (best - third) * q - (best - second) * r;
    q = 2.0 * (q - r);
    if (q > 0.0) p = -p;
    q = std::abs(q);
    const bool parabola =
        std::abs(p) < std::abs(0.5 * q * step_before) && p > q * (low - best) && p < q * (high - best);
    step_before = step;
    if (parabola) {
      step = p / q;
      if (best + step - low < 2.0 * tolerance || high - best - step < 2.0 * tolerance)
        step = best < middle ? tolerance : -tolerance;
    } else {
      step_before = (best < middle ? high : low) - best;
      step = kSection * step_before;
    }
    const double next = best + (std::abs(step) >= tolerance ? step : std::copysign(tolerance, step));
    const double f_next = f(next);
    if (f_next >= f_best) {
      (next < best ? high : low) = best;
      third = std::exchange(second, std::exchange(best, next));
      f_third = std::exchange(f_second, std::exchange(f_best, f_next));
      continue;
    }
    (next < best ? low : high) = next;
    if (f_next >= f_second || second == best) {
      third = std::exchange(second, next);
      f_third = std::exchange(f_second, f_next);
    } else if (f_next >= f_third || third == best || third == second) {
      third = next;
      f_third = f_next;
    }
  }
}

double mean_step(const Observations& data, const Family& family) {
  std::vector<double> p;
  for (const std::size_t k : family.acting.rows) p.push_back(data.p_mm(k, *family.effect.axis));
  p = distinct(std::move(p), 1e-6);
  return p.size() < 2 ? 0.0 : (p.back() - p.front()) / static_cast<double>(p.size() - 1);
}

}  // namespace

void absorb(Space& space, const MatrixXd& white_columns) {
  const MatrixXd left = left_beside_basis(space.q, white_columns);
  const Index had = space.q.cols();
  space.q.conservativeResize(space.y.size(), had + left.cols());
  const Index used = absorb_left(space, had, left, white_columns.colwise().squaredNorm());
  space.q.conservativeResize(Eigen::NoChange, used);
}

Space added_by(const Space& space, const MatrixXd& white_columns) {
  Space added{MatrixXd(space.y.size(), white_columns.cols()), space.y};
  const Index used =
      absorb_left(added, 0, left_beside_basis(space.q, white_columns), white_columns.colwise().squaredNorm());
  added.q.conservativeResize(Eigen::NoChange, used);
  return added;
}

Search::Search(const Regressors& regressors, const Whitener& whitener, const MatrixXd& base, const VectorXd& residual,
               const std::vector<EffectInstance>& candidates, const std::vector<EffectInstance>& own,
               const std::atomic<bool>* cancelled)
    : regressors_(regressors), whitener_(whitener), cancelled_(cancelled) {
  base_.y = whitener(residual);
  base_.q.resize(base_.y.size(), 0);
  absorb(base_, whitener(base));
  const Observations& data = regressors.motions();
  for (const Axis a : kAllAxes) {
    std::vector<double> p;
    for (std::size_t k = 0; k < data.size(); ++k)
      if (data.axis[k] == a) p.push_back(data.p_mm(k, a));
    targets_[index_of(a)] = distinct(std::move(p), 1e-4).size();
  }
  build_families(candidates, false);
  candidates_ = families_.size();
  build_families(own, true);
  build_bank();
  alone_ = best_alone();
}

void Search::build_families(const std::vector<EffectInstance>& candidates, bool of_model) {
  std::size_t scans = 0;
  for (const EffectInstance& effect : candidates) scans += effect.traits().periodic ? std::size_t{1} : std::size_t{0};
  const std::size_t most = std::min(kMostValues, kMostBankColumns / 2 / std::max<std::size_t>(scans, 1));
  for (const EffectInstance& effect : candidates) {
    Family family;
    family.effect = effect;
    family.acting = regressors_.acting(effect);
    if (family.acting.readings.size() < 2) continue;
    const EffectDefinition& definition = effect.definition();
    const TriedValues tried = tried_values(regressors_.motions(), effect, family.acting, {most, of_model});
    family.grid = tried.values;
    family.facts = tried.facts;
    family.far = tried.far;
    if (family.grid.empty() && family.facts.empty()) continue;
    const bool searched = is_searched(effect);
    family.search_cost = searched ? 2.0 * std::log(std::max(2.0, tried.independent)) : 0.0;
    family.fact_cost = searched ? 2.0 * std::log(1.0 + static_cast<double>(tried.facts.size())) : 0.0;
    if (const std::size_t shapes = definition.column_sets.size(); shapes > 1 && !definition.traits.periodic)
      family.shape_cost = 2.0 * std::log(static_cast<double>(shapes));
    if (definition.traits.periodic) {
      family.shortest_seen = 2.0 * mean_step(regressors_.motions(), family);
      const auto [first, last] = acting_range(regressors_.motions(), family.acting, *effect.axis);
      family.travel = last - first;
    }
    family.ln_readings = std::log(std::max(8.0, static_cast<double>(family.acting.readings.size())));
    if (effect.is_user())
      family.search_cost = static_cast<double>(nonlinear_user_parameters(effect, regressors_.motions()).size()) *
                           (family.ln_readings + 2.0 * std::log(kUserTrials));
    family.lever_varies = regressors_.lever_varies(effect);
    if (definition.column_count() == 1) family.range = definition.coefficient_range(0);
    if (definition.place == Place::map || regressors_.data().moved) {
      const Columns columns =
          regressors_.columns(effect, family.grid.empty() ? family.facts.front() : family.grid.front(), family.acting);
      if (columns.fixed.squaredNorm() + columns.of.squaredNorm() <= 0.0) continue;
    }
    families_.push_back(std::move(family));
  }
}

bool is_in_step(const Family& family, double fact, double period) {
  return std::abs(period / fact - 1.0) < kSamePeriod && std::abs(1.0 / period - 1.0 / fact) * family.travel < kMostSlip;
}

bool is_fact(const Family& family, double period) {
  return std::ranges::any_of(family.facts, [&](double fact) { return is_in_step(family, fact, period); });
}

Price Search::price_of(const Family& family, double nonlinear) const {
  if (family.effect.is_user()) return {family.ln_readings, family.search_cost};
  if (family.grid.size() + family.facts.size() <= 1) return {family.ln_readings, family.shape_cost};
  const bool fact = is_fact(family, nonlinear);
  double chosen = fact ? std::min(family.fact_cost, family.search_cost) : family.search_cost;
  if (family.shortest_seen > 0.0 && nonlinear < family.shortest_seen)
    chosen += (fact ? 0.0 : kUnseenPeriod) + 2.0 * std::log(family.shortest_seen / nonlinear);
  return {family.ln_readings, chosen + family.shape_cost};
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
  const BesideBase& of = beside_base(f, nonlinear);
  const MatrixXd left = left_beside(space, space.q.cols(), of.columns);
  Choice choice;
  if (family.effect.traits().fixed_size) {
    const double square = left.squaredNorm();
    choice.gain = square <= kAbsorbed * of.squares(0) ? -1.0 : 2.0 * left.col(0).dot(space.y) - square;
    choice.cost = price_of(family, nonlinear).of(0);
  } else {
    const auto& variants = banks_[f].variants;
    choice = choice_of(best_gain(family, variants, left.transpose() * left, left.transpose() * space.y, of.squares,
                                 kExact, price_of(family, nonlinear)),
                       variants);
  }
  return completed(choice, f, nonlinear);
}

Choice Search::refined_choice(const Space& space, std::size_t f, double nonlinear) const {
  const EffectDefinition& definition = families_[f].effect.definition();
  if (definition.searched_parameter().empty() || families_[f].grid.size() + families_[f].facts.size() <= 1 ||
      !definition.search.has_slope)
    return choice_at(space, f, nonlinear);
  std::map<double, Choice>& kept = answers_in(view_of(space, f), f).refined;
  const auto [at, is_new] = kept.try_emplace(nonlinear);
  if (is_new) at->second = sought_nearby(space, f, nonlinear);
  return at->second;
}

Choice Search::sought_nearby(const Space& space, std::size_t f, double nonlinear) const {
  const Family& family = families_[f];
  const EffectDefinition& definition = family.effect.definition();
  const bool places = has_places(f);
  const View* view = places ? &view_of(space, f) : nullptr;
  const auto exactly = [&](double v) { return places ? choice_in(*view, f, v) : choice_at(space, f, v); };
  Choice best = exactly(nonlinear);
  // periods are searched in frequency
  const bool inverse = family.effect.traits().periodic;
  const auto to = [&](double v) { return inverse ? 1.0 / v : v; };
  const double centre = to(nonlinear);
  double low = -std::numeric_limits<double>::max(), high = std::numeric_limits<double>::max();
  if (definition.search.limits != nullptr) {
    const ValueRange range = definition.search.limits(regressors_.motions(), family.effect, family.acting, nonlinear);
    std::tie(low, high) = std::minmax({to(range.least), to(range.greatest)});
  }
  const bool is_beyond_grid =
      inverse && std::ranges::all_of(family.grid, [&](double value) { return nonlinear < value; });
  if (is_beyond_grid) {  // at even targets the pitch alone is known there: any other period looks like a slower one
    low = std::max(low, centre - kMostSlip / family.travel);
    high = std::min(high, centre + kMostSlip / family.travel);
  }
  if (!inverse) {  // neighbours on the grid bound the search
    double width = kBeyondAll;
    for (const double value : family.grid)
      if (value != nonlinear) width = std::min(width, std::abs(value - nonlinear));
    low = std::max(low, centre - kBeyondNeighbour * width);
    high = std::min(high, centre + kBeyondNeighbour * width);
  }
  const auto gain_at = [&](double v) {
    const Choice choice = exactly(to(v));
    if (choice.score() > best.score()) best = choice;
    return choice.gain;
  };
  if (low < high) {
    const double start = std::clamp(centre, low, high);
    seek_maximum({low, high}, start, start == centre ? best.gain : gain_at(start), kRefined * (high - low), gain_at);
  }
  if (at_limit(f, best.nonlinear)) best.gain = 0.0;
  return best;
}

bool Search::at_limit(std::size_t f, double nonlinear) const {
  const Family& family = families_[f];
  const EffectDefinition& definition = family.effect.definition();
  if (definition.search.limits == nullptr || family.grid.size() + family.facts.size() <= 1) return false;
  const ValueRange range = definition.search.limits(regressors_.motions(), family.effect, family.acting, kBeyondAll);
  const auto is_another = [&](Limit limit) {
    return std::ranges::any_of(definition.turns_into, [&](const Becomes& becomes) { return becomes.limit == limit; });
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

const Search::BesideBase& Search::beside_base(std::size_t f, double nonlinear) const {
  if (beside_base_.size() >= kMostKept) beside_base_.clear();
  const auto [at, is_new] = beside_base_.try_emplace({f, nonlinear});
  if (is_new) {
    const Columns columns = regressors_.columns(families_[f].effect, nonlinear, families_[f].acting);
    const MatrixXd white = whitener_(columns.fixed.size() > 0 ? MatrixXd(columns.fixed) : columns.of);
    at->second = {left_beside_basis(base_.q, white), white.colwise().squaredNorm()};
  }
  return at->second;
}

MatrixXd Search::left_beside(const Space& space, Index used, MatrixXd columns) const {
  return left_beside_basis(space.q.middleCols(base_.q.cols(), used - base_.q.cols()), std::move(columns));
}

Index Search::absorb_choice(Space& space, Index used, const Choice& choice) const {
  const BesideBase& of = beside_base(choice.family, choice.nonlinear);
  return absorb_left(space, used, left_beside(space, used, of.columns(Eigen::all, choice.columns)),
                     of.squares(choice.columns));
}

Solution Search::solution(const std::vector<Choice>& chosen, const std::vector<Choice>& own) const {
  Solution solution;
  solution.chosen = chosen;
  solution.own = own;
  const bool is_known = !own.empty() && same_values(own, alone_.own);
  const Space& start = is_known ? alone_.space : base_;
  Space& space = solution.space;
  Index used = start.q.cols(), most = used;
  for (const std::vector<Choice>* choices : {&chosen, &own})
    for (const Choice& choice : *choices) most += static_cast<Index>(choice.columns.size());
  space.q.resize(start.y.size(), most);
  space.q.leftCols(used) = start.q;
  space.y = start.y;
  if (!is_known)
    for (const Choice& choice : own) used = absorb_choice(space, used, choice);
  solution.chi2_before = own.empty() ? base_.chi2() : alone_.space.chi2();
  for (Choice& choice : solution.chosen) {
    const double before = space.chi2();
    const Index had = used;
    if (families_[choice.family].effect.traits().fixed_size) {
      space.y -= left_beside(space, used, beside_base(choice.family, choice.nonlinear).columns).col(0);
    } else {
      used = absorb_choice(space, used, choice);
    }
    choice.gain = before - space.chi2();
    if (families_[choice.family].effect.traits().is_curve) {  // functions that another curve has too are paid for once
      choice.parameters = static_cast<std::size_t>(used - had);
      choice.cost = price_of(families_[choice.family], choice.nonlinear).of(choice.parameters);
    }
    solution.cost += choice.cost;
  }
  space.q.conservativeResize(Eigen::NoChange, used);
  return solution;
}

double Search::hidden_by_sensor(const Space& space, const Choice& choice) const {
  const VectorXd unknown = regressors_.unknown(families_[choice.family].effect, choice.nonlinear);
  if (unknown.isZero(0.0)) return 0.0;
  const double known =
      left_beside(space, space.q.cols(), beside_base(choice.family, choice.nonlinear).columns).squaredNorm();
  return known > 0.0 ? choice.gain * whitener_(unknown).squaredNorm() / known : 0.0;
}

bool Search::in_ranges(const std::vector<Choice>& chosen) const {
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (!families_[chosen[i].family].range || chosen.size() < 2) continue;  // alone it was tried before
    std::vector<Choice> others = chosen;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    if (choice_at(solution(others).space, chosen[i].family, chosen[i].nonlinear).gain <= 0.0) return false;
  }
  return true;
}

Choice Search::best_own(const Space& space, std::size_t f, bool far) const {
  if (const auto& kept = answers_in(view_of(space, f), f).own[far ? 1 : 0]) return *kept;
  Choice own = sought_own(space, f, far);
  answers_in(view_of(space, f), f).own[far ? 1 : 0] = own;
  return own;
}

Choice Search::sought_own(const Space& space, std::size_t f, bool far) const {
  const Family& family = families_[f];
  const bool only_near = !far && family.far;
  std::vector<Choice> peaks = peaks_of(space, f, kAllPeaks);
  if (only_near) std::erase_if(peaks, [&](const Choice& peak) { return peak.nonlinear < *family.far; });
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

Solution Search::alone_with(bool far) const {
  std::vector<Choice> own;
  for (std::size_t f = candidates_; f < families_.size(); ++f) own.push_back(best_own(solution({}, own).space, f, far));
  Solution best = own.size() > 1 ? refined({}, own, far) : solution({}, own);
  best.chi2_before = best.space.chi2();
  return best;
}

Solution Search::best_alone() const {
  Solution usual = alone_with(false);
  const double freedom = static_cast<double>(usual.space.y.size() - usual.space.q.cols());
  if (is_no_more_than_noise(usual.space.chi2(), freedom)) return usual;
  // what is hidden must not be taken for a wave: only one that leaves nothing but noise
  Solution far = alone_with(true);
  return is_no_more_than_noise(far.space.chi2(), freedom) ? far : usual;
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

Choice Search::best_value(const Space& space, const Choice& now, bool all_periods) const {
  const Family& family = families_[now.family];
  if (family.effect.traits().periodic) {
    const std::vector<Choice> peaks = all_periods ? peaks_of(space, now.family, kMostPeaks) : std::vector<Choice>{};
    return best_period(space, peaks.empty() ? std::vector{now} : peaks);
  }
  Choice best = refined_choice(space, now.family, now.nonlinear);
  if (family.grid.size() < 2) return best;
  const std::vector<Choice> peaks = peaks_of(space, now.family, 1);
  if (peaks.empty() || peaks.front().nonlinear == now.nonlinear) return best;
  const Choice other = refined_choice(space, now.family, peaks.front().nonlinear);
  return other.score() > best.score() ? other : best;
}

Solution Search::refined(const std::vector<Choice>& chosen, const std::vector<Choice>& own, bool far) const {
  Solution best = solution(chosen, own);
  const bool movable = std::ranges::any_of(chosen, [&](const Choice& c) {
    const EffectInstance& effect = families_[c.family].effect;
    return effect.traits().is_curve || is_searched(effect);
  });
  const auto take = [&](Solution tried) {
    if (tried.score() > best.score()) best = std::move(tried);
  };
  if (own.empty() && (chosen.size() < 2 || !movable)) return best;
  for (int round = 0; round < 3; ++round) {
    const double before = best.score();
    for (std::size_t i = 0; i < own.size(); ++i) {
      const Solution rest = solution(best.chosen, without_one(best.own, i));
      const Choice again = best_own(rest.space, best.own[i].family, far);
      if (!same_value(again, best.own[i])) take(solution(best.chosen, with_one(best.own, i, again)));
    }
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      const Solution rest = solution(without_one(best.chosen, i), best.own);
      const Choice again = best_value(rest.space, best.chosen[i], round == 0 && i + 1 < chosen.size());
      // beside other values fewer of its columns may be free, for a lower price
      const bool is_same = same_value(again, best.chosen[i]) && again.cost == best.chosen[i].cost;
      if (again.gain > 0.0 && !is_same) take(solution(with_one(best.chosen, i, again), best.own));
    }
    if (best.score() - before < 0.5) break;
  }
  return best;
}

namespace {

/// Of the sizes that a choice does without.
std::vector<std::string> unused_sizes(const EffectDefinition& definition, const Choice& choice) {
  std::vector<std::string> names;
  if (definition.column_sets.empty()) return names;
  for (std::size_t j = 0; j < definition.column_count(); ++j)
    if (std::ranges::find(choice.columns, static_cast<Index>(j)) == choice.columns.end())
      names.emplace_back(parameter_of_coefficient(definition, j));
  return names;
}

}  // namespace

EffectInstance effect_of(EffectInstance effect, const Choice& choice) {
  const EffectDefinition& definition = effect.definition();
  if (const std::string searched(definition.searched_parameter()); !searched.empty())
    effect.fitted[searched] = choice.nonlinear;
  for (const std::string& name : unused_sizes(definition, choice)) effect.parameters[name] = 0.0;
  return effect;
}

EffectInstance with_all_sizes(EffectInstance effect, const Choice& choice) {
  for (const std::string& name : unused_sizes(effect.definition(), choice)) effect.parameters.erase(name);
  return effect;
}

}  // namespace ecs::model
