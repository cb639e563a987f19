// Noise and search in turn until neither moves; the level that a score must exceed is that of noise_level.cpp.
#include "model/diagnosis/investigation.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <span>

#include <fmt/format.h>

#include "base/linear/decompositions.hpp"
#include "model/diagnosis/e_value.hpp"
#include "model/diagnosis/structure.hpp"
#include "model/diagnosis/waves.hpp"
#include "model/diagnosis/weighing.hpp"
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
/// Effects, and pairs of them, that are tried as what the noise hides.
constexpr std::size_t kHiddenSets = 3, kPairsLookedAt = 10;
/// Score by which another set of as many effects is clearly better: odds of e^(9/2), 90 to one.
constexpr double kBetterSet = 9.0;
/// Candidates shown where nothing is found.
constexpr std::size_t kClosest = 3;

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
    found.objection = fmt::format(
        "a jump between runs {} and {} explains the residual equally well: check the events between them first",
        found.step->before, found.step->after);
  found.bad_run.reset();
  found.run_note.clear();
}

/// Each of the groups whose noise neighbours show beside repeats of others; all readings where nothing else is known.
std::vector<OfOneNoise> readings_of_one_noise(const Found& found) {
  const Space& space = found.solution.space;
  const auto rows = static_cast<Index>(found.left_out.size());
  const auto of = [&](const auto& is_one) {
    OfOneNoise readings{Eigen::VectorXf::Zero(rows)};
    for (Index k = 0; k < rows; ++k) {
      const auto row = static_cast<std::size_t>(k);
      if (found.left_out[row] || !is_one(row)) continue;
      readings.counts(k) = 1.0F;
      readings.squares += space.y(k) * space.y(k);
      readings.freedom += 1.0 - space.q.row(k).squaredNorm();
    }
    return readings;
  };
  std::vector<OfOneNoise> list;
  if (found.noise.pure.dof < kManyDegrees || !found.noise.pure.from_repeats)
    return {of([](std::size_t) { return true; })};
  for (const NoiseGroup& group : found.noise.groups)
    if (group.of_neighbours)
      list.push_back(of([&](std::size_t k) { return std::ranges::binary_search(group.rows, k); }));
  return list;
}

/// An effect may hide in the noise that was estimated from it, from neighbours or from repeats between which it
/// changed: where its share cannot be noise of any size, the noise is its residual. Of few readings a likely effect
/// suffices for that, and is no more than likely beside that noise. @return the noise has been replaced
bool took_noise_beside_best(const Base& base, const Search& search, const Whitener& whitener, Replicates& replicates,
                            const DiagnoseOptions& options, Found& found) {
  const Space& space = found.solution.space;
  const bool known_little = found.noise.pure.dof < kManyDegrees;
  std::optional<std::vector<Choice>> all;
  const std::vector<OfOneNoise> each = readings_of_one_noise(found);
  const double limit = options.false_naming_limit / static_cast<double>(std::max<std::size_t>(each.size(), 1));
  for (const OfOneNoise& readings : each) {
    if (readings.freedom <= kFewestToName) continue;  // an effect takes one degree at least
    if (!known_little && readings.squares > kMostSquareOfAll * readings.freedom) continue;
    if (!all) all = search.expand(space, kRefinedBesideNoise);
    std::vector<Choice> choices = *all;
    std::erase_if(choices, [&](const Choice& one) {
      return std::ranges::any_of(search.families()[one.family].acting.readings, [&](std::size_t k) {
        return !found.left_out[k] && readings.counts(static_cast<Index>(k)) == 0.0F;
      });
    });
    if (choices.empty()) continue;
    const BesideNoise beside = beside_noise_of_any_size(search, readings, replicates, choices, options);
    if (known_little) found.chance_of_closest = beside.chance;
    const bool names = known_little && search.beats_free_values(space, beside.best);
    const bool proves = beside.chance <= limit;
    if (!proves && !(names && readings.freedom < kManyDegrees && beside.chance <= kLikelyChance)) continue;
    found.proves_nothing = found.proves_nothing || !proves;
    if (names) found.stands_out = beside.best;
    std::vector<Choice> chosen = found.solution.chosen;
    chosen.push_back(beside.best);
    const Solution with = search.solution(chosen, found.solution.own);
    if (noise_changed(search.data(), base, joined(base, search, with), whitener, false, found.noise, found.left_out))
      return true;
  }
  return false;
}

/// Effects that may hide in the noise that was estimated from them: the best, and pairs that nearly cancel each other,
/// of which neither gains much alone. What stays the same while a line is repeated hides in no noise.
std::vector<std::vector<Choice>> sets_that_may_hide(const Search& search, const Space& space, bool known_little) {
  std::vector<std::vector<Choice>> sets;
  const auto add_best = [&](const std::vector<std::vector<Choice>>& best_first) {
    std::size_t added = 0;
    for (const std::vector<Choice>& set : best_first) {
      const auto changes = [&](const Choice& one) { return is_like_wander(search.families()[one.family].effect); };
      if (added < kHiddenSets && std::ranges::any_of(set, changes)) {
        sets.push_back(set);
        ++added;
      }
    }
  };
  std::vector<std::vector<Choice>> singles, pairs;
  if (!known_little)  // else it is held against noise of any size
    for (const Choice& one : search.expand(space, kHiddenSets)) singles.push_back({one});
  for (const auto& [one, other] : search.pairs_of(space, kPairsLookedAt, kAlikeOfPair)) pairs.push_back({one, other});
  add_best(singles);
  add_best(pairs);
  return sets;
}

/// Effects that change between repeats may have been taken for noise, or for a wander, which then hides them. They are
/// weighed with the noise that they leave: the set that makes the readings likelier than any wander does, by evidence
/// that is positive for each having been chosen. @return the noise has been replaced by what they leave
bool took_noise_beside_hidden(const Base& base, const Search& search, const Whitener& whitener, Found& found) {
  const Observations& data = search.data();
  const Solution& solution = found.solution;
  const LinearProblem without = joined(base, search, solution);
  const auto among = std::ranges::count_if(std::span(found.families).first(found.candidates_tried),
                                           [](const Family& family) { return is_like_wander(family.effect); });
  const double evidence = 2.0 * std::log(kPositive * static_cast<double>(std::max<std::ptrdiff_t>(among, 1)));
  const Whitener white(data, wandering(found.noise, 0.0, 1.0), found.left_out);
  const Space alone = added_by({MatrixXd(without.target.size(), 0), white(without.target)}, white(without.columns));
  const double freedom = freedom_beside(alone, found.left_out);
  const bool known_little = found.noise.pure.dof < kManyDegrees;
  const MatrixXd independent = independent_columns(without.columns, found.left_out);
  const auto deviance = [&](const MatrixXd& of) {
    return least_deviance(data, found.noise, found.left_out, independent, of, without.target, false);
  };
  std::optional<double> wander;  // deviance without them
  double best = 0.0;
  std::vector<Choice> chosen;
  for (const auto& set : sets_that_may_hide(search, solution.space, known_little)) {
    MatrixXd effects(without.columns.rows(), 0);
    double price = 0.0;
    for (const Choice& one : set) {
      effects = beside(std::move(effects), search.columns_of(one).of);
      price += one.cost + evidence;
    }
    // the chance that noise of any size gives such a ratio falls with what is left to estimate it (F test)
    const double spare = freedom - static_cast<double>(effects.cols()), worth = spare / freedom;
    const double left = std::max(added_by(alone, white(effects)).chi2(), kLeastDivisor);
    if (spare < kFewestSpare || spare * std::log(alone.chi2() / left) <= price) continue;  // no better than a wander
    if (!wander)
      wander =
          std::min(likely_wanders(data, found.noise, found.left_out, without.columns, without.target).front().deviance,
                   deviance(MatrixXd(without.columns.rows(), 0)));
    const double better = worth * (*wander - deviance(effects)) - price;
    if (better <= best) continue;
    best = better;
    chosen = solution.chosen;
    chosen.insert(chosen.end(), set.begin(), set.end());
  }
  if (chosen.empty() || !noise_changed(data, base, joined(base, search, search.solution(chosen, solution.own)),
                                       whitener, false, found.noise, found.left_out))
    return false;
  found.proves_nothing = found.proves_nothing || known_little;  // no replicate knows that they were chosen
  return true;
}

/// The greatest score that any effect reaches on each replicate of noise, which is first scaled to the residual of the
/// model: effects are then compared by the share that they explain.
/// @param replicates  whitened (readings × replicates)
std::vector<double> scores_at_size(const Search& search, const MatrixXd& replicates) {
  const Space& alone = search.alone().space;
  MatrixXd left = without(alone.q, replicates);
  for (Index b = 0; b < left.cols(); ++b)
    left.col(b) *= std::sqrt(alone.chi2() / std::max(left.col(b).squaredNorm(), kLeastDivisor));
  return search.best_scores(left.cast<float>());
}

}  // namespace

double rms_of(const VectorXd& r) {
  return r.size() == 0 ? 0.0 : std::sqrt(r.squaredNorm() / static_cast<double>(r.size()));
}

Result<Base> base_of(const Model& model, const Regressors& regressors, bool plain) {
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
  base.noise = noise_of(data, base.residual, base.core.left_out, beside(base.columns, base.own_columns));
  base.fit = reported(assembly, regressors, base.core);
  return base;
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
  found.noise = base.noise;
  std::size_t looks = 0;
  for (int round = 0;; ++round) {
    const auto white = std::make_shared<const Whitener>(data, found.noise, found.left_out);
    const Whitener& whitener = *white;
    const double noise_freedom = std::max(kFewestNoiseFreedom, kFreedomOfTests * found.noise.pure.dof);
    const auto made = std::make_shared<const Search>(regressors, whitener, base.columns, base.target, others_than_own,
                                                     own, options.cancelled);
    const Search& search = *made;
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
        (took_noise_beside_best(base, search, whitener, replicates, options, found) ||
         took_noise_beside_hidden(base, search, whitener, found))) {
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
      const auto period_s = known_little ? std::nullopt : period_in_time_s(data, whitener, alone, 0.0);
      if (period_s && is_mostly_wave_in_time(data, *period_s, base.residual, found.left_out))
        found.objection = objection_by_wave_in_time(*period_s);
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
    found.wander_scores = [white, made, &data, &base, noise = found.noise, left_out = found.left_out,
                           count = options.noise_replicates] {
      const LinearProblem given = joined(base, *made, made->alone());
      const WanderingNoise wander = wandering_noise(data, noise, left_out, given.columns, given.target, count);
      if (wander.replicates.size() == 0) return WanderScores{};
      return WanderScores{wander.probability, scores_at_size(*made, (*white)(wander.replicates))};
    };
    return found;
  }
}

double Found::false_naming(double score) const {
  return stands_out ? chance_of_closest.value_or(1.0) : tail_probability(replicate_scores, score);
}

bool is_wave_in_time(const Found& found) { return found.solution.chosen.empty() && !found.objection.empty(); }

bool noise_left(const Found& found, const DiagnoseOptions& options) {
  if (found.noisy || found.odd_pass || found.step || found.wanders || found.wave) return false;
  if (is_wave_in_time(found)) return false;
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
