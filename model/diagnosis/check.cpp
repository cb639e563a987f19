#include "model/diagnosis/check.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "model/diagnosis/apart.hpp"
#include "model/diagnosis/e_value.hpp"
#include "model/diagnosis/structure.hpp"
#include "model/diagnosis/trial.hpp"
#include "model/diagnosis/weighing.hpp"
#include "model/effects/definition.hpp"
#include "model/fit/held_out.hpp"
#include "model/fit/noise.hpp"

namespace ecs::model {
namespace {

using Eigen::Index;

bool near(double a, double b, double share, double least = 0.0) {
  return std::abs(a - b) <= std::max(least, share * std::max(std::abs(a), std::abs(b)));
}

void check_number(Check& check, std::string name, const std::optional<double>& claimed,
                  const std::optional<double>& recomputed, double least = 0.0) {
  const bool holds = claimed && recomputed ? near(*claimed, *recomputed, kNumberTolerance, least)
                                           : claimed.has_value() == recomputed.has_value();
  check.numbers.push_back({std::move(name), claimed, recomputed, holds});
}

void check_e_value(Check& check, std::string name, const std::optional<double>& claimed,
                   const std::optional<double>& recomputed) {
  bool holds = claimed.has_value() == recomputed.has_value();
  if (claimed && recomputed)
    holds = *claimed > 0.0 && *recomputed > 0.0 &&
            near(std::log(*claimed), std::log(*recomputed), kLnTolerance, kLeastLnTolerance);
  check.numbers.push_back({std::move(name), claimed, recomputed, holds});
}

/// An effect of the answer as the search has it.
struct Member {
  const Candidate& claimed;
  EffectInstance effect;  ///< as it is tried
  Choice choice;
};

std::string beyond_library(const Candidate& candidate) {
  return fmt::format("{} is not a candidate for these data", to_text(candidate.effect));
}

/// Members whose effect cannot be tried on these data are objected to.
std::vector<Member> members_of(const Claim& claim, const Model& model, const Regressors& regressors, Check& check) {
  std::vector<Member> members;
  const std::vector<EffectInstance> all = all_candidates(model, regressors);
  for (const Candidate& candidate : claim.candidates) {
    if (!candidate.in_answer() && !candidate.found) continue;
    if (!candidate.apart.empty() && std::ranges::find(claim.apart, candidate.apart) == claim.apart.end()) {
      check.objections.push_back(fmt::format("{} is judged on {}, which is not among the lines judged apart",
                                             to_text(candidate.effect), candidate.apart));
      continue;
    }
    const auto found =
        std::ranges::find_if(all, [&](const EffectInstance& one) { return same_candidate(one, candidate.effect); });
    if (found == all.end()) {
      check.objections.push_back(beyond_library(candidate));
      continue;
    }
    Member member{candidate, *found, {}};
    member.choice.nonlinear = candidate.tried_at.value;
    for (const std::size_t column : candidate.tried_at.coefficients)
      member.choice.columns.push_back(static_cast<Index>(column));
    members.push_back(std::move(member));
  }
  return members;
}

LinearProblem problem_with(LinearProblem problem, const std::vector<Member>& members, const Regressors& regressors,
                           const Member* without) {
  for (const Member& member : members)
    if (&member != without) problem = joined_with(problem, columns_on(regressors, member.effect, member.choice));
  return problem;
}

/// On the readings that were searched together, with noise and outliers settled beside all members.
/// @param members  that are judged on these readings
Result<void> check_e_values(const Model& model, const Observations& data, const Claim& claim,
                            const std::vector<Member>& members, Check& check) {
  const Regressors regressors(data);
  ECS_TRY(base, base_of(model, regressors, claim.plain));
  std::vector<OwnTerm> own_terms = claim.own_terms;
  std::erase_if(own_terms,
                [&](const OwnTerm& one) { return std::ranges::find(base.own, one.effect) == base.own.end(); });
  const LinearProblem alone = problem_with_own(model, base, regressors, own_terms);
  const LinearProblem all = problem_with(alone, members, regressors, nullptr);
  std::vector<bool> left_out = base.core.left_out;
  NoiseModel noise = base.noise;
  for (int round = 0; round < kMostRounds; ++round)
    if (!noise_changed(data, base, all, Whitener(data, noise, left_out), claim.plain, noise, left_out)) break;
  std::vector<EffectInstance> own;
  for (const std::size_t i : base.own) own.push_back(model.effects[i]);
  const Search search(regressors, Whitener(data, noise, left_out), base.columns, base.target,
                      candidates_beside(model, own, all_candidates(model, regressors)), own);
  if (claim.apart.empty())
    check_number(check, "candidates_tried", static_cast<double>(claim.candidates_tried),
                 static_cast<double>(search.candidates()));
  const auto e_value_beside = [&](const Member& member, NullHypothesis null) {
    const LinearProblem others = problem_with(alone, members, regressors, &member);
    return e_value_of({regressors, noise, left_out}, others.columns, others.target, member.effect, null);
  };
  std::vector<Member> shown;
  for (const Member& member : members)
    if (!is_like_wander(member.effect) ||
        !is_replaced_by_wander(member.effect, e_value_beside(member, NullHypothesis::noise_or_wander)))
      shown.push_back(member);
  std::optional<LinearProblem> not_replaced;
  if (shown.size() < members.size()) not_replaced = problem_with(alone, shown, regressors, nullptr);
  const bool wanders = wanders_beside(data, noise, left_out, all, not_replaced);
  for (const Member& member : members) {
    if (!member.claimed.in_answer()) continue;
    const bool beside_wander = wanders || may_be_wander(noise, member.effect);
    auto e_value = e_value_beside(member, beside_wander ? NullHypothesis::noise_or_wander : NullHypothesis::noise);
    if (e_value) *e_value /= static_cast<double>(std::max<std::size_t>(search.candidates(), 1));
    check_e_value(check, to_text(member.effect) + " e_value", member.claimed.e_value, e_value);
  }
  return {};
}

void check_parameters(const Member& member, const EffectFit& fit, Check& check) {
  const auto find = [](const std::vector<ParameterEstimate>& list, const std::string& name) {
    return std::ranges::find_if(list, [&](const ParameterEstimate& one) { return one.name == name; });
  };
  for (const ParameterEstimate& claimed : member.claimed.parameters) {
    const auto own = find(fit.parameters, claimed.name);
    const bool known = own != fit.parameters.end();
    check_number(check, to_text(member.effect) + " " + claimed.name, claimed.value,
                 known ? std::optional(own->value) : std::nullopt,
                 known && own->sigma ? kSigmaTolerance * *own->sigma : 0.0);
  }
}

/// What the claim's model leaves without and with what is named.
struct Recomputed {
  const Model& model;
  const LinearProblem& problem;
  const Eigen::VectorXd& before;
  const FittedWith& after;
  const Claim& claim;
};

void check_member(const Member& member, const Regressors& regressors, const Recomputed& now, Check& check) {
  const FittedWith& after = now.after;
  const Observations& data = regressors.data();
  const std::string name = to_text(member.effect) + " ";
  const LinearProblem problem = joined_with(now.problem, columns_on(regressors, member.effect, member.choice));
  const Eigen::VectorXd left =
      residual_with(now.model, now.claim.own_terms, {member.effect, member.choice}, problem,
                    Whitener(data, after.noise, after.left_out), regressors, now.claim.plain, nullptr);
  const TrialNumbers numbers = trial_numbers(now.before, left, after);
  const Candidate& claimed = member.claimed;
  check_number(check, name + "rms_after_um", claimed.rms_after_um, numbers.rms_after_um);
  check_number(check, name + "explained", claimed.explained, numbers.explained);
  check_number(check, name + "explainable_share", claimed.explainable_share, numbers.explainable_share);
  const Parts parts = parts_of(data);
  const auto held_out = [&](const LinearProblem& of) {
    return held_out_rms(data, after.noise, after.left_out, parts, of.columns, of.target);
  };
  if (claimed.held_out_rms_um)
    check_number(check, name + "held_out_rms_um", claimed.held_out_rms_um, held_out(problem));
  if (claimed.held_out_rms_before_um)
    check_number(check, name + "held_out_rms_before_um", claimed.held_out_rms_before_um, held_out(now.problem));
}

/// The searched terms of the model that are free each have one value.
bool own_terms_fit(const Claim& claim, const Base& base) {
  if (claim.own_terms.size() != base.own.size()) return false;
  for (std::size_t i = 0; i < base.own.size(); ++i)
    if (claim.own_terms[i].effect != base.own[i]) return false;
  return true;
}

}  // namespace

bool Check::holds() const {
  return objections.empty() && std::ranges::all_of(numbers, [](const CheckedNumber& number) { return number.holds; });
}

Result<Check> checked(const Model& model, const Observations& all, const Claim& claim) {
  const Observations data = with_sensors(all);
  if (data.size() == 0) return problem(ProblemKind::bad_input, "no readings to check");
  const Regressors regressors(data);
  ECS_TRY(base, base_of(model, regressors, claim.plain));
  Check check;
  check_number(check, "observations", static_cast<double>(claim.observations), static_cast<double>(data.size()));
  const Eigen::VectorXd before = told_residual(model, data, claim.plain, base.residual);
  check_number(check, "rms_um", claim.rms_um, rms_of(before));
  const std::vector<Member> members = members_of(claim, model, regressors, check);
  if (!own_terms_fit(claim, base)) {
    if (!members.empty()) check.objections.emplace_back("own_terms are not the free searched terms of the model");
    return check;
  }
  std::vector<FoundEffect> named;
  for (const Member& member : members)
    if (member.claimed.in_answer()) named.push_back({member.effect, member.choice});
  ECS_TRY(after, fitted_with(model, claim.own_terms, named, regressors, claim.plain));
  check_number(check, "rms_after_um", claim.rms_after_um, rms_of(after.left));
  const LinearProblem alone = problem_with_own(model, base, regressors, claim.own_terms);
  std::size_t place = model.effects.size();
  for (const Member& member : members) {
    if (!member.claimed.in_answer()) continue;
    check_member(member, regressors, {model, alone, before, after, claim}, check);
    check_parameters(member, after.fit.effects[place++], check);
  }
  if (named.empty()) return check;
  const std::size_t largest = DiagnoseOptions{}.largest_search;
  const std::vector<std::vector<std::size_t>> parts = parts_of_lines(data, claim.apart);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    std::vector<Member> here;
    for (const Member& member : members)
      if (member.claimed.apart == (p == 0 ? "" : claim.apart[p - 1])) here.push_back(member);
    if (std::ranges::none_of(here, [](const Member& member) { return member.claimed.in_answer(); })) continue;
    const Observations part = claim.apart.empty() ? data : subset(data, parts[p]);
    ECS_DO(check_e_values(model, part.size() > largest ? searched_part(part, largest) : part, claim, here, check));
  }
  return check;
}

}  // namespace ecs::model
