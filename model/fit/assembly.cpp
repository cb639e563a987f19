// The linear problem of a model.

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "model/effects/definition.hpp"
#include "model/effects/quantities.hpp"
#include "model/fit/core.hpp"

namespace ecs::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Result<Slot> user_slot(const EffectInstance& effect, const Regressors& regressors) {
  Slot slot;
  slot.effect = effect;
  ECS_TRY(formulas, UserFormulas::compile(effect, regressors.motions()));
  std::vector<double> start;
  for (const UserParameter& parameter : effect.user) {
    const auto fitted = effect.fitted.find(parameter.name);
    start.push_back(!parameter.value && fitted != effect.fitted.end() ? fitted->second : start_of(parameter));
  }
  ECS_DO(formulas.finite_at(start));
  const std::vector<bool> linear = formulas.linear_parameters(start);
  for (std::size_t i = 0; i < start.size(); ++i) {
    const bool held = effect.user[i].value.has_value();
    if (linear[i] && !held) {
      slot.user_linear.push_back(i);
    } else {
      slot.user_nonlinear.push_back(i);
      slot.nonlinear.push_back(start[i]);
      slot.nonlinear_free.push_back(!held);
    }
  }
  for (std::size_t i = 0; i < slot.user_linear.size(); ++i) slot.used.push_back(static_cast<Index>(i));
  const Observations& rows = regressors.motions();
  const std::vector<double> values = formulas.values(start);
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (!rows.aside.empty() && rows.aside[k]) continue;
    if (std::isnan(values[k]))
      ++slot.acting.skipped;
    else if (std::ranges::any_of(effect.formulas, [&](const UserFormula& f) { return f.sense == rows.sense[k]; }))
      slot.acting.rows.push_back(k);
  }
  if (slot.acting.skipped > 0) slot.acting.lacking = "a column of its formula";
  slot.acting = regressors.with_readings(std::move(slot.acting));
  slot.formulas = std::move(formulas);
  return slot;
}

Result<Slot> library_slot(const EffectInstance& effect, const Regressors& regressors) {
  Slot slot;
  slot.effect = effect;
  slot.acting = regressors.acting(effect);
  const std::string name(effect.definition().searched_parameter());
  if (!name.empty()) {
    const auto given = effect.parameters.find(name);
    const auto fitted = effect.fitted.find(name);
    const bool held = given != effect.parameters.end();
    slot.nonlinear.push_back(held ? given->second : fitted != effect.fitted.end() ? fitted->second : kNotMeasured);
    slot.nonlinear_free.push_back(!held);
  }
  return slot;
}

}  // namespace

bool Slot::is_sought(const Observations& motions) const {
  constexpr std::size_t kFewValues = 16;  // enough to see that there are some
  if (formulas || nonlinear.size() != 1 || !nonlinear_free.front()) return false;
  if (!effect.parameters.empty() || effect.traits().fixed_size || acting.rows.size() < 2) return false;
  const TriedValues tried = tried_values(motions, effect, acting, {kFewValues});
  return tried.values.size() + tried.facts.size() > 1;
}

Result<Assembly> Assembly::of(const Model& model, const Regressors& regressors) {
  Assembly assembly;
  std::vector<Problem> problems;
  for (const EffectInstance& effect : model.effects) {
    auto slot = effect.is_user() ? user_slot(effect, regressors) : library_slot(effect, regressors);
    if (!slot)
      problems.push_back(slot.error());
    else
      assembly.slots.push_back(std::move(*slot));
  }
  if (!problems.empty()) return tl::unexpected(folded(std::move(problems)));
  return assembly;
}

void Assembly::renew(std::size_t s, const Regressors& regressors) {
  Slot& slot = slots[s];
  const auto n = static_cast<Index>(regressors.data().size());
  if (slot.formulas) {
    std::vector<double> at(slot.effect.user.size(), 0.0);
    for (std::size_t j = 0; j < slot.user_nonlinear.size(); ++j) at[slot.user_nonlinear[j]] = slot.nonlinear[j];
    slot.fixed = regressors.of_formulas(slot.formulas->values(at));
    slot.columns.resize(n, static_cast<Index>(slot.user_linear.size()));
    for (std::size_t j = 0; j < slot.user_linear.size(); ++j) {
      std::vector<double> one = at;
      one[slot.user_linear[j]] = 1.0;
      slot.columns.col(static_cast<Index>(j)) = regressors.of_formulas(slot.formulas->values(one)) - slot.fixed;
    }
    return;
  }
  const Columns all =
      regressors.columns(slot.effect, slot.nonlinear.empty() ? 0.0 : slot.nonlinear.front(), slot.acting);
  slot.fixed = all.fixed.size() > 0 ? all.fixed : VectorXd(VectorXd::Zero(n));
  slot.held_sizes = VectorXd::Zero(all.of.cols());
  std::vector<Index> free;
  for (Index j = 0; j < all.of.cols(); ++j) {
    const auto limit = slot.at_limit.find(j);
    if (limit != slot.at_limit.end()) {
      slot.held_sizes(j) = limit->second;
      slot.fixed += limit->second * all.of.col(j);
      continue;
    }
    const auto held =
        slot.effect.traits().is_curve ? std::nullopt : held_coefficient(slot.effect, static_cast<std::size_t>(j));
    if (held) {
      slot.held_sizes(j) = *held;
      slot.fixed += *held * all.of.col(j);
    } else {
      free.push_back(j);
    }
  }
  if (!slot.effect.traits().is_curve || slot.used.empty()) slot.used = free;
  slot.columns.resize(n, static_cast<Index>(slot.used.size()));
  for (std::size_t j = 0; j < slot.used.size(); ++j) slot.columns.col(static_cast<Index>(j)) = all.of.col(slot.used[j]);
  if (slot.effect.traits().is_curve && !slot.effect.curve.empty() && slot.effect.parameters.contains("rms_um")) {
    // a curve held as it stands in the model file
    slot.fixed = regressors.of_curve(slot.effect, slot.acting);
    slot.columns.resize(n, 0);
    slot.used.clear();
  }
}

MatrixXd Assembly::columns() const {
  Index total = 0;
  for (const Slot& slot : slots) total += slot.columns.cols();
  MatrixXd all(slots.empty() ? 0 : slots.front().fixed.size(), total);
  Index at = 0;
  for (const Slot& slot : slots) {
    all.middleCols(at, slot.columns.cols()) = slot.columns;
    at += slot.columns.cols();
  }
  return all;
}

VectorXd Assembly::fixed(std::size_t readings) const {
  VectorXd sum = VectorXd::Zero(static_cast<Index>(readings));
  for (const Slot& slot : slots) sum += slot.fixed;
  return sum;
}

Index Assembly::first_column(std::size_t slot) const {
  Index at = 0;
  for (std::size_t s = 0; s < slot; ++s) at += slots[s].columns.cols();
  return at;
}

VectorXd Assembly::contribution(std::size_t slot, const VectorXd& sizes) const {
  VectorXd sum = slots[slot].fixed;
  if (sizes.size() > 0) sum += slots[slot].columns * sizes;
  return sum;
}

VectorXd Assembly::slope(std::size_t s, std::size_t j, const VectorXd& sizes, const Regressors& regressors) {
  const double at = slots[s].nonlinear[j];
  const double step = std::max(std::abs(at) * 1e-5, 1e-7);
  const auto contribution_at = [&](double value) {
    slots[s].nonlinear[j] = value;
    renew(s, regressors);
    return contribution(s, sizes);
  };
  const VectorXd above = contribution_at(at + step);
  const VectorXd below = contribution_at(at - step);
  slots[s].nonlinear[j] = at;
  renew(s, regressors);
  return (above - below) / (2.0 * step);
}

}  // namespace ecs::model
