// Noise and search in turn until neither moves; the level that a score must exceed is that of noise_level.cpp.
#include "model/diagnosis/investigation.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <span>

#include <fmt/format.h>

#include "base/linear/decompositions.hpp"
#include "model/diagnosis/e_value.hpp"
#include "model/diagnosis/structure.hpp"
#include "model/diagnosis/waves.hpp"
#include "model/effects/definition.hpp"
#include "model/effects/quantities.hpp"
#include "model/fit/core.hpp"
#include "model/fit/held_out.hpp"
#include "model/fit/noise.hpp"
#include "model/fit/statistics.hpp"

namespace ecs::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Squares of the noise per reading below which nothing is named: no noise is known that well (400
/// repeats know its square to 7 %).
constexpr double kLeastShare = 0.07;
/// Squares of the noise per reading below which nothing is called structure, which any misjudged noise resembles, and
/// how much rarer than a false name it is to be. A choice, on the safe side of naming.
constexpr double kLeastStructure = 0.08;
constexpr double kStructureChance = 0.4;
/// Squares of the noise per reading that a third effect must explain, which a mixture of two nearly right ones calls
/// for too easily.
constexpr double kLateShare = 0.3;
/// Noise that changed by more than this is looked at again; kMostRounds times, then it is what it is.
constexpr double kNoiseFell = 0.85, kNoiseRose = 1.15;
/// Part of the freedom of repeats that a test of structure relies on: correlated repeats tell less than their number. A
/// choice.
constexpr double kFreedomOfTests = 0.6;
/// Structure that a named effect may leave: this share of what it explains, for the shapes of the library are not
/// exact, and at most this many squares of the noise. Choices.
constexpr double kLeftOfExplained = 0.02, kMostLeft = 0.2;
/// Tests of structure are held against this many times the replicates that are searched: they are cheap, and their
/// limit is further out.
constexpr std::size_t kStructureReplicates = 2;
/// Without repeats the noise may have been taken for nearly all that the model leaves: for less than this many squares
/// of it, or where it is known little, what the best effect explains is held against noise of any size.
constexpr std::size_t kMostLooks = 2;
constexpr double kMostSquareOfAll = 2.0;
/// Odds from which evidence for one of two hypotheses is positive (Kass and Raftery 1995, JASA 90, 773).
constexpr double kPositive = 3.0;
/// Below this e-value readings that an effect was not fitted to speak against it.
constexpr double kSpeaksAgainst = 1.0 / kPositive;
/// Score by which another set of as many effects is clearly better: odds of e^(9/2), 90 to one.
constexpr double kBetterSet = 9.0;
/// Candidates shown where nothing is found; refined where the size of the noise is open, for the best under noise that
/// is too large is the simplest.
constexpr std::size_t kClosest = 3, kRefinedBesideNoise = 8;

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

/// Noise known only from what smooth curves leave is looked at again once the effects found are taken off.
bool changed(const NoiseModel& a, const NoiseModel& b) {
  for (std::size_t g = 0; g < a.groups.size(); ++g) {
    const double ratio = b.groups[g].sigma() / std::max(a.groups[g].sigma(), kLeastDivisor);
    if (ratio < kNoiseFell || ratio > kNoiseRose) return true;
  }
  return false;
}

/// Share of what is above noise that the effects predict where they were not fitted, beyond what the model absorbs of
/// both: at left-out targets where a line has enough of them, in left-out runs where there are, the lesser.
double cross_validated_share_of(const Observations& data, const Search& search, const Whitener& whitener,
                                const Solution& solution) {
  const Space model = search.solution({}, solution.own).space;
  const auto beyond = [&](const MatrixXd& raw) { return without(model.q, whitener(raw)); };
  LinearProblem left{MatrixXd(model.q.rows(), 0), model.y};
  for (const Choice& choice : solution.chosen) {
    const Columns columns = search.columns_of(choice);
    if (columns.fixed.size() > 0) left.target -= beyond(columns.fixed).col(0);
    left.columns = beside(std::move(left.columns), beyond(columns.of));
  }
  const Parts runs = parts_of(data);
  const auto share = [&](const Parts& parts) {
    return cross_validated_part(parts, left.columns, left.target, model.y);
  };
  const double by_part = share(runs);
  if (!has_targets_to_leave_out(data)) return by_part;
  const double by_target = share(parts_by_target(data));
  return runs.by_run ? std::min(by_part, by_target) : by_target;
}

std::vector<Choice> others(std::vector<Choice> chosen, std::size_t i) {
  chosen.erase(chosen.begin() + static_cast<std::ptrdiff_t>(i));
  return chosen;
}

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

/// Readings that count, less what is absorbed.
double freedom_beside(const Space& space, const std::vector<bool>& left_out) {
  return static_cast<double>(std::ranges::count(left_out, false)) - static_cast<double>(space.q.cols());
}

/// Whether what is left is no more than noise: within three standard deviations of its sum of squares.
bool is_noise(const Space& left, const Found& found) {
  constexpr double kDeviations = 3.0;
  const double freedom = freedom_beside(left, found.left_out);
  return left.chi2() <= freedom + kDeviations * std::sqrt(2.0 * freedom);
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

/// Groups of the effects found, each with its e-value; those that readings they were not fitted to speak against are
/// taken back, the worst first. What remains is the best set of its size: one that needed what was taken back is not.
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
    stepwise.most_effects = found.solution.chosen.size();
    if (stepwise.most_effects == 0) continue;
    Solution best = best_solution(search, stepwise);
    if (best.score() > found.solution.score()) found.solution = std::move(best);
  }
  if (found.groups.empty()) return;
  const LinearProblem all = joined(base, search, found.solution);
  found.wander_is_evident = is_wandering(regressors.data(), found.noise, found.left_out, all.columns, all.target);
  for (std::size_t i = 0; i < found.groups.size(); ++i) {
    std::optional<double>& e_value = found.groups[i].e_value;
    if (found.wander_is_evident || may_be_wander(found.noise, found.families[found.groups[i].member.family].effect))
      e_value = e_value_of_group(i, NullHypothesis::noise_or_wander);
    if (e_value) *e_value /= static_cast<double>(found.candidates_tried);
  }
}

/// Tests that a family is one of: every candidate, at every value tried, with every set of its columns.
double tests_of(const Family& family, std::size_t candidates) {
  const EffectDefinition& definition = family.effect.definition();
  const std::size_t sets = definition.traits.is_curve
                               ? definition.column_count()
                               : std::max(definition.column_sets.size(), definition.column_sets_elsewhere.size());
  return static_cast<double>(candidates) * static_cast<double>(family.grid.size() + family.facts.size()) *
         static_cast<double>(std::max<std::size_t>(sets, 1));
}

/// p-values of the effects found. An effect is tested at the best of the values tried, not at one sought nearby. Where
/// a wander is evident noise alone is no hypothesis, and a formula begins where the readings are fitted best: there the
/// e-value stands for the p-value (Markov).
void state_p_values(const Regressors& regressors, const Base& base, const Search& search, Found& found) {
  const auto p_value_beside = [&](const Solution& rest, const Group& group) {
    const Family& family = found.families[group.member.family];
    if (found.wander_is_evident || group.wander || family.effect.is_user())
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

/// Deviance of the readings without these of the effects found, under the likeliest wander, less that with them under
/// the likeliest noise: either has the law that suits it, for repeats between which an effect changes look correlated.
/// What is set aside is in neither.
double better_than_wander(const Observations& data, const Base& base, const Search& search, const Found& found,
                          const std::vector<std::size_t>& set, const std::vector<std::size_t>& aside) {
  const std::vector<Choice>& chosen = found.solution.chosen;
  std::vector<Choice> without;
  for (std::size_t i = 0; i < chosen.size(); ++i)
    if (!std::ranges::count(set, i) && !std::ranges::count(aside, i)) without.push_back(chosen[i]);
  LinearProblem null = joined(base, search, search.solution(without, found.solution.own));
  const double wander = likely_wanders(data, found.noise, found.left_out, null.columns, null.target).front().deviance;
  MatrixXd effects(null.columns.rows(), 0);
  for (const std::size_t i : set) {
    const Columns columns = search.columns_of(chosen[i]);
    if (columns.fixed.size() > 0) null.target -= columns.fixed;
    effects = beside(std::move(effects), columns.of);
  }
  return wander - deviance_of_noise(data, found.noise, found.left_out,
                                    independent_columns(null.columns, found.left_out), effects, null.target);
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
      (rivals ? found.groups[i].wander : found.groups[i].denied) = true;
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

/// What speaks against the effects found: a run that explains as much, waves that can be anything.
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
  for (const Group& group : found.groups) {
    proved.push_back(group.e_value.value_or(0.0) >= kProved);
    periods.push_back(group.values.size());
  }
  found.objection =
      found.bad_run ? fmt::format("an offset of run {} explains it as well: check that run first", found.bad_run->run)
                    : objection_to_waves(data, found.families, chosen, proved, periods);
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
    found.objection = objection_by_wave_in_time(data, whitener, search.alone().space, found.solution.score());
    if (!found.objection.empty())
      for (Group& group : found.groups) group.denied = true;
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
  if (found.objection.empty()) hold_against_wander(data, base, search, found);
}

/// Where all effects found leave structure, and readings that some of them were not fitted to speak against those, the
/// others may be no more than what fitted beside them: the best set of as many effects takes their place. Not where
/// something else speaks against one: the structure, not another effect, is what is left then. @return there is one
bool took_best_of_those_left(const Search& search, StepwiseOptions stepwise, bool structure, Found& found) {
  std::vector<Choice> kept;
  for (std::size_t i = 0; i < found.groups.size(); ++i) {
    const Group& group = found.groups[i];
    if (group.denied) return false;
    if (structure && group.e_value.value_or(1.0) < kSpeaksAgainst) continue;
    kept.push_back(found.solution.chosen[i]);
  }
  if (kept.empty() || kept.size() == found.groups.size()) return false;
  stepwise.most_effects = kept.size();
  Solution best = best_solution(search, stepwise);
  if (best.chosen.empty() || best.score() <= search.refined(kept, found.solution.own).score() + kBetterSet)
    return false;
  found.solution = std::move(best);
  found.bad_run.reset();
  found.run_note.clear();
  found.objection.clear();
  found.doubt.clear();
  return true;
}

/// A step between two runs takes the place of a run that was blamed for it.
void blame_step(Found& found) {
  found.noisy.reset();
  found.odd_pass.reset();
  if (found.bad_run)
    found.objection =
        fmt::format("a jump between runs {} and {} explains it as well: check the events between them first",
                    found.step->before, found.step->after);
  found.bad_run.reset();
  found.run_note.clear();
}

/// An effect may hide in the noise that was estimated from it, from neighbours or from repeats between which it
/// changed: where its share cannot be noise of any size, the noise is its residual. Of few readings a likely effect
/// suffices for that, and is no more than likely beside that noise. @return the noise has been replaced
bool took_noise_beside_best(const Base& base, const Search& search, const Whitener& whitener, Replicates& replicates,
                            const DiagnoseOptions& options, Found& found) {
  const Space& space = found.solution.space;
  const double freedom = freedom_beside(space, found.left_out);
  const bool known_little = found.noise.pure.dof < kManyDegrees;
  if (freedom < kFewestToName) return false;
  if (!known_little && (found.noise.pure.from_repeats || space.chi2() > kMostSquareOfAll * freedom)) return false;
  const std::vector<Choice> choices = search.expand(space, kRefinedBesideNoise);
  if (choices.empty()) return false;
  const BesideNoise beside = beside_noise_of_any_size(search, space, replicates, choices, freedom, options);
  if (known_little) found.chance_of_closest = beside.chance;
  const bool names = known_little && search.beats_free_values(space, beside.best);
  const bool proves = beside.chance <= options.false_naming_limit;
  if (!proves && !(names && freedom < kManyDegrees && beside.chance <= kLikelyChance)) return false;
  found.proves_nothing = found.proves_nothing || !proves;
  if (names) found.stands_out = beside.best;
  std::vector<Choice> chosen = found.solution.chosen;
  chosen.push_back(beside.best);
  const Solution with = search.solution(chosen, found.solution.own);
  return noise_changed(search.data(), base, joined(base, search, with), whitener, false, found.noise, found.left_out);
}

}  // namespace

double rms_of(const VectorXd& r) {
  return r.size() == 0 ? 0.0 : std::sqrt(r.squaredNorm() / static_cast<double>(r.size()));
}

Result<Base> base_of(const Model& model, const Regressors& regressors, bool plain, Fit* fit) {
  ECS_TRY(assembly, Assembly::of(with_best_starts(model, regressors), regressors));
  Base base;
  base.core = fitted(assembly, regressors, {plain, true});
  const Observations& data = regressors.data();
  base.columns.resize(static_cast<Index>(data.size()), 0);
  base.own_columns = base.columns;
  base.target =
      Eigen::Map<const VectorXd>(data.reading.data(), static_cast<Index>(data.size())) - assembly.fixed(data.size());
  base.residual = base.core.residual;
  for (std::size_t s = 0; s < assembly.slots.size(); ++s) {
    const Slot& slot = assembly.slots[s];
    if (!slot.at_limit.empty()) base.at_limit.push_back(slot.effect);
    const bool is_sought = slot.is_sought(regressors.motions());
    if (is_sought) base.own.push_back(s);
    MatrixXd& columns = is_sought ? base.own_columns : base.columns;
    columns = beside(std::move(columns), slot.columns);
    for (std::size_t j = 0; j < slot.nonlinear.size(); ++j) {  // a small error of a fitted value is absorbed too
      if (!slot.nonlinear_free[j] || !slot.has_slope()) continue;
      const VectorXd sizes = base.core.sizes.segment(assembly.first_column(s), slot.columns.cols());
      columns = beside(std::move(columns), assembly.slope(s, j, sizes, regressors));
    }
  }
  if (fit != nullptr) *fit = reported(assembly, regressors, base.core);
  return base;
}

NoiseModel noise_beside(const Observations& data, const Base& base, const std::vector<bool>& left_out) {
  return noise_of(data, base.residual, left_out, beside(base.columns, base.own_columns));
}

VectorXd residual_of(const LinearProblem& problem, const Whitener& whitener) {
  if (problem.columns.cols() == 0) return problem.target;
  return problem.target - problem.columns * least_squares(whitener(problem.columns), whitener(problem.target));
}

bool noise_changed(const Observations& data, const Base& base, const LinearProblem& all, const Whitener& whitener,
                   bool plain, NoiseModel& noise, std::vector<bool>& left_out) {
  const auto spare = static_cast<double>(std::ranges::count(left_out, false) - all.columns.cols());
  if (!noise.pure.from_repeats && spare < kFewestToName) return false;
  const VectorXd residual = residual_of(all, whitener);
  std::vector<bool> outliers = plain ? left_out : rows_left_out(data, residual);
  NoiseModel again = noise_of(data, residual, outliers, beside(all.columns, base.own_columns));

  if (outliers == left_out && !changed(noise, again)) return false;
  left_out = std::move(outliers);
  noise = std::move(again);
  return true;
}

std::vector<EffectInstance> others_than(const std::vector<EffectInstance>& own,
                                        std::vector<EffectInstance> candidates) {
  std::erase_if(candidates, [&](const EffectInstance& candidate) {
    return !candidate.traits().several_alike &&
           std::ranges::any_of(own, [&](const EffectInstance& term) { return same_candidate(term, candidate); });
  });
  return candidates;
}

std::vector<EffectInstance> candidates_beside(const Model& model, const std::vector<EffectInstance>& own,
                                              const std::vector<EffectInstance>& candidates) {
  std::vector<EffectInstance> beside = others_than(own, candidates);
  std::erase_if(beside, [&](const EffectInstance& one) {
    return one.traits().has_lag && is_searched(one) &&
           std::ranges::any_of(model.effects, [&](const EffectInstance& term) { return same_candidate(term, one); });
  });
  return beside;
}

Found searched(const Model& model, const Regressors& regressors, const Base& base,
               const std::vector<EffectInstance>& candidates, const DiagnoseOptions& options) {
  const Observations& data = regressors.data();
  std::vector<EffectInstance> own;
  for (const std::size_t i : base.own) own.push_back(model.effects[i]);
  const std::vector<EffectInstance> others_than_own =
      others_than(base.at_limit, candidates_beside(model, own, candidates));
  Found found;
  found.left_out = base.core.left_out;
  found.noise = noise_beside(data, base, found.left_out);
  std::size_t looks = 0;
  for (int round = 0;; ++round) {
    const Whitener whitener(data, found.noise, found.left_out);
    const double noise_freedom = std::max(kFewestNoiseFreedom, kFreedomOfTests * found.noise.pure.dof);
    const Search search(regressors, whitener, base.columns, base.target, others_than_own, own, options.cancelled);
    found.families = search.families();
    found.candidates_tried = search.candidates();
    const Structure structure(data, whitener, noise_freedom);
    const Space& alone = search.alone().space;
    found.before = structure.tests(alone);
    Replicates replicates(data, found.noise, found.left_out, whitener, search.base());
    const double n = static_cast<double>(data.size());
    const bool known_little = found.noise.pure.dof < kManyDegrees;
    if (round == 0) find_level(search, structure, replicates, options, found);
    found.solution = search.alone();
    found.taken_back.clear();
    const StepwiseOptions stepwise{options.most_effects, found.entry_score,
                                   kLeastShare * n,      kLateShare * n,
                                   found.noise.pure.dof, known_little ? freedom_beside(alone, found.left_out) : 0.0};
    if (found.entry_score < kBeyondAll) found.solution = best_solution(search, stepwise);
    LinearProblem all = joined(base, search, found.solution);
    if (round < kMostRounds && noise_changed(data, base, all, whitener, options.plain, found.noise, found.left_out))
      continue;
    if (looks < kMostLooks && !options.plain &&
        took_noise_beside_best(base, search, whitener, replicates, options, found)) {
      ++looks;
      round = -1;
      continue;
    }
    if (found.solution.chosen.empty() && found.stands_out) {
      found.solution = search.refined({*found.stands_out});
      all = joined(base, search, found.solution);
    } else {
      found.stands_out.reset();
    }
    weigh(regressors, base, search, stepwise, found);
    const auto chance_beside = [&](const Space& space, const std::vector<StructureTest>& tests) {
      return tail_probability(structure.largest_of(space, replicates.beside(space)), largest_of(tests));
    };
    if (found.entry_score < kBeyondAll) replicates.draw_up_to(kStructureReplicates * options.noise_replicates);
    if (!found.solution.chosen.empty())
      found.cross_validated_share = cross_validated_share_of(data, search, whitener, found.solution);
    if (found.cross_validated_share < kLeastCrossValidatedAlone &&
        chance_beside(alone, found.before) > kStructureChance * options.false_naming_limit) {
      // no structure but for an effect without proof: that is noise
      found.solution = search.alone();
      found.groups.clear();
      found.cross_validated_share = 1.0;
    }
    if (found.solution.chosen.empty()) {
      found.after = found.before;
      found.structure_p_after = chance_beside(alone, found.before);
      found.closest = search.expand(alone, kClosest);
    } else {
      const auto judge_all = [&] {
        judge(regressors, base, search, whitener, noise_freedom, found);
        found.after = structure.tests(found.solution.space);
        found.structure_p_after = chance_beside(found.solution.space, found.after);
      };
      judge_all();
      if (took_best_of_those_left(search, stepwise, leaves_structure(found, options), found)) {
        weigh(regressors, base, search, stepwise, found);
        judge_all();
      }
      if (options.p_values) state_p_values(regressors, base, search, found);
    }
    found.beyond_position = tests_beyond_position(data, whitener, structure, alone, found.before);
    const VectorXd residual = residual_of(all, whitener);  // beside what was taken back too: less structure
    found.noisy = noisy_run(data, found.solution.space.y, residual, found.left_out);
    if (found.noisy && found.noisy->off_um) {
      const auto apart = run_apart(data, residual_of(joined(base, search, found.solution), whitener), found.left_out);
      if (apart && apart->run == found.noisy->run)
        found.noisy->off_um = apart->off_um;
      else
        found.noisy.reset();
    }
    found.wave = free_wave(data, found.solution.space.y, found.left_out);
    if (found.solution.chosen.empty()) found.odd_pass = odd_pass(data, residual, found.left_out);
    if ((found.noisy && found.noisy->off_um) || found.odd_pass || found.bad_run) {
      found.step = step_of_runs(data, residual_of(joined(base, search, search.alone()), whitener), found.left_out);
      if (found.step) blame_step(found);
    }
    found.wanders = wanders(data, found.noise, residual, found.left_out);
    return found;
  }
}

double Found::false_naming(double score) const {
  return stands_out ? chance_of_closest.value_or(1.0) : tail_probability(replicate_scores, score);
}

bool noise_left(const Found& found, const DiagnoseOptions& options) {
  if (found.noisy || found.odd_pass || found.step || found.wanders || found.wave) return false;
  if (found.cross_validated_share < kLeastCrossValidated) return false;
  return !leaves_structure(found, options);
}

bool leaves_structure(const Found& found, const DiagnoseOptions& options) {
  if (found.structure_p_after > kStructureChance * options.false_naming_limit) return false;
  const double n = static_cast<double>(found.left_out.size());
  const double explained = (found.solution.chi2_before - found.solution.space.chi2()) / n;
  double excess = 0.0;
  for (const StructureTest& test : found.after) excess = std::max(excess, test.excess);
  double hidden = 0.0;  // by the noise of sensors: what they leave unknown is in the residual
  for (const Group& group : found.groups) hidden += group.hidden_by_sensor / n;
  return excess >= kLeastStructure + std::min(kLeftOfExplained * explained, kMostLeft) + hidden;
}

}  // namespace ecs::model
