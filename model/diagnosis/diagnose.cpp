// The answer from a search: what is told of a bad run and of each candidate, its proof by cross-validation (Stone
// 1974), the chance of a false name from replicates of noise (Westfall and Young 1993). Does not live here: how sure
// each candidate is (standing.cpp).
#include "model/diagnosis/diagnose.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "base/file_kind.hpp"
#include "model/diagnosis/apart.hpp"
#include "model/diagnosis/bad_run.hpp"
#include "model/diagnosis/investigation.hpp"
#include "model/diagnosis/ladder.hpp"
#include "model/diagnosis/left.hpp"
#include "model/diagnosis/shape.hpp"
#include "model/diagnosis/standing.hpp"
#include "model/diagnosis/structure.hpp"
#include "model/diagnosis/targets.hpp"
#include "model/diagnosis/trial.hpp"
#include "model/diagnosis/visits.hpp"
#include "model/diagnosis/words.hpp"
#include "model/effects/definition.hpp"
#include "model/fit/compare.hpp"
#include "model/fit/core.hpp"
#include "model/fit/held_out.hpp"
#include "model/fit/noise.hpp"
#include "model/fit/statistics.hpp"
#include "model/regression/needs.hpp"

namespace ecs::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// ", in addition to a rising trend of 13 um over all runs": without it the means of the runs differ by another amount.
std::string trend_text(const StepOfRuns& step, std::string_view unit) {
  constexpr double kWorthSaying = 0.1;
  if (std::abs(step.trend_um) < kWorthSaying * std::abs(step.height_um)) return "";
  return fmt::format(", in addition to a {} trend of {:.2g} {} over all runs",
                     step.trend_um > 0.0 ? "rising" : "falling", std::abs(step.trend_um), unit);
}

/// Whether the zero of the bad run is worth the first sentence: where it explains less than a tenth of what the effects
/// do together, it stands for small ones among them only.
bool explains_much(const Found& found) {
  constexpr double kMuch = 0.1;
  return found.bad_run->gain >= kMuch * (found.solution.chi2_before - found.solution.space.chi2());
}

/// The column that explains why runs differ: what is left changes with it, and beside it not from run to run. "": none.
std::string condition_of_runs(const std::vector<LeftProperty>& left) {
  const auto is_of = [&](std::string_view property) {
    const auto found = std::ranges::find(left, property, &LeftProperty::property);
    return found == left.end() ? std::string() : found->is;
  };
  const std::string growth = is_of("growth");
  return is_of("session") == "none" && growth != "none" ? growth : std::string();
}

/// The run that is bad, if one is: the headline begins with it.
/// @param scaled  comes before all else  @param residual  of the model as given, um, a row a reading of `data`
std::optional<DifferentRun> different_run(const Found& found, const std::optional<ScaledRun>& scaled,
                                          const Diagnosis& diagnosis, const Observations& data,
                                          const VectorXd& residual) {
  const auto of_run = [&](int run, std::string words, bool is_shifted = true) {
    if (const auto drift_um = drift_of_last_run(data, residual, run))
      return DifferentRun{run, true, true,
                          fmt::format("Readings drift by {:+.2g} {} within run {}, the last one: look for an event "
                                      "late in the day first.",
                                      *drift_um, diagnosis.noise.unit, run)};
    words.front() = 'R';
    return DifferentRun{run, false, is_shifted, words + ". Check that run first."};
  };
  const auto of_step = [&](const StepOfRuns& step) {
    return DifferentRun{
        step.after, true, true,
        fmt::format(
            "All readings {} by {:.2g} {} between runs {} and {}{}: the zero was changed, or something slipped. Check "
            "the events between these runs first.",
            step.height_um > 0.0 ? "rise" : "fall", std::abs(step.height_um), diagnosis.noise.unit, step.before,
            step.after, trend_text(step, diagnosis.noise.unit))};
  };
  if (scaled)
    return DifferentRun{scaled->run, false, false,
                        words_for(*scaled, diagnosis.noise.unit) + ". Check that run first."};
  if (found.noisy && !found.noisy->off_um) return of_run(found.noisy->run, words_for(*found.noisy), false);
  if (found.noisy)
    return of_run(found.noisy->run, fmt::format("run {} lies {:+.3g} {} from the other runs on average",
                                                found.noisy->run, *found.noisy->off_um, diagnosis.noise.unit));
  if (found.step) return of_step(*found.step);
  if (found.odd_pass)
    return of_run(found.odd_pass->run, fmt::format("run {} differs from the other runs by {:.3g} {} in one approach",
                                                   found.odd_pass->run, found.odd_pass->off_um, diagnosis.noise.unit));
  if (found.bad_run && explains_much(found))
    return of_run(found.bad_run->run, words_for(*found.bad_run, data, residual, found.left_out, diagnosis.noise.unit));
  if (diagnosis.verdict != Verdict::unexplained_structure || diagnosis.where.empty() ||
      diagnosis.where.front().variable != "run")
    return std::nullopt;
  if (const auto step = step_of_runs(data, residual, std::vector<bool>(data.size()))) return of_step(*step);
  if (const auto run = run_apart(data, residual, std::vector<bool>(data.size())))
    return of_run(run->run, fmt::format("run {} differs from the other runs by {:.2g} {} on average", run->run,
                                        run->off_um, diagnosis.noise.unit));
  return std::nullopt;
}

/// "An offset of run 3 …", where it nearly explains what an effect does; "" where none does.
std::string run_note(const Found& found) {
  if (found.run_note.empty()) return "";
  std::string note = found.run_note;
  note.front() = 'A';
  return note + ".";
}

/// The run comes first in `where`, whatever else the residual depends on; one that is not there yet is added.
/// @pre the search has found a bad run, or one is scaled  @param chance  that is stated for one that is added
void put_run_first(std::vector<Dependence>& where, const Observations& data, const Found& found,
                   const std::optional<ScaledRun>& scaled, const VectorXd& residual, double chance) {
  const auto is_run = [](const Dependence& one) { return one.variable == "run"; };
  if (std::ranges::none_of(where, is_run)) {
    const int run = scaled           ? scaled->run
                    : found.noisy    ? found.noisy->run
                    : found.odd_pass ? found.odd_pass->run
                    : found.step     ? found.step->after
                                     : found.bad_run->run;
    double of_run = 0.0;
    for (std::size_t k = 0; k < data.size(); ++k)
      if (data.run[k] == run) of_run += residual(static_cast<Index>(k)) * residual(static_cast<Index>(k));
    where.push_back({"run", of_run / std::max(residual.squaredNorm(), kLeastDivisor), chance, {}, {}});
  }
  std::stable_partition(where.begin(), where.end(), is_run);
}

void put_motions_first(std::vector<Dependence>& where, const MotionsOfGroups& motions) {
  std::erase_if(where, [&](const Dependence& one) { return one.variable == motions.by; });
  const double left = motions.rms_after_um / motions.rms_before_um;
  where.insert(where.begin(), {motions.by, 1.0 - left * left, motions.p_value, {}, {}});
}

/// Candidates proved on readings not fitted to: what a person pays for.
constexpr std::size_t kMostProved = 4;
/// Bins in which a dependence is shown: a choice; a line on a screen.
constexpr std::size_t kMostBins = 24;
/// A dependence of a smaller share of the residual is not ranked.
constexpr double kTellingShare = 0.01;

/// Sizes of an effect alone beside the model, as parameters without sigma.
std::vector<ParameterEstimate> quick_parameters(const RankedCandidate& ranked, const LinearProblem& problem,
                                                const Whitener& whitener, const Regressors& regressors, Index first) {
  const VectorXd sizes = smallest_sizes(whitener(problem.columns), whitener(problem.target));
  const Columns all = regressors.columns(ranked.effect, ranked.choice.nonlinear);
  VectorXd every = VectorXd::Zero(all.of.cols());
  std::size_t j = 0;
  for (const Index column : ranked.choice.columns)
    if (column < every.size()) every(column) = sizes(first + static_cast<Index>(j++));
  std::optional<double> nonlinear;
  if (!ranked.effect.definition().searched_parameter().empty()) nonlinear = ranked.choice.nonlinear;
  if (!ranked.effect.traits().is_curve)
    return parameters_from(ranked.effect, every, MatrixXd(0, 0), nonlinear, std::nullopt);
  return {{"rms_um",
           unit_of(ranked.effect, ranked.effect.definition().parameters.front()),
           regressors.rms_of_curve(ranked.effect, regressors.acting(ranked.effect), every),
           {},
           false,
           false}};
}

/// @param wander  what noise that wanders looks like; empty where that does not matter
double false_naming_of(const Found& found, const WanderScores& wander, const RankedCandidate& one) {
  if (wander.scores.empty()) return one.false_naming;
  const double least = 1.0 / (static_cast<double>(found.replicate_scores.size()) + 1.0);
  return std::max(least, std::lerp(found.false_naming(one.choice.score()),
                                   tail_probability(wander.scores, one.choice.score()), wander.probability));
}

Candidate candidate_of(const ReportInput& in, const RankedCandidate& ranked, const VectorXd& before,
                       const Whitener& whitener, const Parts& parts, const FittedWith& after, double held_out_before,
                       bool prove) {
  Candidate candidate;
  candidate.effect = ranked.effect;
  candidate.named = ranked.standing == Standing::proved;
  candidate.standing = ranked.standing;
  const LinearProblem problem = joined_with(in.problem, columns_on(in.regressors, ranked.effect, ranked.choice));
  const VectorXd left = residual_with(in.model, in.own, {ranked.effect, ranked.choice}, problem, whitener,
                                      in.regressors, in.options.plain, ranked.in_answer() ? nullptr : &in.base.core);
  static_cast<TrialNumbers&>(candidate) = trial_numbers(before, left, after);
  candidate.tried_at.value = ranked.choice.nonlinear;
  candidate.tried_at.coefficients.assign(ranked.choice.columns.begin(), ranked.choice.columns.end());
  candidate.probability = ranked.probability;
  candidate.set = ranked.set;
  candidate.in_part = ranked.in_part;
  candidate.e_value = ranked.e_value;
  const double freedom = std::max<double>(1.0, static_cast<double>(ranked.choice.parameters));
  candidate.p_value =
      probability_from(minus_log_p(ranked.choice.gain, freedom, std::max(kFewestNoiseFreedom, after.noise.pure.dof)));
  candidate.skipped = in.regressors.acting(ranked.effect).skipped;
  candidate.parameters = quick_parameters(ranked, problem, whitener, in.regressors, in.problem.columns.cols());
  if (!candidate.parameters.empty()) candidate.size_alone = candidate.parameters.front().value;
  if (prove) {
    candidate.held_out_rms_before_um = held_out_before;
    candidate.held_out_rms_um =
        held_out_rms(in.regressors.data(), after.noise, after.left_out, parts, problem.columns, problem.target);
  }
  for (const EffectInstance& rival : ranked.rivals) {
    auto& rivals = candidate.rivals;
    if (!same_candidate(rival, ranked.effect) &&
        std::ranges::none_of(rivals, [&](const auto& one) { return same_candidate(one, rival); }))
      rivals.push_back(rival);
    const std::string name = to_text(rival);
    auto& list = candidate.indistinguishable_from;
    if (name != to_text(ranked.effect) || !same_sensors(rival, ranked.effect) ||
        rival.approach != ranked.effect.approach)
      if (std::ranges::find(list, name) == list.end()) list.push_back(name);
  }
  return candidate;
}

void take_parameters(Candidate& candidate, const EffectFit& after) {
  candidate.parameters = after.parameters;
  candidate.effect.curve = after.effect.curve;
  candidate.effect.fitted = after.effect.fitted;
  candidate.effect.parameters = after.effect.parameters;
}

/// All values that fit as well: of a place its interval; of a period each with its sizes beside the other effects
/// of the answer, and those of a wave of the model itself that may have changed places with it.
void state_sets(Candidate& candidate, const ReportInput& in, const std::vector<RankedCandidate>& order, std::size_t i,
                const Whitener& whitener, const Fit& after) {
  const RankedCandidate& ranked = order[i];
  const EffectDefinition& definition = ranked.effect.definition();
  std::vector<Choice> values = ranked.values;
  for (const double period : aliases_of(candidate.effect, in.regressors.data())) {
    if (values.empty()) values.push_back(ranked.choice);
    values.push_back(ranked.choice);
    values.back().nonlinear = period;
  }
  if (values.empty()) return;
  if (!definition.search.has_slope) {
    for (const Choice& value : values)
      candidate.parameters_set[std::string(definition.searched_parameter())].push_back(value.nonlinear);
    return;
  }
  LinearProblem others = in.problem;
  for (std::size_t j = 0; j < order.size(); ++j)
    if (j != i && order[j].in_answer())
      others = joined_with(others, columns_on(in.regressors, order[j].effect, order[j].choice));
  for (const Choice& value : values) {
    RankedCandidate at = ranked;
    at.choice = value;
    const LinearProblem problem = joined_with(others, columns_on(in.regressors, at.effect, at.choice));
    for (const ParameterEstimate& parameter :
         quick_parameters(at, problem, whitener, in.regressors, others.columns.cols()))
      candidate.parameters_set[parameter.name].push_back(parameter.value);
  }
  for (const std::size_t own : in.base.own)
    if (same_candidate(in.model.effects[own], candidate.effect))
      for (const ParameterEstimate& parameter : after.effects[own].parameters)
        candidate.parameters_set[parameter.name].push_back(parameter.value);
  if (candidate.parameters_set.begin()->second.size() < 2) return candidate.parameters_set.clear();
  const std::string searched(definition.searched_parameter());
  const auto fitted = std::ranges::find(candidate.parameters, searched, &ParameterEstimate::name);
  if (fitted == candidate.parameters.end()) return;
  const std::vector<double> found = candidate.parameters_set[searched];
  const auto own = std::ranges::min_element(found, {}, [&](double value) { return std::abs(value - fitted->value); });
  for (const ParameterEstimate& one : candidate.parameters)  // as stated beside it
    if (const auto of = candidate.parameters_set.find(one.name); of != candidate.parameters_set.end())
      of->second[static_cast<std::size_t>(own - found.begin())] = one.value;
}

std::vector<Dependence> dependences(const Observations& data, const VectorXd& residual, const NoiseModel& noise,
                                    const std::vector<StructureTest>& tests) {
  const auto chance_of = [&](const std::string& variable) {
    const auto test = std::ranges::find(tests, variable, &StructureTest::variable);
    return test == tests.end() ? 1.0 : probability_from(test->minus_log_p);
  };
  const auto is_telling = [&](const std::string& variable) { return chance_of(variable) < kTellingChance; };
  std::vector<Dependence> list;
  for (const NamedShare& of : shares_by_variable(data, residual, noise.pure.noise_um, is_telling)) {
    Dependence one{of.variable, of.share, chance_of(of.variable), {}, {}};
    const ResidualView view = residual_view(
        data, std::vector<double>(residual.data(), residual.data() + residual.size()), of.variable, kMostBins);
    for (const ResidualBin& bin : view.bins) {
      one.at.push_back(0.5 * (bin.from + bin.to));
      one.mean_um.push_back(bin.mean_um);
    }
    if (one.strength > kTellingShare) list.push_back(std::move(one));
  }
  sort_greatest_first(list, [](const Dependence& one) { return one.strength; });
  return list;
}

/// "No effects of the library explain all readings of EZ along Z: this line is judged apart from the others."
std::string words_for_lines_apart(const std::vector<std::string>& apart) {
  std::vector<std::string> lines;
  for (const std::string& line : apart) {
    const auto end = line.find(':');
    lines.push_back(fmt::format("{} along {}", line.substr(end + 1), line.substr(0, end)));
  }
  return fmt::format("No effects of the library explain all readings of {}: {} judged apart from the others.",
                     fmt::join(lines, " and "), lines.size() > 1 ? "each of these lines is" : "this line is");
}

/// A sentence on the measured lines on which no effect of the model acts, not even an offset; "" where there is none.
std::string unmodelled_lines(const Model& model, const Regressors& regressors) {
  const Observations& data = regressors.data();
  if (!data.paths.empty() || !data.through_chain.empty()) return "";
  std::vector<bool> acted_on(data.size(), false);
  for (const EffectInstance& effect : model.effects)
    for (const std::size_t k : regressors.acting(effect).rows) acted_on[k] = true;
  std::set<std::string> lines;
  for (std::size_t k = 0; k < data.size(); ++k)
    if (!acted_on[k]) lines.insert(fmt::format("{} along {}", name_of(data.sense[k]), data.letter(data.axis[k])));
  if (lines.empty()) return "";
  return fmt::format(
      "The model has no effect, not even an offset, of {}: `ecs model new` makes a model of the measured lines. ",
      fmt::join(lines, ", "));
}

Diagnosis too_few(const Observations& data, const Base& base) {
  Diagnosis diagnosis;
  diagnosis.observations = data.size();
  diagnosis.rms_um = diagnosis.rms_after_um = rms_of(base.residual);
  diagnosis.noise = base.core.noise.pure;
  diagnosis.notes.push_back(
      fmt::format("{} reading{} for {} fitted parameter{}: too few to decide whether an effect is missing. Measure "
                  "more targets and repeats",
                  data.size(), data.size() == 1 ? "" : "s", base.core.rank, base.core.rank == 1 ? "" : "s"));
  diagnosis.verdict = Verdict::cannot_tell;
  diagnosis.cannot_tell = diagnosis.notes.back();
  diagnosis.reservation = diagnosis.notes.back() + ".";
  diagnosis.headline = diagnosis.reservation;
  return diagnosis;
}

/// Readings of a ball at one pose are left out together, each pose once, of many poses twenty parts; else as elsewhere.
Parts parts_by_pose(const Observations& data) {
  constexpr std::size_t kMostParts = 20;
  if (data.through_chain.empty()) return parts_of(data);
  Parts parts;
  std::map<std::pair<Vector3, Vector3>, std::size_t> poses;
  for (std::size_t k = 0; k < data.size(); ++k)
    parts.of.push_back(poses.try_emplace({data.position_mm[k], data.place_mm[k]}, poses.size()).first->second);
  parts.count = std::min(poses.size(), kMostParts);
  for (std::size_t& part : parts.of) part %= parts.count;
  return parts;
}

/// Of a sum of effects of which readings left out speak against one member after the other, those members that predict
/// readings left out best together, where that is at least half of what they explain of the fitted ones: alone each
/// may do worse than none. Nothing for a single one: that has been judged already.
/// @param before  the model with what is proved
std::optional<ProposedAddition> proposed_group(const ReportInput& in, const LinearProblem& before,
                                               const std::vector<RankedCandidate>& order) {
  const Found& found = in.found;
  const bool runs_differ = found.bad_run || found.noisy || found.odd_pass || found.step || found.wave;
  if (found.taken_back.size() < 2 || runs_differ || !found.objection.empty()) return std::nullopt;
  const Observations& data = in.regressors.data();
  const CoreFit& core = in.base.core;
  const Whitener whitener(data, core.noise, core.left_out);
  const Parts parts = parts_by_pose(data);
  const auto held_out = [&](const LinearProblem& of) {
    return held_out_rms(data, core.noise, core.left_out, parts, of.columns, of.target);
  };
  const auto fitted = [&](const LinearProblem& of) { return rms_without(residual_of(of, whitener), core.left_out); };
  const auto fall = [](double from, double to) { return from * from - to * to; };
  ProposedAddition best;
  best.held_out_rms_before_um = best.held_out_rms_um = held_out(before);
  for (std::size_t set = 1; set < std::size_t{1} << found.taken_back.size(); ++set) {
    LinearProblem with = before;
    std::vector<std::string> names;
    for (std::size_t i = 0; i < found.taken_back.size(); ++i) {
      const Choice& choice = found.taken_back[i];
      const EffectInstance effect = effect_of(found.families[choice.family].effect, choice);
      const auto is_proved = [&](const RankedCandidate& one) {
        return one.standing == Standing::proved && same_candidate(one.effect, effect);
      };
      if ((set >> i & 1U) == 0 || std::ranges::any_of(order, is_proved)) continue;
      with = joined_with(with, columns_on(in.regressors, effect, choice));
      names.push_back(to_text(effect));
    }
    if (names.size() < 2) continue;
    const double held_out_um = held_out(with);
    if (held_out_um >= best.held_out_rms_um) continue;
    if (fall(best.held_out_rms_before_um, held_out_um) < kLeastCrossValidatedAlone * fall(fitted(before), fitted(with)))
      continue;
    best.effects = std::move(names);
    best.held_out_rms_um = held_out_um;
  }
  return best.effects.empty() ? std::nullopt : std::optional(std::move(best));
}

/// Adding what is likely beside what is proved, and the fall to expect; a group where nothing is likely.
std::optional<ProposedAddition> proposed_addition(const ReportInput& in, const std::vector<RankedCandidate>& order,
                                                  const FittedWith& with, const Parts& parts) {
  LinearProblem before = in.problem;
  ProposedAddition add;
  for (const RankedCandidate& ranked : order)
    if (ranked.standing == Standing::proved)
      before = joined_with(before, columns_on(in.regressors, ranked.effect, ranked.choice));
  LinearProblem after = before;
  for (const RankedCandidate& ranked : order)
    if (ranked.standing == Standing::likely) {
      after = joined_with(after, columns_on(in.regressors, ranked.effect, ranked.choice));
      add.effects.push_back(to_text(ranked.effect));
    }
  if (add.effects.empty()) return proposed_group(in, before, order);
  const auto held_out = [&](const LinearProblem& of) {
    return held_out_rms(in.regressors.data(), with.noise, with.left_out, parts, of.columns, of.target);
  };
  add.held_out_rms_before_um = held_out(before);
  add.held_out_rms_um = held_out(after);
  return add;
}

/// What all effects of the answer do together; nothing for fewer than two.
std::optional<JointProof> joint_proof(const ReportInput& in, const std::vector<RankedCandidate>& order,
                                      const FittedWith& with, const Parts& parts, double held_out_before) {
  LinearProblem all = in.problem;
  std::size_t named = 0;
  for (const RankedCandidate& ranked : order) {
    if (!ranked.in_answer()) continue;
    all = joined_with(all, columns_on(in.regressors, ranked.effect, ranked.choice));
    ++named;
  }
  if (named < 2) return std::nullopt;
  return JointProof{rms_without(with.left, with.left_out), held_out_before,
                    held_out_rms(in.regressors.data(), with.noise, with.left_out, parts, all.columns, all.target)};
}

Result<NamedCauses> names_alone(const ReportInput&, const Answer& answer) {
  NamedCauses names{answer.verdict, {}, 1.0};
  for (const RankedCandidate& ranked : answer.order) {
    if (ranked.standing == Standing::possible) continue;
    NamedCause cause{to_text(ranked.effect),
                     ranked.probability,
                     ranked.e_value,
                     ranked.false_naming,
                     ranked.p_value,
                     ranked.standing,
                     {}};
    for (const auto& rival : ranked.rivals) cause.rivals.push_back(place_text(rival));
    double alone = ranked.p_value_alone;
    if (ranked.standing == Standing::likely && !answer.explained)  // against noise alone it says nothing
      alone = cause.p_value = 1.0 / std::max(1.0, ranked.e_value.value_or(1.0));
    names.causes.push_back(std::move(cause));
    names.p_value = std::min(names.p_value, alone);
  }
  return names;
}

/// What looks the same as an effect of the answer, a curve that keeps its slope, where its lever is the same everywhere
/// and no curve without slope is a rival of it.
std::optional<std::string> slope_note(const Candidate& one, const Regressors& regressors) {
  const auto is_curve = [](const EffectInstance& effect, bool keeps_slope) {
    return effect.traits().is_curve && !effect.traits().of_approach && effect.traits().keeps_slope == keeps_slope;
  };
  if (!one.in_answer() || !is_curve(one.effect, true) || regressors.lever_varies(one.effect) ||
      std::ranges::any_of(one.rivals, [&](const EffectInstance& rival) { return is_curve(rival, false); }))
    return std::nullopt;
  return fmt::format(
      "a scale error and a smooth error along the travel together would have the same shape in these readings as {0}. "
      "{0} is named because one cause is more probable than two. To exclude the two, measure a second line at another "
      "distance",
      place_text(one.effect));
}

/// That axes may share a scale error, where circles and diagonals alone show it.
std::optional<std::string> share_note(const Candidate& one) {
  const auto is_scale = [](const EffectInstance& effect) {
    return effect.definition().id == "scale" && effect.sense && effect.axis &&
           direction_of(*effect.sense) == *effect.axis && !is_rotation(*effect.sense);
  };
  if (!one.in_answer() || !is_scale(one.effect)) return std::nullopt;
  const auto other = std::ranges::find_if(one.rivals, is_scale);
  if (other == one.rivals.end()) return std::nullopt;
  const char a = letter_of(*one.effect.axis), b = letter_of(*other->axis);
  return fmt::format(
      "these readings show one combination of the scale errors of {} and {} only, on a circle their difference: each "
      "axis may have a part of it. Measure a line along {} or {}",
      a, b, a, b);
}

/// From where the lever of an angle of the answer is counted, if the machine file does not state it and no line of the
/// axis lies there: then what is the same in all lines looks like another cause.
std::optional<std::string> lever_note(const Candidate& one, const Regressors& regressors) {
  if (!one.in_answer() || !one.effect.traits().keeps_slope || !one.effect.code || !regressors.lever_varies(one.effect))
    return std::nullopt;
  const Observations& data = regressors.data();
  for (const Term& term : data.terms) {
    if (term.component != *one.effect.code || !term.has_lever || !term.uses_coordinate) continue;
    const Axis axis = moving_axis(term.component);
    const auto& facts = data.machine.axes[index_of(axis)];
    if (!facts || facts->measurement_line_mm[index_of(term.lever)]) continue;
    std::optional<double> first;
    bool is_there = false;
    for (std::size_t k = 0; k < data.size(); ++k) {
      if (data.on_path(k) || data.axis[k] != axis || data.sense[k] != static_cast<Sense>(term.observed)) continue;
      const double at_mm = data.position_mm[k][index_of(term.lever)];
      is_there = is_there || std::abs(at_mm) < kSamePlace_mm;
      if (!first) first = at_mm;
    }
    if (!first || is_there) continue;
    const char lever = small_letter_of(term.lever);
    return fmt::format(
        "the lever of {0} is counted from {1} = 0 mm, where no line along {2} lies: the machine file does not state "
        "another place. A smooth error that is equal in all lines may be part of this angle. State the line on which "
        "{2} was measured in [axis.{2}], for example measurement_line_mm = {{ {1} = {3:.1f} }}",
        place_text(one.effect), lever, letter_of(axis), *first);
  }
  return std::nullopt;
}

/// "a part of machine_bending (z_sin_um, z_cos_um) may be head_bending instead: …"
std::string note_of(const RivalOfPart& rival) {
  std::vector<std::string_view> sizes;
  for (const ParameterDefinition& size : rival.part.definition().parameters)
    if (!rival.part.parameters.contains(std::string(size.name))) sizes.push_back(size.name);
  return fmt::format("a part of {} ({}) may be {} instead: these data do not distinguish them. {}",
                     place_text(rival.part), fmt::join(sizes, ", "), place_text(rival.other),
                     separating_measurement(rival.part, {rival.other}));
}

Result<Diagnosis> reported(const ReportInput& in, const Answer& answer) {
  const Observations& data = in.regressors.data();
  const VectorXd before = told_residual(in.model, data, in.options.plain, in.base.residual);
  Diagnosis diagnosis;
  diagnosis.observations = data.size();
  diagnosis.rms_um = rms_of(before);
  diagnosis.candidates_tried = in.found.candidates_tried;
  diagnosis.noise_replicates = in.found.replicate_scores.size();
  diagnosis.replicates_wanted = in.options.noise_replicates;
  const auto& [verdict, order, cannot_tell, other_unit, explained, apart] = answer;
  diagnosis.verdict = verdict;
  diagnosis.apart = apart;
  diagnosis.own_terms = in.own;
  std::vector<FoundEffect> in_answer;
  for (const RankedCandidate& ranked : order)
    if (ranked.in_answer()) in_answer.push_back({ranked.effect, ranked.choice});
  const bool may_wander = in_answer.empty() && !in.found.stands_out && in.found.entry_score < kBeyondAll;
  const WanderScores wander = may_wander ? in.found.wander_scores() : WanderScores{};
  diagnosis.noise_wanders = !wander.scores.empty();
  const bool is_alone = in_answer.empty() && in.own.empty();
  ECS_TRY(with, is_alone ? Result<FittedWith>(fitted_alone(in.base, before))
                         : fitted_with(in.model, in.own, in_answer, in.regressors, in.options.plain));
  const auto& [after, left, noise, left_out] = with;
  const Whitener whitener(data, noise, left_out);
  diagnosis.rms_after_um = rms_of(left);
  diagnosis.kept_rms_um = rms_without(before, left_out);
  diagnosis.kept_rms_after_um = rms_without(left, left_out);
  const auto by_unit = [&data](const VectorXd& residual, const std::vector<bool>& out) {
    return rms_by_unit(data, {residual.data(), data.size()}, out);
  };
  diagnosis.rms_by_unit = by_unit(before, {});
  diagnosis.rms_after_by_unit = by_unit(left, {});
  diagnosis.kept_by_unit = by_unit(before, left_out);
  diagnosis.kept_after_by_unit = by_unit(left, left_out);
  const auto motions = motions_of_groups(data, left);
  if (motions && verdict == Verdict::adequate) diagnosis.verdict = Verdict::unexplained_structure;
  diagnosis.noise = noise.pure;
  diagnosis.outliers = after.outliers;
  diagnosis.lack_of_fit =
      lack_of_fit_of(data, in.base.residual, noise, left_out, static_cast<double>(in.base.core.rank));
  diagnosis.lack_of_fit_after = after.lack_of_fit;

  const Parts parts = parts_of(data);
  const double held_out_before =
      order.empty() ? 0.0 : held_out_rms(data, noise, left_out, parts, in.problem.columns, in.problem.target);
  for (std::size_t i = 0; i < order.size(); ++i) {
    Candidate candidate = candidate_of(in, order[i], before, whitener, parts, with, held_out_before, i < kMostProved);
    candidate.false_naming = false_naming_of(in.found, wander, order[i]);
    candidate.found = order[i].found;
    candidate.apart = order[i].apart;
    if (order[i].in_answer()) {  // these are first
      take_parameters(candidate, after.effects[in.model.effects.size() + i]);
      state_sets(candidate, in, order, i, whitener, after);
    }
    for (const ParameterEstimate& parameter : candidate.parameters)
      if (!parameter.held) candidate.effect.fitted.try_emplace(parameter.name, parameter.value);
    const std::vector<EffectInstance> open = candidate.open_rivals();
    const bool is_aliased = candidate.effect.rotary && candidate.effect.traits().periodic && open.empty() &&
                            !candidate.parameters_set.empty();
    candidate.next_measurement = is_aliased ? fmt::format("Measure {} again at targets displaced from equal steps.",
                                                          axis_letter(candidate.effect))
                                            : separating_measurement(candidate.effect, open);
    if (candidate.standing == Standing::likely) {
      candidate.but = order[i].doubt.but;
      candidate.decide = order[i].doubt.decide;
      if (open.empty()) candidate.next_measurement = candidate.decide + ".";
    }
    diagnosis.candidates.push_back(std::move(candidate));
  }
  diagnosis.add = proposed_addition(in, order, with, parts);
  const auto joint = joint_proof(in, order, with, parts, held_out_before);
  for (Candidate& candidate : diagnosis.candidates) candidate.because = reason_for(candidate, diagnosis, data, joint);
  diagnosis.where = dependences(data, before, noise, in.found.beyond_position);
  const bool of_run = in.found.bad_run || in.found.odd_pass || in.found.noisy || in.found.step;
  const std::optional<ScaledRun> scaled =
      of_run || !in.found.run_note.empty() || (verdict == Verdict::unexplained_structure && !is_wave_in_time(in.found))
          ? scaled_run(data)
          : std::nullopt;
  if (of_run || scaled) put_run_first(diagnosis.where, data, in.found, scaled, in.base.residual, kTellingChance);
  if (motions) put_motions_first(diagnosis.where, *motions);
  diagnosis.different_run = different_run(in.found, scaled, diagnosis, data, in.base.residual);
  for (const EffectInstance& effect : in.model.effects)
    if (std::string note = note_of_no_reading(effect, data, in.regressors.acting(effect)); !note.empty())
      diagnosis.notes.push_back(std::move(note));
  for (std::string& note : untried_effects(data)) diagnosis.notes.push_back(std::move(note));
  if (const auto note = even_targets_note(data)) diagnosis.notes.push_back(*note);
  for (const Candidate& candidate : diagnosis.candidates)
    for (const auto& note :
         {slope_note(candidate, in.regressors), lever_note(candidate, in.regressors), share_note(candidate)})
      if (note) diagnosis.notes.push_back(*note);
  for (const Candidate& candidate : diagnosis.candidates)
    for (const RivalOfPart& rival : candidate.in_part)
      if (candidate.in_answer()) diagnosis.notes.push_back(note_of(rival));
  if (!in.found.run_note.empty() && !scaled) diagnosis.notes.push_back(in.found.run_note);
  const bool structure = diagnosis.verdict == Verdict::unexplained_structure ||
                         diagnosis.verdict == Verdict::partly_explained ||
                         (diagnosis.verdict == Verdict::likely_effect && !noise_left(in.found, in.options));
  const bool tells_why = structure && !diagnosis.different_run &&
                         (!in.found.solution.chosen.empty() || in.found.noisy || in.found.odd_pass ||
                          in.found.wanders || in.found.wave || !in.found.objection.empty());
  const bool why_in_headline = tells_why && diagnosis.verdict == Verdict::unexplained_structure &&
                               !in.found.objection.empty() &&
                               std::ranges::none_of(diagnosis.candidates, &Candidate::in_answer);
  if (tells_why && !why_in_headline) diagnosis.notes.push_back(why_not_explained(in.found));
  if (const auto note = sensor_noise_note(diagnosis, data, structure || verdict == Verdict::cannot_tell))
    diagnosis.notes.push_back(*note);
  if (structure) describe_what_is_left(diagnosis, data, after.residual, left_out);
  if (structure || (verdict == Verdict::cannot_tell && leaves_structure(in.found, in.options))) {
    LinearProblem all = in.problem;
    for (const FoundEffect& found : in_answer)
      all = joined_with(all, columns_on(in.regressors, found.effect, found.choice));
    Left what = what_is_left(in.model, data, all, with);
    diagnosis.left = std::move(what.properties);
    const auto is_of_run = [](const UserFormula& of) { return of.text.find("(run ==") != std::string::npos; };
    const bool only_of_run =  // which is no error of the machine
        diagnosis.different_run && what.formula && std::ranges::any_of(what.formula->effect.formulas, is_of_run);
    if (!only_of_run) diagnosis.formula = std::move(what.formula);
  }
  if (in.found.noisy && !in.found.noisy->off_um && diagnosis.different_run)
    if (const std::string condition = condition_of_runs(diagnosis.left); !condition.empty())
      diagnosis.different_run->text =
          fmt::format("R{}, because the residual changes with {} (see the properties of the residual).",
                      words_for(*in.found.noisy).substr(1), condition);
  if (structure && std::ranges::any_of(data.paths, [](const Path& path) { return path.kind == PathKind::circle; })) {
    const std::string advice = advice_on(kReversalOnCircle);
    diagnosis.notes.push_back(
        fmt::format("friction causes a different spike at a reversal than `reversal_spike` describes{}{}",
                    advice.empty() ? "" : "; ", advice));
  }
  for (const std::string& note : data.notes) diagnosis.notes.push_back(note);
  if (const std::span residual(in.base.residual.data(), data.size()); !in.found.noise.relative.empty())
    diagnosis.notes.push_back(
        words_for(stated_uncertainty(data, residual, diagnosis.noise.noise_um), diagnosis.noise.unit));
  diagnosis.reservation = reservation_for(data, names_a_wave(diagnosis));
  diagnosis.cannot_tell = cannot_tell;
  diagnosis.best_sum_leaves = !in.found.solution.chosen.empty() && leaves_structure(in.found, in.options);
  const auto passes = diagnosis.verdict == Verdict::adequate
                          ? scatter_of_passes(data, in.base.residual, in.base.core.left_out)
                          : std::nullopt;
  diagnosis.headline =
      headline_for(diagnosis, data, diagnosis.different_run ? diagnosis.different_run->text : run_note(in.found),
                   passes.has_value());
  if (why_in_headline) diagnosis.headline += fmt::format(" No effect is named, because {}.", why_not_named(in));
  if (!apart.empty()) diagnosis.headline += " " + words_for_lines_apart(apart);
  diagnosis.headline += beside_formulas(in.model, diagnosis);
  if (std::ranges::any_of(in.model.effects, [](const auto& effect) { return !effect.tied_with.empty(); }) ||
      std::ranges::find(in.base.core.undetermined, true) != in.base.core.undetermined.end())
    diagnosis.headline += undecided_text(in.model, data);
  if (motions) diagnosis.headline = words_for(*motions) + " " + diagnosis.headline;
  if (!other_unit.empty()) diagnosis.headline = other_unit + " " + diagnosis.headline;
  if (diagnosis.verdict != Verdict::adequate)
    diagnosis.headline = unmodelled_lines(in.model, in.regressors) + diagnosis.headline;
  if (passes)
    diagnosis.headline += fmt::format(
        " Each pass has a zero of its own: passes differ by {:.3g} {} (one standard deviation), but readings within a "
        "pass by {:.3g}. No map corrects that: check datum, lost motion, clamping and instrument.",
        passes->between_um, in.found.noise.pure.unit, passes->within_um);
  return diagnosis;
}

/// Effects that may be missing at once from readings along paths, or of a ball: what a line's new model holds from the
/// start, slopes and lost motion, is there among what is sought, and all readings show the errors of several axes.
constexpr std::size_t kMostOfSeveralAxes = 6;

/// Searches the readings, and answers.
/// @param answered  from a ReportInput about all readings, and what it says of each candidate
template <class Answered>
Result<Answered> searched_and(Result<Answered> (*answered)(const ReportInput&, const Answer&), const Model& model,
                              const Regressors& regressors, const Base& base, const DiagnoseOptions& options) {
  ECS_TRY(found, found_in(model, regressors, base, options));
  const auto from = [&](const std::vector<OwnTerm>& own) {
    return ReportInput{model, regressors, base, own, problem_with_own(model, base, regressors, own), found, options};
  };
  const std::vector<OwnTerm> own = own_terms_of(found, base);
  const ReportInput in = from(own);
  const Answer answer = answer_of(in);
  ECS_TRY(apart, judged_apart(in, answer));
  return apart ? answered(from(apart->own), apart->answer) : answered(in, answer);
}

bool names_any(const Diagnosis& diagnosis) { return std::ranges::any_of(diagnosis.candidates, &Candidate::in_answer); }
bool names_any(const NamedCauses& causes) { return !causes.causes.empty(); }

/// @param few  what is said where there are too few readings to say anything
template <class Answered, class Few>
Result<Answered> diagnosed(Result<Answered> (*answer)(const ReportInput&, const Answer&), const Few& few,
                           const Model& model, const Observations& data, DiagnoseOptions options) {
  if (data.size() == 0) return problem(ProblemKind::bad_input, "no readings to diagnose");
  options.most_effects *= axes_moved(data);
  if (!data.paths.empty() || !data.through_chain.empty())
    options.most_effects = std::max(options.most_effects, kMostOfSeveralAxes);
  try {
    const Regressors regressors(data);
    ECS_TRY(base, base_of(model, regressors, options.plain));
    const double spare = static_cast<double>(data.size()) - static_cast<double>(base.core.rank);
    if (spare < kFewestToName) return few(base);
    auto found = searched_and(answer, model, regressors, base, options);
    return spare < kFewestSpare && found && !names_any(*found) ? few(base) : found;
  } catch (const SearchStopped&) {
    return problem(ProblemKind::refused, "the diagnosis was stopped before its end");
  }
}

}  // namespace

bool Candidate::is_open(const EffectInstance& rival) const {
  return set.empty() || std::ranges::find(set, place_text(rival), &SetMember::place) != set.end();
}

std::vector<EffectInstance> Candidate::open_rivals() const {
  std::vector<EffectInstance> open;
  for (const EffectInstance& rival : rivals)
    if (is_open(rival)) open.push_back(rival);
  return open;
}

Result<Diagnosis> diagnose(const Model& model, const Observations& all, const DiagnoseOptions& options) {
  const Observations data = with_sensors(all);
  auto diagnosis = diagnosed<Diagnosis>(
      reported, [&](const Base& base) { return too_few(data, base); }, model, data, options);
  if (diagnosis && diagnosis->candidates_tried > 0 && data.size() > options.largest_search)
    diagnosis->notes.push_back(fmt::format("searched on {} evenly chosen readings; sizes and evidence from all {}",
                                           searched_part(data, options.largest_search).size(), data.size()));
  if (const auto note = note_of_missing_sensors(all); note && diagnosis) diagnosis->notes.push_back(*note);
  return diagnosis;
}

Result<NamedCauses> named_causes(const Model& model, const Observations& data, const DiagnoseOptions& options) {
  return diagnosed<NamedCauses>(
      names_alone,
      [](const Base&) {
        return NamedCauses{Verdict::cannot_tell, {}, 1.0};
      },
      model, with_sensors(data), options);
}

}  // namespace ecs::model
