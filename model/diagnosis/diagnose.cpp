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

/// A credible set holds the cause with this probability; a cause is most of what is above noise from this share on: the
/// verdicts of docs/model.md.
constexpr double kCredible = 0.99, kMostExplained = 0.9;

double probability_from(double minus_log_p) { return std::pow(10.0, -std::min(kMostDigits, minus_log_p)); }

/// The candidates in the order in which they are ranked, each with its part in the answer.
struct RankedCandidate {
  EffectInstance effect;
  Choice choice;
  bool named = false;
  std::vector<EffectInstance> rivals;
  double probability = 0.0;
  std::vector<SetMember> set{};
  std::vector<Choice> values{};  ///< of the searched parameter that fit as well
  std::optional<double> e_value{};
  bool denied = false;
  double p_value = 1.0, p_value_alone = 1.0;
};

/// The fewest alternatives whose probabilities reach kCredible together (narrowest group: Spector and Janson 2022).
std::vector<SetMember> credible_set(std::vector<SetMember> alternatives) {
  std::stable_sort(alternatives.begin(), alternatives.end(),
                   [](const SetMember& a, const SetMember& b) { return a.probability > b.probability; });
  double sum = 0.0;
  std::size_t count = 0;
  while (count < alternatives.size() && sum < kCredible) sum += alternatives[count++].probability;
  alternatives.resize(count);
  return alternatives;
}

/// @param named  the members of the solution are
std::vector<RankedCandidate> ranked_candidates(const Found& found, bool named) {
  std::vector<RankedCandidate> list;
  const auto instance = [&](const Choice& choice) { return effect_of(found.families[choice.family].effect, choice); };
  std::vector<const Group*> groups;
  for (const Group& group : found.groups) groups.push_back(&group);
  std::stable_sort(groups.begin(), groups.end(),
                   [](const Group* a, const Group* b) { return a->member.gain > b->member.gain; });
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
    RankedCandidate one{instance(group.member),
                        group.member,
                        named,
                        {},
                        shares.front(),
                        credible_set(std::move(members)),
                        group.values,
                        group.e_value,
                        group.denied,
                        group.p_value,
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
      RankedCandidate one{instance(rival), rival, false, {list[g].effect}, probability_of(g, instance(rival)),
                          list[g].set};
      for (const Choice& other : groups[g]->rivals)
        if (other.family != rival.family) one.rivals.push_back(instance(other));
      list.push_back(std::move(one));
    }
  for (std::size_t g = 0; g < members; ++g)
    for (const Choice& weaker : groups[g]->weaker)
      if (!listed(instance(weaker)) && list.size() < kMostListed)
        list.push_back({instance(weaker), weaker, false, {}, probability_of(g, instance(weaker)), {}});
  if (list.empty()) {  // nothing found: the closest, against none, beforehand as likely as all candidates together
    std::vector<Choice> alternatives = found.closest;
    alternatives.emplace_back().gain =
        2.0 * std::log(static_cast<double>(std::max<std::size_t>(found.candidates_tried, 1)));
    const std::vector<double> shares = probabilities_of(alternatives, found.families);
    for (std::size_t i = 0; i < found.closest.size(); ++i)
      list.push_back({instance(found.closest[i]), found.closest[i], false, {}, shares[i], {}});
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
  candidate.named = ranked.named;
  const LinearProblem problem = joined_with(in.problem, columns_on(in.regressors, ranked.effect, ranked.choice));
  const VectorXd left = residual_with(in.model, {ranked.effect, ranked.choice}, problem, whitener, in.regressors.data(),
                                      in.options.plain);
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
/// named, and those of a wave of the model itself that may have changed places with it.
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
    if (j != i && order[j].named)
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
  for (const Variable& variable : variables_of(data)) {
    Dependence one;
    one.variable = variable.name;
    one.strength = share_of(variable, residual, noise.pure.noise_um);
    for (const StructureTest& test : tests)
      if (test.variable == variable.name) one.p_value = probability_from(test.minus_log_p);
    const ResidualView view = residual_view(
        data, std::vector<double>(residual.data(), residual.data() + residual.size()), variable.name, kMostBins);
    for (const ResidualBin& bin : view.bins) {
      one.at.push_back(0.5 * (bin.from + bin.to));
      one.mean_um.push_back(bin.mean_um);
    }
    if (one.strength > kTellingShare && one.p_value < kTellingChance) list.push_back(std::move(one));
  }
  std::stable_sort(list.begin(), list.end(),
                   [](const Dependence& a, const Dependence& b) { return a.strength > b.strength; });
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
  diagnosis.reservation = diagnosis.notes.back() + ".";
  diagnosis.headline = diagnosis.reservation;
  return diagnosis;
}

Verdict verdict_of(const Found& found, const DiagnoseOptions& options) {
  const bool noise = noise_left(found, options);
  if (found.solution.chosen.empty()) return noise ? Verdict::adequate : Verdict::unexplained_structure;
  return noise && found.objection.empty() ? Verdict::missing_effect : Verdict::unexplained_structure;
}

/// Whether a cause alone is proved and explains nearly all, although more is left.
bool explains_most(const ReportInput& in, const RankedCandidate& first) {
  if (first.denied || first.e_value.value_or(0.0) < kProved) return false;
  if (first.effect.traits().is_curve) return false;  // a curve follows most of anything
  if (!is_pitch_or_no_wave(in.found.families[first.choice.family], first.choice)) return false;
  const Whitener whitener(in.regressors.data(), in.base.core.noise, in.base.core.left_out);
  const VectorXd left =
      residual_of(joined_with(in.problem, columns_on(in.regressors, first.effect, first.choice)), whitener);
  const std::vector<bool>& out = in.base.core.left_out;
  return explainable_share(rms_without(in.base.residual, out), rms_without(left, out), in.found.noise.pure.noise_um) >=
         kMostExplained;
}

/// Why the best effects of the library do not count as an explanation.
std::string why_not_explained(const Found& found) {
  if (!found.objection.empty()) return found.objection;
  if (found.noisy) return words_for(*found.noisy) + ": look at that run first";
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

/// What all named effects do together; nothing for fewer than two.
std::optional<JointProof> joint_proof(const ReportInput& in, const std::vector<RankedCandidate>& order,
                                      const FittedWith& with, const Parts& parts, double held_out_before) {
  LinearProblem all = in.problem;
  std::size_t named = 0;
  for (const RankedCandidate& ranked : order) {
    if (!ranked.named) continue;
    all = joined_with(all, columns_on(in.regressors, ranked.effect, ranked.choice));
    ++named;
  }
  if (named < 2) return std::nullopt;
  return JointProof{rms_without(with.left, with.left_out), held_out_before,
                    held_out_rms(in.regressors.data(), with.noise, with.left_out, parts, all.columns, all.target)};
}

/// The verdict, and the candidates in their order with those that it names.
struct Answer {
  Verdict verdict = Verdict::adequate;
  std::vector<RankedCandidate> order;
};
Answer answer_of(const ReportInput& in) {
  Answer answer{verdict_of(in.found, in.options), {}};
  answer.order = ranked_candidates(in.found, answer.verdict == Verdict::missing_effect);
  if (answer.verdict == Verdict::unexplained_structure && !in.found.groups.empty() &&
      explains_most(in, answer.order.front())) {
    answer.verdict = Verdict::partly_explained;
    answer.order.front().named = true;
  }
  return answer;
}

Result<NamedCauses> names_alone(const ReportInput& in) {
  const Answer answer = answer_of(in);
  NamedCauses names{answer.verdict, {}, 1.0};
  for (const RankedCandidate& ranked : answer.order) {
    if (!ranked.named) continue;
    names.causes.push_back({to_text(ranked.effect), ranked.probability, ranked.e_value,
                            false_naming_of(in.found, ranked.choice), ranked.p_value});
    names.p_value = std::min(names.p_value, ranked.p_value_alone);
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
  const auto [verdict, order] = answer_of(in);
  diagnosis.verdict = verdict;
  diagnosis.own_terms = in.own;
  std::vector<FoundEffect> named;
  for (const RankedCandidate& ranked : order)
    if (ranked.named) named.push_back({ranked.effect, ranked.choice});
  const auto with = fitted_with(in.model, in.own, named, in.regressors, in.options.plain);
  if (!with) return tl::unexpected(with.error());
  const auto& [after, left, noise, left_out] = *with;
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
    Candidate candidate = candidate_of(in, order[i], before, whitener, parts, *with, held_out_before, i < kMostProved);
    candidate.found = i < in.found.groups.size();
    if (candidate.named) {  // named ones are first
      take_parameters(candidate, after.effects[in.model.effects.size() + i]);
      state_sets(candidate, in, order, i, whitener, after);
    }
    for (const ParameterEstimate& parameter : candidate.parameters)
      if (!parameter.held) candidate.effect.fitted.try_emplace(parameter.name, parameter.value);
    candidate.next_measurement = separating_measurement(candidate.effect, order[i].rivals);
    diagnosis.candidates.push_back(std::move(candidate));
  }
  const auto joint = joint_proof(in, order, *with, parts, held_out_before);
  for (Candidate& candidate : diagnosis.candidates) candidate.because = reason_for(candidate, diagnosis, data, joint);
  diagnosis.where = dependences(data, before, noise, in.found.before);
  if (in.found.bad_run || in.found.odd_pass || in.found.noisy)
    put_run_first(diagnosis.where, data, in.found, in.base.residual, kTellingChance);
  diagnosis.notes = untried_effects(data);
  if (const auto note = even_targets_note(data)) diagnosis.notes.push_back(*note);
  if (!in.found.run_note.empty()) diagnosis.notes.push_back(in.found.run_note);
  if (diagnosis.verdict != Verdict::missing_effect && diagnosis.verdict != Verdict::adequate &&
      (!in.found.solution.chosen.empty() || in.found.noisy || in.found.odd_pass || in.found.wanders || in.found.wave))
    diagnosis.notes.push_back(why_not_explained(in.found));
  if (diagnosis.verdict == Verdict::unexplained_structure || diagnosis.verdict == Verdict::partly_explained)
    describe_what_is_left(diagnosis, data, after.residual, left_out);
  if (diagnosis.verdict != Verdict::adequate && diagnosis.verdict != Verdict::missing_effect &&
      std::any_of(data.paths.begin(), data.paths.end(), [](const Path& path) { return path.kind == PathKind::circle; }))
    diagnosis.notes.emplace_back(
        "friction at a reversal leaves another spike than the library's: ecs test circle shows how much of the circle "
        "is left there");
  for (const std::string& note : data.notes) diagnosis.notes.push_back(note);
  diagnosis.reservation = reservation_for(data);
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
  const auto part_base = base_of(model, part_regressors, options.plain, nullptr);
  if (!part_base) return tl::unexpected(part_base.error());
  return from(searched(model, part_regressors, *part_base, all_candidates(model, part_regressors), options));
}

/// @param few  what is said where there are too few readings to say anything
template <class Answered, class Few>
Result<Answered> diagnosed(Result<Answered> (*answer)(const ReportInput&), const Few& few, const Model& model,
                           const Observations& data, DiagnoseOptions options) {
  if (data.size() == 0) return problem(ProblemKind::bad_input, "no readings to diagnose");
  if (!data.paths.empty()) options.most_effects = std::max(options.most_effects, kMostOnPaths);
  try {
    const Regressors regressors(data);
    const auto base = base_of(model, regressors, options.plain, nullptr);
    if (!base) return tl::unexpected(base.error());
    if (static_cast<double>(data.size()) < static_cast<double>(base->core.rank) + kFewestSpare) return few(*base);
    return searched_and(answer, model, regressors, *base, options);
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
      names_alone, [](const Base&) { return NamedCauses{}; }, model, data, options);
}

}  // namespace ecs::model
