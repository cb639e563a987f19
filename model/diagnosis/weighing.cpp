// Effects found are weighed by readings that they were not fitted to, and against a wander, a run and a lag.
#include "model/diagnosis/weighing.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <map>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/linear/decompositions.hpp"
#include "model/data/curve_basis.hpp"
#include "model/diagnosis/e_value.hpp"
#include "model/diagnosis/single_targets.hpp"
#include "model/effects/definition.hpp"
#include "model/effects/quantities.hpp"
#include "model/fit/noise.hpp"
#include "model/fit/statistics.hpp"

namespace ecs::model {

using Eigen::MatrixXd;

LinearProblem joined(const Base& base, const Search& search, const Solution& solution) {
  LinearProblem all{base.columns, base.target};
  for (const std::vector<Choice>* choices : {&solution.own, &solution.chosen})
    for (const Choice& choice : *choices) {
      const Columns columns = search.columns_of(choice);
      if (columns.fixed.size() > 0) all.target -= columns.fixed;
      all.columns = beside(std::move(all.columns), columns.of);
    }
  return all;
}

std::vector<Choice> others(std::vector<Choice> chosen, std::size_t i) {
  chosen.erase(chosen.begin() + static_cast<std::ptrdiff_t>(i));
  return chosen;
}

double freedom_beside(const Space& space, const std::vector<bool>& left_out) {
  return static_cast<double>(std::ranges::count(left_out, false)) - static_cast<double>(space.q.cols());
}

namespace {

/// Groups of the effects found, and the effects at their members; again where a member has become another effect or
/// another wave, for what the others explain beside it is then another amount.
void settle_groups(const Search& search, Found& found) {
  constexpr double kSamePeak = 0.01;
  constexpr int kRounds = 3;
  for (int round = 0; round < kRounds; ++round) {
    found.groups = groups_of(search, found.solution, found.entry_score);
    bool same = true;
    for (std::size_t i = 0; i < found.groups.size(); ++i) {
      same = same && found.solution.chosen[i].family == found.groups[i].member.family;
      found.solution.chosen[i] = found.groups[i].member;
    }
    found.solution = search.refined(found.solution.chosen, found.solution.own);
    const auto moved = [](const Choice& choice, const Group& group) {
      return std::abs(choice.nonlinear - group.member.nonlinear) > kSamePeak * std::abs(choice.nonlinear);
    };
    for (std::size_t i = 0; i < found.groups.size(); ++i) {
      const bool periodic = found.families[found.groups[i].member.family].effect.traits().periodic;
      same = same && !(periodic && moved(found.solution.chosen[i], found.groups[i]));
    }
    if (same) return;
  }
}

/// Evidence from which a lag is claimed: without one it is reached once in twenty data sets at most.
constexpr double kShowsLag = 20.0;

/// Whether readings that the effects were not fitted to show the lag of one, beside its temperature without a lag: as
/// it was read, and as smooth as the lag makes it, which takes noise of the sensor away too.
bool shows_lag(const Regressors& regressors, const Base& base, const Search& search, const Found& found,
               const Choice& late, const Solution& at_once) {
  const EffectInstance& effect = search.families()[late.family].effect;
  const LinearProblem without =
      joined(base, search, search.solution(others(at_once.chosen, at_once.chosen.size() - 1), at_once.own));
  return std::ranges::all_of(std::array{0.0, -late.nonlinear}, [&](double lag_s) {
    const MatrixXd columns = beside(without.columns, regressors.columns(effect, lag_s).of);
    return e_value_of({regressors, found.noise, found.left_out}, columns, without.target, effect,
                      NullHypothesis::noise_or_wander)
               .value_or(0.0) >= kShowsLag;
  });
}

bool is_noise(const Space& left, const Found& found) {
  return is_no_more_than_noise(left.chi2(), freedom_beside(left, found.left_out));
}

/// Whether a lag is the only one, nothing but noise is left with it, and much more without it: with the temperature as
/// it was read, and as smooth as the lag makes it. Several lags follow any wander.
bool is_needed(const Regressors& regressors, const Search& search, const Found& found, const Choice& late,
               const Solution& at_once) {
  const EffectInstance& effect = found.families[late.family].effect;
  const auto lags = std::ranges::count_if(found.solution.chosen, [&](const Choice& one) {
    return found.families[one.family].effect.traits().has_lag && is_searched(found.families[one.family].effect);
  });
  if (lags > 1 || found.solution.score() - at_once.score() < found.entry_score ||
      !is_noise(found.solution.space, found) || is_noise(at_once.space, found))
    return false;
  Space smooth = search.solution(others(at_once.chosen, at_once.chosen.size() - 1), at_once.own).space;
  absorb(smooth,
         Whitener(regressors.data(), found.noise, found.left_out)(regressors.columns(effect, -late.nonlinear).of));
  return !is_noise(smooth, found);
}

/// Effects that follow a sensor late, at once instead where the readings do not show the lag.
void drop_lags_not_shown(const Regressors& regressors, const Base& base, const Search& search, Found& found) {
  for (std::size_t i = 0; i < found.solution.chosen.size(); ++i) {
    const Choice late = found.solution.chosen[i];
    const EffectInstance& effect = found.families[late.family].effect;
    if (!effect.traits().has_lag || !is_searched(effect)) continue;
    const auto at_once = std::ranges::find_if(found.families, [&](const Family& other) {
      return same_candidate(other.effect, effect) && !is_searched(other.effect);
    });
    if (at_once == found.families.end()) continue;
    const Solution rest = search.solution(others(found.solution.chosen, i), found.solution.own);
    std::vector<Choice> chosen = rest.chosen;
    chosen.push_back(search.choice_at(rest.space, static_cast<std::size_t>(at_once - found.families.begin()), 0.0));
    Solution without_lag = search.refined(chosen, found.solution.own);
    if (is_needed(regressors, search, found, late, without_lag) ||
        shows_lag(regressors, base, search, found, late, without_lag))
      continue;
    found.solution = std::move(without_lag);
    return drop_lags_not_shown(regressors, base, search, found);  // one lag fewer
  }
}

}  // namespace

bool is_replaced_by_wander(const EffectInstance& effect, std::optional<double> e_value) {
  return is_like_wander(effect) && e_value.value_or(kSpeaksFor) < kSpeaksFor;
}

bool wanders_beside(const Observations& data, const NoiseModel& noise, const std::vector<bool>& left_out,
                    const LinearProblem& all, const std::optional<LinearProblem>& not_replaced) {
  return is_wandering(data, noise, left_out, all.columns, all.target) ||
         (not_replaced && wanders_by_pass(data, noise, left_out, not_replaced->columns, not_replaced->target));
}

void weigh(const Regressors& regressors, const Base& base, const Search& search, StepwiseOptions stepwise,
           Found& found) {
  const auto e_value_of_group = [&](std::size_t i, NullHypothesis null) {
    const LinearProblem without =
        joined(base, search, search.solution(others(found.solution.chosen, i), found.solution.own));
    return e_value_of({regressors, found.noise, found.left_out}, without.columns, without.target,
                      found.families[found.groups[i].member.family].effect, null);
  };
  for (;;) {
    drop_lags_not_shown(regressors, base, search, found);
    settle_groups(search, found);
    std::optional<std::size_t> worst;
    for (std::size_t i = 0; i < found.groups.size(); ++i) {
      std::optional<double>& e_value = found.groups[i].e_value;
      e_value = e_value_of_group(i, NullHypothesis::noise);
      if (e_value && *e_value < kSpeaksAgainst && (!worst || *e_value < *found.groups[*worst].e_value)) worst = i;
    }
    if (!worst) break;
    if (found.taken_back.empty()) found.taken_back = found.solution.chosen;
    found.solution = search.refined(others(found.solution.chosen, *worst), found.solution.own);
    // fewer each time: sets of the search may have more effects than it was allowed, and would return for ever
    stepwise.most_effects = std::min(found.solution.chosen.size(), std::max(stepwise.most_effects, std::size_t{1}) - 1);
    if (stepwise.most_effects == 0) continue;
    Solution best = best_solution(search, stepwise);
    if (best.score() > found.solution.score()) found.solution = std::move(best);
  }
  if (found.groups.empty()) return;
  const auto effect_of = [&](std::size_t i) -> const EffectInstance& {
    return found.families[found.groups[i].member.family].effect;
  };
  std::vector<Choice> shown;
  for (std::size_t i = 0; i < found.groups.size(); ++i) {
    std::optional<double>& e_value = found.groups[i].e_value;
    if (may_be_wander(found.noise, effect_of(i))) e_value = e_value_of_group(i, NullHypothesis::noise_or_wander);
    if (!is_replaced_by_wander(effect_of(i), e_value)) shown.push_back(found.solution.chosen[i]);
  }
  std::optional<LinearProblem> not_replaced;
  if (shown.size() < found.groups.size())
    not_replaced = joined(base, search, search.solution(shown, found.solution.own));
  found.wander_is_evident = wanders_beside(regressors.data(), found.noise, found.left_out,
                                           joined(base, search, found.solution), not_replaced);
  for (std::size_t i = 0; i < found.groups.size(); ++i) {
    std::optional<double>& e_value = found.groups[i].e_value;
    if (found.wander_is_evident && !may_be_wander(found.noise, effect_of(i)))
      e_value = e_value_of_group(i, NullHypothesis::noise_or_wander);
    if (e_value) *e_value /= static_cast<double>(found.candidates_tried);
  }
}

namespace {

/// Tests that a family is one of: every candidate, at every value tried, with every set of its columns.
double tests_of(const Family& family, std::size_t candidates) {
  const EffectDefinition& definition = family.effect.definition();
  const std::size_t sets = definition.traits.is_curve
                               ? definition.column_count()
                               : std::max(definition.column_sets.size(), definition.column_sets_elsewhere.size());
  return static_cast<double>(candidates) * static_cast<double>(family.grid.size() + family.facts.size()) *
         static_cast<double>(std::max<std::size_t>(sets, 1));
}

}  // namespace

void state_p_values(const Regressors& regressors, const Base& base, const Search& search, Found& found) {
  const auto p_value_beside = [&](const Solution& rest, const Group& group) {
    const Family& family = found.families[group.member.family];
    if (found.wander_is_evident || group.alias == Alias::wander || family.effect.is_user())
      return 1.0 / std::max(1.0, group.e_value.value_or(1.0));
    const std::vector<Choice> values = search.peaks_of(rest.space, group.member.family);
    if (values.empty()) return 1.0;
    const Columns columns = search.columns_of(values.front());
    const LinearProblem without = joined(base, search, rest);
    return p_value_of({regressors, found.noise, found.left_out}, without.columns, without.target,
                      columns.fixed.size() > 0 ? MatrixXd(columns.fixed) : columns.of,
                      tests_of(family, found.candidates_tried));
  };
  for (std::size_t i = 0; i < found.groups.size(); ++i) {
    Group& group = found.groups[i];
    group.p_value_alone = p_value_beside(search.alone(), group);
    group.p_value = found.groups.size() < 2
                        ? group.p_value_alone
                        : p_value_beside(search.solution(others(found.solution.chosen, i), found.solution.own), group);
  }
}

namespace {

/// Deviance of the readings without these of the effects found, under the likeliest wander, less that with them under
/// the likeliest noise, or wander where they leave little: either has the law that suits it, for repeats between which
/// an effect changes look correlated. What is set aside is in neither.
double better_than_wander(const Observations& data, const Base& base, const Search& search, const Found& found,
                          const std::vector<std::size_t>& set, const std::vector<std::size_t>& aside) {
  const std::vector<Choice>& chosen = found.solution.chosen;
  std::vector<Choice> without, with;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (std::ranges::count(aside, i)) continue;
    with.push_back(chosen[i]);
    if (!std::ranges::count(set, i)) without.push_back(chosen[i]);
  }
  const Solution rest = search.solution(without, found.solution.own);
  const bool leave_little =
      search.solution(with, found.solution.own).space.chi2() <= kMostBesideEffect * rest.space.chi2();
  LinearProblem null = joined(base, search, rest);
  const double wander = likely_wanders(data, found.noise, found.left_out, null.columns, null.target).front().deviance;
  MatrixXd effects(null.columns.rows(), 0);
  for (const std::size_t i : set) {
    const Columns columns = search.columns_of(chosen[i]);
    if (columns.fixed.size() > 0) null.target -= columns.fixed;
    effects = beside(std::move(effects), columns.of);
  }
  return wander - least_deviance(data, found.noise, found.left_out, independent_columns(null.columns, found.left_out),
                                 effects, null.target, leave_little);
}

/// Whether an effect predicts the course of runs that it was not fitted to, so often that a wander, which is another in
/// every run, does not. Levels of their own for the runs are taken off: they may wander from run to run.
bool predicts_runs(const Observations& data, const Base& base, const Search& search, const Found& found, std::size_t i,
                   double evidence) {
  const Columns own = search.columns_of(found.solution.chosen[i]);
  if (own.fixed.size() > 0 || own.of.cols() != 1) return false;
  const LinearProblem rest =
      joined(base, search, search.solution(others(found.solution.chosen, i), found.solution.own));
  const double chance = chance_of_predicted_runs(
      data, found.noise, found.left_out,
      independent_columns(beside(rest.columns, levels_of_runs(data)), found.left_out), own.of.col(0), rest.target);
  return -2.0 * std::log(chance) > evidence;
}

/// Effects are proved only if they are better than a wander, each, and without those that are not all together, by
/// evidence that is positive for having been chosen among all candidates that a wander may be taken for. A wander has
/// no price: whichever it is, it is no effect. That an effect of approach coincides with passes was planned, not
/// chosen: it pays for its coefficients only. What people set by hand may coincide with runs; it pays nothing. An
/// effect that is likelier than a wander, but not for having been chosen, is in doubt; one that is not likelier is
/// denied. So is a drift where readings enough show the noise; where they do not, of several drifts all but one pay for
/// having been chosen. None of this holds for an effect that predicts the course of runs that it was not fitted to: a
/// wander of one run knows nothing of another.
void hold_against_wander(const Observations& data, const Base& base, const Search& search, Found& found) {
  const std::vector<Choice>& chosen = found.solution.chosen;
  const auto effect_of = [&](std::size_t i) -> const EffectInstance& {
    return found.families[chosen[i].family].effect;
  };
  const auto among = std::ranges::count_if(std::span(found.families).first(found.candidates_tried),
                                           [&](const Family& f) { return may_be_wander(found.noise, f.effect); });
  const double evidence = 2.0 * std::log(kPositive * static_cast<double>(among));
  std::vector<std::size_t> aside;
  const auto hold = [&](const std::vector<std::size_t>& set) {
    double coefficients = 0.0, price = 0.0;
    for (const std::size_t i : set) {
      if (effect_of(i).definition().is_set_by_hand()) continue;
      coefficients += found.groups[i].member.cost;
      price += found.groups[i].member.cost + (effect_of(i).traits().of_approach ? 0.0 : evidence);
    }
    const double better = better_than_wander(data, base, search, found, set, aside);
    if (better > price) return;
    const auto drifts = std::ranges::count_if(set, [&](std::size_t i) { return is_like_wander(effect_of(i)); });
    const bool known_little = found.noise.pure.dof < kManyDegrees;
    const bool rivals = (drifts == 0 || known_little) &&
                        better > coefficients + evidence * std::max(0.0, static_cast<double>(drifts) - 1.0);
    std::vector<std::string> names;
    for (const std::size_t i : set) {
      if (rivals)
        found.groups[i].alias = Alias::wander;
      else
        found.groups[i].denied = true;
      names.push_back(to_text(effect_of(i)));
    }
    std::string& why = rivals ? found.doubt : found.objection;
    if (why.empty())
      why =
          fmt::format("a slow drift of the readings explains the same as {} {}: repeat the line, also in reverse order",
                      fmt::join(names, ", "), names.size() > 1 ? "do" : "does");
  };
  std::vector<std::size_t> together;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    if (!may_be_wander(found.noise, effect_of(i)) || predicts_runs(data, base, search, found, i, evidence)) continue;
    hold({i});
    if (!effect_of(i).definition().is_set_by_hand()) together.push_back(i);
  }
  for (const std::size_t i : together)
    if (found.groups[i].denied) aside.push_back(i);
  std::erase_if(together, [&](std::size_t i) { return found.groups[i].denied; });
  if (!together.empty() && together.size() + aside.size() > 1) hold(together);
}

/// Two or three effects are no causes where together they are not a hundred times better than one zero of a run, also
/// of two runs: a drift, a lost motion and its change along the axis are together nothing but that zero.
void deny_sets_of_a_run(const Observations& data, const Search& search, const Whitener& whitener, Found& found) {
  const std::vector<Choice>& chosen = found.solution.chosen;
  constexpr std::size_t kMostCompared = 10;
  for (std::uint32_t set = 0; set < 1U << std::min(chosen.size(), kMostCompared); ++set) {
    if (std::popcount(set) < 2 || std::popcount(set) > 3) continue;
    const auto is_in_set = [&](std::size_t i) { return i < kMostCompared && (set >> i & 1U) != 0; };
    std::vector<Choice> kept, together;
    for (std::size_t i = 0; i < chosen.size(); ++i) (is_in_set(i) ? together : kept).push_back(chosen[i]);
    const Solution rest = search.solution(kept, found.solution.own);
    const auto run = best_run_offset(data, whitener, rest.space, 2);
    const double score = found.solution.score() - rest.score();
    if (!run || std::ranges::any_of(together, [&](const Choice& one) {
          return run_beside(*run, found.families[one.family].effect, score) == RunBeside::worse;
        }))
      continue;
    for (std::size_t i = 0; i < chosen.size(); ++i) found.groups[i].denied = found.groups[i].denied || is_in_set(i);
    if (!found.bad_run || run->gain > found.bad_run->gain) found.bad_run = run;
  }
}

/// Waves are no cause where one target that is off explains as much as all of them do, as the end of a sentence; ""
/// where there are none, or they explain more.
std::string objection_by_target(const Observations& data, const Search& search, const Whitener& whitener,
                                const Found& found) {
  std::vector<Choice> kept;
  for (const Choice& one : found.solution.chosen)
    if (!found.families[one.family].effect.traits().periodic) kept.push_back(one);
  if (kept.size() == found.solution.chosen.size()) return "";
  const Solution rest = search.solution(kept, found.solution.own);
  const auto target = best_target_offset(data, whitener, rest.space);
  if (!target || target->score < found.solution.score() - rest.score()) return "";
  return fmt::format(
      "one target, at {:.6g} {}, that is off explains as much as the periodic errors do: check that place first",
      target->along, target->unit);
}

/// Whether a zero that drifts alike in every run, from its first reading on, explains as much as this effect does: on
/// the way back the later reading is the one nearer to the start, and a lost motion that grows along the travel looks
/// the same.
bool drifts_alike_in_runs(const Observations& data, const Whitener& whitener, const Space& rest,
                          const EffectInstance& effect, const Choice& member) {
  constexpr double kAsGood = 9.0;  // Δχ² of three standard deviations
  if (!effect.traits().is_curve || !effect.traits().of_approach || data.time_s.empty() || !data.paths.empty())
    return false;
  std::map<std::pair<int, int>, double> begins;  // by run and line
  MatrixXd since_start = MatrixXd::Zero(static_cast<Eigen::Index>(data.size()), 1);
  for (std::size_t k = 0; k < data.size(); ++k)
    if (data.axis[k] == effect.axis && data.sense[k] == effect.sense && !std::isnan(data.time_s[k]))
      since_start(static_cast<Eigen::Index>(k), 0) =
          data.time_s[k] - begins.try_emplace({data.run[k], data.line_of(k)}, data.time_s[k]).first->second;
  const double gain = rest.chi2() - added_by(rest, whitener(since_start)).chi2();
  return gain - std::log(static_cast<double>(data.size())) >= member.score() - kAsGood;
}

/// What acts on both approaches alike, and what acts against them, can be the parts of one lost motion that depends on
/// the travel since the reversal: where the axis turns at both ends only, that travel follows from position and
/// approach.
void hold_against_travel_since_reversal(const Observations& data, const Search& search, const Whitener& whitener,
                                        Found& found) {
  constexpr double kAsGood = 9.0;  // Δχ² of three standard deviations
  constexpr std::size_t kMostShapes = 20;
  if (data.travel_since_reversal_mm.empty() || !data.paths.empty()) return;
  const std::vector<Choice>& chosen = found.solution.chosen;
  struct Line {
    std::vector<std::size_t> members;
    bool of_approach = false, of_both = false;
  };
  std::map<std::pair<Axis, Sense>, Line> lines;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const EffectInstance& effect = found.families[chosen[i].family].effect;
    const bool is_spike = std::ranges::count(effect.definition().needs, Need::travel_since_reversal) > 0;
    if (!(effect.traits().shape_of_position || is_spike) || !effect.axis || !effect.sense) continue;
    Line& line = lines[{*effect.axis, *effect.sense}];
    line.members.push_back(i);
    (effect.traits().of_approach || is_spike ? line.of_approach : line.of_both) = true;
  }
  for (const auto& [place, line] : lines) {
    if (!line.of_approach || !line.of_both) continue;
    std::vector<double> travel_mm(data.size(), kNotMeasured), of_line_mm;
    for (std::size_t k = 0; k < data.size(); ++k)
      if (data.axis[k] == place.first && data.sense[k] == place.second)
        of_line_mm.push_back(travel_mm[k] = data.travel_since_reversal_mm[k]);
    if (std::ranges::any_of(of_line_mm, [](double mm) { return std::isnan(mm); })) continue;
    const CurveBasis curve(of_line_mm, kMostShapes, true);
    MatrixXd columns =
        MatrixXd::Zero(static_cast<Eigen::Index>(data.size()), static_cast<Eigen::Index>(curve.size()) + 1);
    for (std::size_t k = 0; k < data.size(); ++k) {
      if (std::isnan(travel_mm[k])) continue;
      const auto row = static_cast<Eigen::Index>(k);
      columns(row, 0) = data.approach[k] * travel_mm[k];
      for (std::size_t shape = 0; shape < curve.size(); ++shape)
        columns(row, static_cast<Eigen::Index>(shape) + 1) = data.approach[k] * curve.value(shape, travel_mm[k]);
    }
    std::vector<Choice> rest;
    double cost = 0.0;
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      if (std::ranges::find(line.members, i) == line.members.end())
        rest.push_back(chosen[i]);
      else
        cost += chosen[i].cost;
    }
    const Space without = search.solution(rest, found.solution.own).space;
    const double score = without.chi2() - found.solution.space.chi2() - cost;
    columns = whitener(columns);
    for (Eigen::Index shapes = 1; shapes <= columns.cols(); ++shapes) {
      const double gain = without.chi2() - added_by(without, columns.leftCols(shapes)).chi2();
      if (gain - static_cast<double>(shapes) * std::log(static_cast<double>(data.size())) < score - kAsGood) continue;
      for (const std::size_t i : line.members) found.groups[i].alias = Alias::travel_since_reversal;
      break;
    }
  }
}

}  // namespace

void judge(const Regressors& regressors, const Base& base, const Search& search, const Whitener& whitener,
           double noise_freedom, Found& found) {
  const Observations& data = regressors.data();
  const std::vector<Choice>& chosen = found.solution.chosen;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const Solution rest = search.solution(others(chosen, i), found.solution.own);
    const auto run = best_run_offset(data, whitener, rest.space);
    const Choice& member = found.groups[i].member;
    if (!run) continue;
    const EffectInstance& effect = found.families[member.family].effect;
    const RunBeside beside = run_beside(*run, effect, member.score());
    if (beside == RunBeside::nearly_as_good)
      found.run_note = fmt::format("an offset of run {} explains nearly as much as {}: check that run too", run->run,
                                   to_text(effect));
    if (beside != RunBeside::as_good) continue;
    found.groups[i].denied = true;
    if (!found.bad_run || run->gain > found.bad_run->gain) found.bad_run = run;
  }
  deny_sets_of_a_run(data, search, whitener, found);
  std::vector<bool> proved;
  std::vector<std::size_t> periods;
  std::vector<Choice> members;
  for (const Group& group : found.groups) {
    members.push_back(group.member);
    proved.push_back(group.e_value.value_or(0.0) >= kProved);
    periods.push_back(group.values.size());
  }
  found.objection = found.bad_run
                        ? fmt::format("an offset of run {} explains the residual equally well: check that run first",
                                      found.bad_run->run)
                        : objection_to_waves(data, found.families, members, proved, periods);
  if (found.objection.empty()) found.objection = objection_by_target(data, search, whitener, found);
  const auto effect_of_member = [&](std::size_t i) -> const EffectInstance& {
    return found.families[chosen[i].family].effect;
  };
  // a step that waves need, or another wave beside them, is as little a cause as they are
  const auto deny_waves_and_jumps = [&](const auto& is_meant) {
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      const EffectDefinition& definition = effect_of_member(i).definition();
      const bool is_jump = definition.traits.shape_of_position && !definition.search.has_slope;
      if ((definition.traits.periodic || is_jump) && is_meant(i)) found.groups[i].denied = true;
    }
  };
  if (!found.bad_run && !found.objection.empty()) deny_waves_and_jumps([](std::size_t) { return true; });
  if (found.objection.empty()) {
    if (const auto period_s = period_in_time_s(data, whitener, search.alone().space, found.solution.score())) {
      found.objection = objection_by_wave_in_time(*period_s);
      for (Group& group : found.groups) group.denied = true;
    }
  }
  for (std::size_t i = 0; i < chosen.size() && found.objection.empty(); ++i) {
    found.objection = objection_to_smoothness(regressors, whitener, found.solution.space,
                                              found.families[chosen[i].family], chosen[i], noise_freedom);
    found.groups[i].denied = found.groups[i].denied || !found.objection.empty();
  }
  for (std::size_t i = 0; i < chosen.size() && found.objection.empty(); ++i) {
    const auto change = change_of_wave(regressors, whitener, found.solution.space, found.families[chosen[i].family],
                                       chosen[i], noise_freedom);
    if (!change) continue;
    found.objection = change->reason;
    found.groups[i].change = change->gain;
    const EffectInstance& wave = effect_of_member(i);
    deny_waves_and_jumps([&](std::size_t j) {  // a pitch of the machine needs no other wave
      const EffectInstance& one = effect_of_member(j);
      const bool is_pitch = one.traits().periodic && is_pitch_or_no_wave(found.families[chosen[j].family], chosen[j]);
      return one.axis == wave.axis && one.sense == wave.sense && (j == i || !is_pitch);
    });
  }
  hold_against_single_targets(data, search, whitener, found);
  if (found.objection.empty()) hold_against_wander(data, base, search, found);
  for (std::size_t i = 0; i < chosen.size() && found.objection.empty(); ++i)
    if (drifts_alike_in_runs(data, whitener, search.solution(others(chosen, i), found.solution.own).space,
                             effect_of_member(i), found.groups[i].member))
      found.groups[i].alias = Alias::drift_in_runs;
  hold_against_travel_since_reversal(data, search, whitener, found);
}

}  // namespace ecs::model
