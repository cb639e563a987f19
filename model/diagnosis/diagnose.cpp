// The answer from a search: candidates in order of evidence, their proof by cross-validation (Stone 1974), the chance
// of a false name from replicates of noise (Westfall and Young 1993).
#include "model/diagnosis/diagnose.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "model/data/even_targets.hpp"
#include "model/diagnosis/bad_run_report.hpp"
#include "model/diagnosis/investigation.hpp"
#include "model/diagnosis/shape.hpp"
#include "model/diagnosis/trial.hpp"
#include "model/diagnosis/wander.hpp"
#include "model/diagnosis/waves.hpp"
#include "model/diagnosis/words.hpp"
#include "model/effects/definition.hpp"
#include "model/fit/compare.hpp"
#include "model/fit/held_out.hpp"
#include "model/fit/report.hpp"
#include "model/fit/statistics.hpp"
#include "model/regression/needs.hpp"

namespace ecs::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Candidates listed, and of them those that are proved on readings not fitted to: what a person reads, and pays for.
constexpr std::size_t kMostListed = 12, kMostProved = 4;
/// Probabilities are given down to 1e-300: below, a double ends.
constexpr double kMostDigits = 300.0;
/// Bins in which a dependence is shown: a choice; a line on a screen.
constexpr std::size_t kMostBins = 24;
/// A dependence that noise alone shows more often, or of a smaller share of the residual, is not ranked.
constexpr double kTellingChance = 1e-3, kTellingShare = 0.01;
/// Readings beyond the fitted parameters below which nothing can be said: F(1, 6) exceeds 6 in one case of twenty.
constexpr double kFewestSpare = 6.0;

/// A credible set holds the cause with this probability; proved causes explain the residual in part from this share of
/// what is above noise on; what is likely is as good in no more of the sets of noise: the verdicts of docs/model.md.
constexpr double kCredible = 0.99, kPartExplained = 0.5, kLikelyChance = 0.01;
/// A wave alone explains nearly all of what is above noise from this share on: one whose size changes by no more than
/// two fifths of it along the travel does (1 - 0.16/3).
constexpr double kNearlyAll = 0.95;
/// Least share of what an effect explains that it predicts at left-out targets where more is left than noise: as where
/// nothing but the effect speaks against noise (investigation.hpp).
constexpr double kLeastPredicted = kLeastCrossValidatedAlone;
/// Readings that an effect was not fitted to speak for it from this e-value on.
constexpr double kSpeaksFor = 1.0;
/// Without repeats what a model leaves is no noise where readings left out are missed by more than so many times the
/// rms of those fitted: two, for four times the squares are no chance.
constexpr double kMostHeldOut = 2.0;
constexpr std::size_t kPartsLeftOut = 5;
/// What is left below this is rounding: no instrument reads a nanometre [um].
constexpr double kNothingLeft_um = 1e-3;

double probability_from(double minus_log_p) { return std::pow(10.0, -std::min(kMostDigits, minus_log_p)); }

/// The candidates in the order in which they are ranked, each with its part in the answer.
struct RankedCandidate {
  EffectInstance effect;
  Choice choice;
  Standing standing = Standing::possible;
  std::vector<EffectInstance> rivals;
  double probability = 0.0;
  std::vector<SetMember> set{};
  std::vector<Choice> values{};  ///< of the searched parameter that fit as well
  std::optional<double> e_value{};
  bool wander = false;
  double p_value = 1.0, p_value_alone = 1.0;
  [[nodiscard]] bool in_answer() const { return standing != Standing::possible; }
};

/// The fewest alternatives whose probabilities reach kCredible together (narrowest group: Spector and Janson 2022).
std::vector<SetMember> credible_set(std::vector<SetMember> alternatives) {
  sort_greatest_first(alternatives, [](const SetMember& member) { return member.probability; });
  double sum = 0.0;
  std::size_t count = 0;
  while (count < alternatives.size() && sum < kCredible) sum += alternatives[count++].probability;
  alternatives.resize(count);
  return alternatives;
}

/// @param standings  of the members of the solution; the proved ones come first, then what is likely
std::vector<RankedCandidate> ranked_candidates(const Found& found, const std::vector<Standing>& standings) {
  std::vector<RankedCandidate> list;
  const auto instance = [&](const Choice& choice) { return effect_of(found.families[choice.family].effect, choice); };
  std::vector<const Group*> groups;
  for (const Group& group : found.groups) groups.push_back(&group);
  const auto standing_of = [&](const Group* group) {
    return standings[static_cast<std::size_t>(group - found.groups.data())];
  };
  sort_greatest_first(groups, [](const Group* group) { return group->member.gain; });
  std::stable_sort(groups.begin(), groups.end(),
                   [&](const Group* a, const Group* b) { return standing_of(a) > standing_of(b); });
  const auto listed = [&](const EffectInstance& effect) {
    return std::any_of(list.begin(), list.end(),
                       [&](const RankedCandidate& t) { return same_candidate(t.effect, effect); });
  };
  std::vector<std::map<std::string, double>> probability_in(groups.size());
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const Group& group = *groups[g];
    std::vector<Choice> alternatives{group.member};
    alternatives.insert(alternatives.end(), group.rivals.begin(), group.rivals.end());
    alternatives.insert(alternatives.end(), group.weaker.begin(), group.weaker.end());
    const std::vector<double> shares = probabilities_of(alternatives, found.families);
    std::vector<SetMember> members;
    for (std::size_t i = 0; i < alternatives.size(); ++i) {
      const EffectInstance member = instance(alternatives[i]);
      members.push_back({to_text(member), shares[i], place_text(member)});
      probability_in[g].try_emplace(members.back().name, shares[i]);
    }
    RankedCandidate one{instance(group.member), group.member,
                        standing_of(&group),    {},
                        shares.front(),         credible_set(std::move(members)),
                        group.values,           group.e_value,
                        group.wander,           group.p_value,
                        group.p_value_alone};
    for (const Choice& rival : group.rivals) one.rivals.push_back(instance(rival));
    list.push_back(std::move(one));
  }
  const std::size_t members = list.size();
  const auto probability_of = [&](std::size_t g, const EffectInstance& effect) {
    const auto found_in = probability_in[g].find(to_text(effect));
    return found_in == probability_in[g].end() ? 0.0 : found_in->second;
  };
  for (std::size_t g = 0; g < members; ++g)
    for (const Choice& rival : groups[g]->rivals) {
      if (listed(instance(rival))) continue;
      RankedCandidate one{
          instance(rival), rival, Standing::possible, {list[g].effect}, probability_of(g, instance(rival)),
          list[g].set};
      for (const Choice& other : groups[g]->rivals)
        if (other.family != rival.family) one.rivals.push_back(instance(other));
      list.push_back(std::move(one));
    }
  for (std::size_t g = 0; g < members; ++g)
    for (const Choice& weaker : groups[g]->weaker)
      if (!listed(instance(weaker)) && list.size() < kMostListed)
        list.push_back({instance(weaker), weaker, Standing::possible, {}, probability_of(g, instance(weaker)), {}});
  if (list.empty()) {  // nothing found: the closest, against none, beforehand as likely as all candidates together
    std::vector<Choice> alternatives = found.closest;
    alternatives.emplace_back().gain =
        2.0 * std::log(static_cast<double>(std::max<std::size_t>(found.candidates_tried, 1)));
    const std::vector<double> shares = probabilities_of(alternatives, found.families);
    for (std::size_t i = 0; i < found.closest.size(); ++i)
      list.push_back({instance(found.closest[i]), found.closest[i], Standing::possible, {}, shares[i], {}});
  }
  return list;
}

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

struct ReportInput {
  const Model& model;
  const Regressors& regressors;
  const Base& base;
  const std::vector<OwnTerm>& own;  ///< where the solution has them
  const LinearProblem problem;      ///< of the model with them
  const Found& found;
  const DiagnoseOptions& options;
};

double false_naming_of(const Found& found, const Choice& choice) {
  const double least = 1.0 / (static_cast<double>(found.replicate_scores.size()) + 1.0);  // they show no less
  return std::max(least, tail_probability(found.replicate_scores, choice.score()));
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
                                      in.regressors.data(), in.options.plain);
  const TrialNumbers numbers = trial_numbers(before, left, after);
  candidate.rms_after_um = numbers.rms_after_um;
  candidate.explained = numbers.explained;
  candidate.kept_rms_before_um = numbers.kept_rms_before_um;
  candidate.kept_rms_after_um = numbers.kept_rms_after_um;
  candidate.explainable_share = numbers.explainable_share;
  candidate.tried_at.value = ranked.choice.nonlinear;
  candidate.tried_at.coefficients.assign(ranked.choice.columns.begin(), ranked.choice.columns.end());
  candidate.probability = ranked.probability;
  candidate.set = ranked.set;
  candidate.e_value = ranked.e_value;
  const double freedom = std::max<double>(1.0, static_cast<double>(ranked.choice.parameters));
  candidate.p_value =
      probability_from(minus_log_p(ranked.choice.gain, freedom, std::max(kFewestNoiseFreedom, after.noise.pure.dof)));
  candidate.false_naming = false_naming_of(in.found, ranked.choice);
  candidate.skipped = in.regressors.acting(ranked.effect).skipped;
  candidate.parameters = quick_parameters(ranked, problem, whitener, in.regressors, in.problem.columns.cols());
  if (prove) {
    candidate.held_out_rms_before_um = held_out_before;
    candidate.held_out_rms_um =
        held_out_rms(in.regressors.data(), after.noise, after.left_out, parts, problem.columns, problem.target);
  }
  for (const EffectInstance& rival : ranked.rivals) {
    auto& rivals = candidate.rivals;
    if (!same_candidate(rival, ranked.effect) &&
        std::none_of(rivals.begin(), rivals.end(), [&](const auto& one) { return same_candidate(one, rival); }))
      rivals.push_back(rival);
    const std::string name = to_text(rival);
    auto& list = candidate.indistinguishable_from;
    if (name != to_text(ranked.effect) || !same_sensors(rival, ranked.effect) ||
        rival.approach != ranked.effect.approach)
      if (std::find(list.begin(), list.end(), name) == list.end()) list.push_back(name);
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
  if (ranked.values.empty()) return;
  if (!definition.search.has_slope) {
    for (const Choice& value : ranked.values)
      candidate.parameters_set[std::string(definition.searched_parameter())].push_back(value.nonlinear);
    return;
  }
  LinearProblem others = in.problem;
  for (std::size_t j = 0; j < order.size(); ++j)
    if (j != i && order[j].in_answer())
      others = joined_with(others, columns_on(in.regressors, order[j].effect, order[j].choice));
  for (const Choice& value : ranked.values) {
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
  if (candidate.parameters_set.begin()->second.size() < 2) candidate.parameters_set.clear();
}

std::vector<Dependence> dependences(const Observations& data, const VectorXd& residual, const NoiseModel& noise,
                                    const std::vector<StructureTest>& tests) {
  std::vector<Dependence> list;
  for (const NamedShare& of : shares_by_variable(data, residual, noise.pure.noise_um)) {
    Dependence one;
    one.variable = of.variable;
    for (const StructureTest& test : tests)
      if (test.variable == of.variable) one.p_value = probability_from(test.minus_log_p);
    if (one.p_value >= kTellingChance) continue;
    one.strength = of.share;
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

Diagnosis too_few(const Observations& data, const Base& base) {
  Diagnosis diagnosis;
  diagnosis.observations = data.size();
  diagnosis.rms_um = diagnosis.rms_after_um = rms_of(base.residual);
  diagnosis.noise = base.core.noise.pure;
  diagnosis.notes.push_back(
      fmt::format("{} readings against {} fitted parameters: too few to say whether anything is missing; measure more "
                  "targets and repeats",
                  data.size(), base.core.rank));
  diagnosis.verdict = Verdict::cannot_tell;
  diagnosis.cannot_tell = diagnosis.notes.back();
  diagnosis.reservation = diagnosis.notes.back() + ".";
  diagnosis.headline = diagnosis.reservation;
  return diagnosis;
}

/// Share of what is above noise that some of the effects found explain together. @param chosen  which, by their number
double share_of_found(const ReportInput& in, const std::vector<std::size_t>& chosen) {
  LinearProblem all = in.problem;
  for (const std::size_t g : chosen) {
    const Choice& choice = in.found.groups[g].member;
    all = joined_with(all, columns_on(in.regressors, in.found.families[choice.family].effect, choice));
  }
  const Whitener whitener(in.regressors.data(), in.base.core.noise, in.base.core.left_out);
  const std::vector<bool>& out = in.base.core.left_out;
  return explainable_share(rms_without(in.base.residual, out), rms_without(residual_of(all, whitener), out),
                           in.found.noise.pure.noise_um);
}

/// Whether an effect predicts, beside the others that are proved, at targets that it was not fitted to at least half of
/// what it explains at those that it was: what is left besides repeats from run to run, and so do the errors of a fit
/// to it.
bool predicts_at_targets(const ReportInput& in, const std::vector<std::size_t>& proved, std::size_t g) {
  const Observations& data = in.regressors.data();
  if (!has_targets_to_leave_out(data)) return true;
  const auto with = [&](const LinearProblem& problem, std::size_t i) {
    const Choice& choice = in.found.groups[i].member;
    return joined_with(problem, columns_on(in.regressors, in.found.families[choice.family].effect, choice));
  };
  LinearProblem others = in.problem;
  for (const std::size_t i : proved)
    if (i != g) others = with(others, i);
  const LinearProblem all = with(others, g);
  const CoreFit& core = in.base.core;
  const Whitener whitener(data, core.noise, core.left_out);
  const Parts parts = parts_by_target(data);
  const auto square = [](double value) { return value * value; };
  const auto fitted = [&](const LinearProblem& of) {
    return square(rms_without(residual_of(of, whitener), core.left_out));
  };
  const auto held_out = [&](const LinearProblem& of) {
    return square(held_out_rms(data, core.noise, core.left_out, parts, of.columns, of.target));
  };
  return held_out(others) - held_out(all) >= kLeastPredicted * (fitted(others) - fitted(all));
}

/// Whether these effects may stand although more is left: any shape can be written as enough waves, so each wave is a
/// pitch of the machine, or all are whole fractions of one period.
bool may_be_part(const Found& found, const std::vector<std::size_t>& chosen) {
  std::vector<Choice> members;
  for (const std::size_t g : chosen) members.push_back(found.groups[g].member);
  return are_pitches_or_fractions(found.families, members);
}

/// The wave that explains nearly all by itself, although a weak one beside it beats with it or it changes a little: of
/// a wave whose size grows from nothing the best steady one explains three quarters. Nothing where there is none.
std::optional<std::size_t> nearly_steady_wave(const ReportInput& in) {
  const Found& found = in.found;
  if (found.bad_run) return std::nullopt;
  for (std::size_t g = 0; g < found.groups.size(); ++g) {
    const Group& group = found.groups[g];
    if (found.families[group.member.family].effect.traits().periodic && group.denied &&
        group.e_value.value_or(0.0) >= kProved && share_of_found(in, {g}) >= kNearlyAll &&
        predicts_at_targets(in, {g}, g))
      return g;
  }
  return std::nullopt;
}

/// A curve, or what looks like one, beside which the residual still depends on the position along the same axis: the
/// shape as a whole is no smooth one, and a curve follows the most of any (physics: faster shapes are other effects).
bool bends_to_structure(const Found& found, std::size_t g, const Observations& data) {
  const auto is_curve = [&](const Choice& choice) { return found.families[choice.family].effect.traits().is_curve; };
  const Group& group = found.groups[g];
  const std::optional<Axis>& axis = found.families[group.member.family].effect.axis;
  if (!axis || (!is_curve(group.member) && std::none_of(group.rivals.begin(), group.rivals.end(), is_curve)))
    return false;
  return std::any_of(found.after.begin(), found.after.end(), [&](const StructureTest& test) {
    return test.variable == data.position_name(*axis) && probability_from(test.minus_log_p) < kTellingChance;
  });
}

/// How sure each effect found is. What leaves noise, or explains half of what is above it, is proved by readings that
/// it was not fitted to, or likely where these do not suffice; where no split shows it, noise replicates decide. Where
/// more is left, noise replicates decide nothing: likely is what those readings speak for.
std::vector<Standing> standings_of(const ReportInput& in, bool noise) {
  const Found& found = in.found;
  const bool explained = noise && found.objection.empty();
  std::vector<Standing> standings(found.groups.size(), Standing::possible);
  std::vector<std::size_t> proved, likely;
  for (std::size_t g = 0; g < found.groups.size(); ++g) {
    const Group& group = found.groups[g];
    if (group.denied) continue;
    if (!group.wander && (group.e_value ? *group.e_value >= kProved : explained))
      proved.push_back(g);
    else if (!(found.step && is_like_wander(found.families[group.member.family].effect)) &&
             (explained || group.wander || group.e_value.value_or(0.0) >= kSpeaksFor) &&
             tail_probability(found.replicate_scores, group.member.score()) <= kLikelyChance)
      likely.push_back(g);
  }
  if (!explained) {
    const std::vector<std::size_t> all = proved;
    std::erase_if(proved, [&](std::size_t g) { return !predicts_at_targets(in, all, g); });
    std::erase_if(proved, [&](std::size_t g) { return bends_to_structure(found, g, in.regressors.data()); });
    if (!may_be_part(found, proved)) proved.clear();
  }
  if (const auto wave = nearly_steady_wave(in)) proved.insert(proved.begin(), *wave);
  for (const std::size_t g : proved) standings[g] = Standing::proved;
  std::vector<std::size_t> all = proved;
  all.insert(all.end(), likely.begin(), likely.end());
  if (!explained) {  // beyond what is proved
    const double before = proved.empty() ? 0.0 : share_of_found(in, proved);
    const double beyond = (share_of_found(in, all) - before) / std::max(1.0 - before, kLeastDivisor);
    if (!may_be_part(found, all) || beyond < kPartExplained) return standings;
  }
  for (const std::size_t g : likely) standings[g] = Standing::likely;
  return standings;
}

bool found_proved(const std::vector<Standing>& standings) {
  return std::find(standings.begin(), standings.end(), Standing::proved) != standings.end();
}

Verdict verdict_of(const ReportInput& in, const std::vector<Standing>& standings, bool noise) {
  if (standings.empty()) return noise ? Verdict::adequate : Verdict::unexplained_structure;
  if (in.found.bad_run || (in.found.step && !found_proved(standings))) return Verdict::unexplained_structure;
  std::vector<std::size_t> proved;
  bool likely = false, all_said = true;
  for (std::size_t g = 0; g < standings.size(); ++g) {
    if (standings[g] == Standing::proved) proved.push_back(g);
    likely = likely || standings[g] == Standing::likely;
    all_said = all_said && standings[g] != Standing::possible;
  }
  if (proved.empty()) return likely ? Verdict::likely_effect : Verdict::unexplained_structure;
  if (noise && in.found.objection.empty() && all_said) return Verdict::missing_effect;
  return share_of_found(in, proved) >= kPartExplained ? Verdict::partly_explained : Verdict::unexplained_structure;
}

/// Effects of the model, one of them with a free searched parameter, that cancel each other beyond the range of the
/// readings that they act on: the readings do not determine them, and whatever is missing is hidden in their freedom.
/// @param own  those with a free searched parameter, by their number
std::vector<std::string> cancelling_effects(const Observations& data, const Fit& fit,
                                            const std::vector<std::size_t>& own) {
  std::vector<std::string> names;
  bool any_free = false;
  for (std::size_t i = 0; i < fit.effects.size(); ++i) {
    const EffectFit& effect = fit.effects[i];
    if (!effect.effect.undetermined || effect.effect.undetermined->empty()) continue;
    double least = kBeyondAll, greatest = -kBeyondAll, low = kBeyondAll, high = -kBeyondAll;
    for (std::size_t k = 0; k < data.size(); ++k) {
      if (effect.contribution[k] == 0.0) continue;
      least = std::min(least, effect.contribution[k]);
      greatest = std::max(greatest, effect.contribution[k]);
      low = std::min(low, data.reading[k]);
      high = std::max(high, data.reading[k]);
    }
    if (greatest - least <= high - low) continue;
    names.push_back(to_text(effect.effect));
    any_free = any_free || std::find(own.begin(), own.end(), i) != own.end();
  }
  return any_free ? names : std::vector<std::string>();
}

/// Why readings whose residual looks like noise do not show that nothing is missing, as a sentence; "" where they do.
/// @param fit  of the model as it is
std::string why_cannot_tell(const ReportInput& in, const Fit& fit) {
  const Observations& data = in.regressors.data();
  const std::vector<std::string> cancelling = cancelling_effects(data, fit, in.base.own);
  if (!cancelling.empty())
    return fmt::format("the readings do not determine {}, which cancel each other: hold one of them, or measure more",
                       fmt::join(cancelling, " and "));
  const auto lack_of_fit = lack_of_fit_of(data, in.base.residual, in.base.core.noise, in.base.core.left_out,
                                          static_cast<double>(in.base.core.rank));
  const double rms_um = rms_without(in.base.residual, in.base.core.left_out);
  if (rms_um < kNothingLeft_um) return "";
  if (lack_of_fit && lack_of_fit->fails())
    return fmt::format(
        "the model leaves {:.3g} {}, and repeats show that this is no noise (lack of fit: F = {:.3g}, p = {:.1g}): "
        "measure more places",
        rms_um, in.found.noise.pure.unit, lack_of_fit->F, lack_of_fit->p);
  if (lack_of_fit || data.size() > in.options.largest_search) return "";
  Parts parts{std::vector<std::size_t>(data.size()), kPartsLeftOut, false};  // between readings rather than beyond them
  for (std::size_t k = 0; k < data.size(); ++k) parts.of[k] = k % kPartsLeftOut;
  const double held_out_um =
      held_out_rms(data, in.base.core.noise, in.base.core.left_out, parts, in.problem.columns, in.problem.target);
  if (held_out_um <= kMostHeldOut * rms_um) return "";
  return fmt::format(
      "nothing was repeated, and readings left out of the fit are missed by {:.3g} {}, those in it by {:.3g}: measure "
      "the same lines again",
      held_out_um, in.found.noise.pure.unit, rms_um);
}

/// Why the best effects of the library do not count as an explanation.
std::string why_not_explained(const Found& found) {
  if (!found.objection.empty()) return found.objection;
  if (!found.doubt.empty()) return found.doubt;
  if (found.noisy) return words_for(*found.noisy, found.noise.pure.unit) + ": look at that run first";
  if (found.odd_pass)
    return fmt::format("run {} differs from the other runs by {:.3g} in one approach: look at that run first",
                       found.odd_pass->run, found.odd_pass->off_um);
  if (found.wanders)
    return "readings of one run wander by more than three times what neighbours scatter: that is no noise";
  if (found.cross_validated_share < kLeastCrossValidated)
    return fmt::format(
        "the best effects of the library predict only {:.0f} % of the residual at targets that they were not fitted to",
        kPercent * std::max(0.0, found.cross_validated_share));
  const auto most =
      std::max_element(found.after.begin(), found.after.end(),
                       [](const StructureTest& a, const StructureTest& b) { return a.minus_log_p < b.minus_log_p; });
  if (most == found.after.end()) return "the best effects of the library leave structure";
  return fmt::format(
      "with the best effects of the library the residual still depends on {} (in noise alone: {:.2g} % of cases)",
      most->variable, kPercent * found.structure_p_after);
}

/// What is not excluded of an effect that is likely, and the measurement that would decide.
struct Doubt {
  std::string but, decide;
};
Doubt doubt_about(const RankedCandidate& ranked, const Found& found, bool noise) {
  const std::string again = "Measure the same lines again in both directions";
  if (ranked.wander)
    return {"nothing was measured twice, and a slow wander of the readings explains it as well", again};
  if (!noise) return {why_not_explained(found), "Measure the same lines again on targets between the present ones"};
  if (ranked.e_value)
    return {fmt::format("readings that it was not fitted to do not settle it (e-value {:.2g}; {:g} proves)",
                        *ranked.e_value, kProved),
            again};
  return {"no half of the readings shows it by itself", again};
}

/// Adding what is likely beside what is proved, and the fall to expect; nothing where nothing is likely.
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
  if (add.effects.empty()) return std::nullopt;
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

/// The verdict, and the candidates in their order, each with its standing.
struct Answer {
  Verdict verdict = Verdict::adequate;
  std::vector<RankedCandidate> order;
  std::string cannot_tell;  ///< why the verdict is that; else ""
};
Result<Answer> answer_of(const ReportInput& in) {
  const bool noise = noise_left(in.found, in.options);
  const std::vector<Standing> standings = standings_of(in, noise);
  Answer answer{verdict_of(in, standings, noise), ranked_candidates(in.found, standings), ""};
  if (answer.verdict != Verdict::adequate) return answer;
  Fit fit;
  ECS_DO(base_of(in.model, in.regressors, in.options.plain, &fit));
  answer.cannot_tell = why_cannot_tell(in, fit);
  if (!answer.cannot_tell.empty()) answer.verdict = Verdict::cannot_tell;
  return answer;
}

Result<NamedCauses> names_alone(const ReportInput& in) {
  ECS_TRY(answer, answer_of(in));
  NamedCauses names{answer.verdict, {}, 1.0};
  for (const RankedCandidate& ranked : answer.order) {
    if (ranked.standing == Standing::possible) continue;
    NamedCause cause{to_text(ranked.effect), ranked.probability,
                     ranked.e_value,         false_naming_of(in.found, ranked.choice),
                     ranked.p_value,         ranked.standing};
    double alone = ranked.p_value_alone;
    if (ranked.standing == Standing::likely &&
        !noise_left(in.found, in.options))  // against noise alone it says nothing
      alone = cause.p_value = 1.0 / std::max(1.0, ranked.e_value.value_or(1.0));
    names.causes.push_back(std::move(cause));
    names.p_value = std::min(names.p_value, alone);
  }
  return names;
}

Result<Diagnosis> reported(const ReportInput& in) {
  const Observations& data = in.regressors.data();
  const VectorXd before = told_residual(in.model, data, in.options.plain, in.base.residual);
  Diagnosis diagnosis;
  diagnosis.observations = data.size();
  diagnosis.rms_um = rms_of(before);
  diagnosis.candidates_tried = in.found.candidates_tried;
  diagnosis.noise_replicates = in.found.replicate_scores.size();
  ECS_TRY(answer, answer_of(in));
  const auto& [verdict, order, cannot_tell] = answer;
  diagnosis.verdict = verdict;
  diagnosis.own_terms = in.own;
  std::vector<FoundEffect> in_answer;
  for (const RankedCandidate& ranked : order)
    if (ranked.in_answer()) in_answer.push_back({ranked.effect, ranked.choice});
  ECS_TRY(with, fitted_with(in.model, in.own, in_answer, in.regressors, in.options.plain));
  const auto& [after, left, noise, left_out] = with;
  const Whitener whitener(data, noise, left_out);
  diagnosis.rms_after_um = rms_of(left);
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
    candidate.found = i < in.found.groups.size();
    if (order[i].in_answer()) {  // these are first
      take_parameters(candidate, after.effects[in.model.effects.size() + i]);
      state_sets(candidate, in, order, i, whitener, after);
    }
    for (const ParameterEstimate& parameter : candidate.parameters)
      if (!parameter.held) candidate.effect.fitted.try_emplace(parameter.name, parameter.value);
    candidate.next_measurement = separating_measurement(candidate.effect, order[i].rivals);
    if (candidate.standing == Standing::likely) {
      const Doubt doubt = doubt_about(order[i], in.found, noise_left(in.found, in.options));
      candidate.but = doubt.but;
      candidate.decide = doubt.decide;
    }
    diagnosis.candidates.push_back(std::move(candidate));
  }
  diagnosis.add = proposed_addition(in, order, with, parts);
  const auto joint = joint_proof(in, order, with, parts, held_out_before);
  for (Candidate& candidate : diagnosis.candidates) candidate.because = reason_for(candidate, diagnosis, data, joint);
  diagnosis.where = dependences(data, before, noise, in.found.beyond_position);
  if (in.found.bad_run || in.found.odd_pass || in.found.noisy || in.found.step)
    put_run_first(diagnosis.where, data, in.found, in.base.residual, kTellingChance);
  diagnosis.notes = untried_effects(data);
  if (const auto note = even_targets_note(data)) diagnosis.notes.push_back(*note);
  if (!in.found.run_note.empty()) diagnosis.notes.push_back(in.found.run_note);
  const bool structure = diagnosis.verdict == Verdict::unexplained_structure ||
                         diagnosis.verdict == Verdict::partly_explained ||
                         (diagnosis.verdict == Verdict::likely_effect && !noise_left(in.found, in.options));
  if (structure &&
      (!in.found.solution.chosen.empty() || in.found.noisy || in.found.odd_pass || in.found.wanders || in.found.wave))
    diagnosis.notes.push_back(why_not_explained(in.found));
  if (structure) describe_what_is_left(diagnosis, data, after.residual, left_out);
  if (structure &&
      std::any_of(data.paths.begin(), data.paths.end(), [](const Path& path) { return path.kind == PathKind::circle; }))
    diagnosis.notes.emplace_back(
        "friction at a reversal leaves another spike than the library's: ecs test circle shows how much of the circle "
        "is left there");
  for (const std::string& note : data.notes) diagnosis.notes.push_back(note);
  diagnosis.reservation = reservation_for(data);
  diagnosis.cannot_tell = cannot_tell;
  diagnosis.best_sum_leaves = !in.found.solution.chosen.empty() && leaves_structure(in.found, in.options);
  diagnosis.headline = headline_for(diagnosis, data, bad_run_text(in.found, diagnosis, data, in.base.residual));
  return diagnosis;
}

}  // namespace

std::string_view name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::adequate:
      return "adequate";
    case Verdict::missing_effect:
      return "missing_effect";
    case Verdict::partly_explained:
      return "partly_explained";
    case Verdict::likely_effect:
      return "likely_effect";
    case Verdict::cannot_tell:
      return "cannot_tell";
    default:
      return "unexplained_structure";
  }
}

std::string_view name_of(Standing standing) {
  switch (standing) {
    case Standing::proved:
      return "proved";
    case Standing::likely:
      return "likely";
    default:
      return "possible";
  }
}

namespace {

/// Effects that may be missing at once from readings along paths: what a line's new model holds from the start, slopes
/// and lost motion, is here among what is sought, and of two axes.
constexpr std::size_t kMostOnPaths = 6;

/// Searches the readings, of large sets an even choice.
/// @param answer  from a ReportInput about all readings
template <class Answered>
Result<Answered> searched_and(Result<Answered> (*answer)(const ReportInput&), const Model& model,
                              const Regressors& regressors, const Base& base, const DiagnoseOptions& options) {
  const Observations& data = regressors.data();
  const auto from = [&](const Found& found) {
    std::vector<OwnTerm> own;
    for (const Choice& term : found.solution.own)
      own.push_back({base.own[term.family - found.candidates_tried], term.nonlinear});
    return answer({model, regressors, base, own, problem_with_own(model, base, regressors, own), found, options});
  };
  if (data.size() <= options.largest_search)
    return from(searched(model, regressors, base, all_candidates(model, regressors), options));
  const Observations part = searched_part(data, options.largest_search);
  const Regressors part_regressors(part);
  ECS_TRY(part_base, base_of(model, part_regressors, options.plain, nullptr));
  return from(searched(model, part_regressors, part_base, all_candidates(model, part_regressors), options));
}

/// @param few  what is said where there are too few readings to say anything
template <class Answered, class Few>
Result<Answered> diagnosed(Result<Answered> (*answer)(const ReportInput&), const Few& few, const Model& model,
                           const Observations& data, DiagnoseOptions options) {
  if (data.size() == 0) return problem(ProblemKind::bad_input, "no readings to diagnose");
  if (!data.paths.empty()) options.most_effects = std::max(options.most_effects, kMostOnPaths);
  try {
    const Regressors regressors(data);
    ECS_TRY(base, base_of(model, regressors, options.plain, nullptr));
    if (static_cast<double>(data.size()) < static_cast<double>(base.core.rank) + kFewestSpare) return few(base);
    return searched_and(answer, model, regressors, base, options);
  } catch (const SearchStopped&) {
    return problem(ProblemKind::refused, "the diagnosis was stopped before its end");
  }
}

}  // namespace

Result<Diagnosis> diagnose(const Model& model, const Observations& data, const DiagnoseOptions& options) {
  auto diagnosis = diagnosed<Diagnosis>(
      reported, [&](const Base& base) { return too_few(data, base); }, model, data, options);
  if (diagnosis && diagnosis->candidates_tried > 0 && data.size() > options.largest_search)
    diagnosis->notes.push_back(fmt::format("searched on {} readings chosen evenly, sizes and proof from all {}",
                                           searched_part(data, options.largest_search).size(), data.size()));
  return diagnosis;
}

Result<NamedCauses> named_causes(const Model& model, const Observations& data, const DiagnoseOptions& options) {
  return diagnosed<NamedCauses>(
      names_alone,
      [](const Base&) {
        return NamedCauses{Verdict::cannot_tell, {}, 1.0};
      },
      model, data, options);
}

}  // namespace ecs::model
