// Large sets are searched on a stratified sample (Cochran 1977, 5).
#include "model/diagnosis/trial.hpp"

#include <algorithm>
#include <cmath>

#include "model/data/curve_basis.hpp"
#include "model/effects/definition.hpp"
#include "model/fit/core.hpp"
#include "model/regression/candidates.hpp"

namespace ecs::model {

using Eigen::Index;
using Eigen::VectorXd;

std::vector<EffectInstance> all_candidates(const Model& model, const Regressors& regressors) {
  std::vector<EffectInstance> all = candidate_instances(regressors.data());
  for (const EffectInstance& candidate : model.candidates) all.push_back(with_best_start(model, candidate, regressors));
  return all;
}

Observations searched_part(const Observations& data, std::size_t wanted) {
  return subset(data, even_choice(data.size(), wanted));
}

Columns columns_on(const Regressors& regressors, const EffectInstance& effect, const Choice& choice) {
  Columns all = regressors.columns(effect, choice.nonlinear);
  if (all.fixed.size() > 0) return all;
  Columns chosen;
  std::vector<Index> kept;
  for (const Index j : choice.columns)
    if (j < all.of.cols()) kept.push_back(j);
  chosen.of.resize(all.of.rows(), static_cast<Index>(kept.size()));
  for (std::size_t j = 0; j < kept.size(); ++j) chosen.of.col(static_cast<Index>(j)) = all.of.col(kept[j]);
  return chosen;
}

LinearProblem joined_with(const LinearProblem& problem, const Columns& more) {
  LinearProblem all = problem;
  if (more.fixed.size() > 0) all.target -= more.fixed;
  all.columns.conservativeResize(Eigen::NoChange, problem.columns.cols() + more.of.cols());
  all.columns.rightCols(more.of.cols()) = more.of;
  return all;
}

LinearProblem problem_with_own(const Model& model, const Base& base, const Regressors& regressors,
                               const std::vector<OwnTerm>& own) {
  LinearProblem problem{base.columns, base.target};
  for (const OwnTerm& term : own)
    problem = joined_with(problem, {.of = regressors.columns(model.effects[term.effect], term.value).of, .fixed = {}});
  return problem;
}

double rms_without(const VectorXd& residual, const std::vector<bool>& left_out) {
  double sum = 0.0, count = 0.0;
  for (std::size_t k = 0; k < left_out.size(); ++k) {
    if (left_out[k]) continue;
    sum += residual(static_cast<Index>(k)) * residual(static_cast<Index>(k));
    count += 1.0;
  }
  return std::sqrt(sum / std::max(count, 1.0));
}

double explainable_share(double rms_um, double rms_after_um, double noise_um) {
  const double above_noise = rms_um * rms_um - noise_um * noise_um;
  return above_noise > 0.0 ? std::clamp((rms_um * rms_um - rms_after_um * rms_after_um) / above_noise, 0.0, 1.0) : 0.0;
}

VectorXd told_residual(const Model& model, const Observations& data, bool plain, VectorXd left, bool from_values) {
  if (std::ranges::none_of(model.effects, [](const EffectInstance& effect) { return effect.traits().is_curve; }))
    return left;
  const auto fitted = fit(model, data, {plain, from_values});
  if (!fitted) return left;
  return Eigen::Map<const VectorXd>(fitted->residual.data(), static_cast<Index>(fitted->residual.size()));
}

namespace {

Model with_own_terms(Model model, const std::vector<OwnTerm>& own) {
  for (const OwnTerm& term : own) {
    EffectInstance& effect = model.effects[term.effect];
    effect.fitted[std::string(effect.definition().searched_parameter())] = term.value;
  }
  return model;
}

}  // namespace

VectorXd residual_with(const Model& model, const std::vector<OwnTerm>& own, const FoundEffect& found,
                       const LinearProblem& problem, const Whitener& whitener, const Regressors& regressors, bool plain,
                       const CoreFit* beside) {
  Model with = with_own_terms(model, own);
  with.effects.push_back(effect_of(found.effect, found.choice));
  VectorXd left = residual_of(problem, whitener);
  if (beside == nullptr || std::ranges::none_of(with.effects, [](const auto& one) { return one.traits().is_curve; }))
    return told_residual(with, regressors.data(), plain, std::move(left), true);
  auto assembly = Assembly::of(with, regressors);
  if (!assembly) return left;
  return fitted(*assembly, regressors, {.plain = plain, .from_values = true, .beside = beside}).residual;
}

FittedWith fitted_alone(const Base& base, VectorXd left) {
  return {base.fit, std::move(left), base.noise, base.core.left_out};
}

namespace {

Result<FittedWith> fitted_beside(Model model, const std::vector<EffectInstance>& effects, const Regressors& regressors,
                                 bool plain) {
  model.effects.insert(model.effects.end(), effects.begin(), effects.end());
  ECS_TRY(base, base_of(model, regressors, plain));
  return fitted_alone(base, told_residual(model, regressors.data(), plain, base.residual));
}

}  // namespace

Result<FittedWith> fitted_with(const Model& model, const std::vector<OwnTerm>& own,
                               const std::vector<FoundEffect>& effects, const Regressors& regressors, bool plain) {
  const Model with = with_own_terms(model, own);
  std::vector<EffectInstance> complete, found;
  bool all_used = true;
  for (const FoundEffect& one : effects) {
    found.push_back(effect_of(one.effect, one.choice));
    complete.push_back(one.effect.traits().periodic ? found.back() : with_all_sizes(found.back(), one.choice));
    all_used = all_used && complete.back().parameters == found.back().parameters;
  }
  auto after = fitted_beside(with, complete, regressors, plain);
  if (!after || all_used) return after;
  const auto is_lost = [](const EffectFit& effect) { return effect.effect.undetermined.has_value(); };
  const auto first = after->fit.effects.begin() + static_cast<std::ptrdiff_t>(model.effects.size());
  if (std::none_of(first, after->fit.effects.end(), is_lost)) return after;
  return fitted_beside(with, found, regressors, plain);
}

TrialNumbers trial_numbers(const VectorXd& before, const VectorXd& left, const FittedWith& after) {
  TrialNumbers numbers;
  numbers.rms_after_um = rms_of(left);
  numbers.kept_rms_before_um = rms_without(before, after.left_out);
  numbers.kept_rms_after_um = rms_without(left, after.left_out);
  if (numbers.kept_rms_before_um > 0.0)
    numbers.explained = 1.0 - std::pow(numbers.kept_rms_after_um / numbers.kept_rms_before_um, 2);
  numbers.explainable_share =
      explainable_share(numbers.kept_rms_before_um, numbers.kept_rms_after_um, after.noise.pure.noise_um);
  return numbers;
}

}  // namespace ecs::model
