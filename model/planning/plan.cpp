// Whether readings not yet taken would determine a model: the sigmas to expect before anything is measured, from the
// inverse of the information matrix at assumed values (local design: Chernoff 1953; Fedorov 1972), by a QR
// factorisation with column pivoting (Businger and Golub 1965); what it cannot separate by its dependent columns
// (Belsley, Kuh and Welsch 1980). Does not live here: which readings to take (next_measurement.cpp).
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/linear/decompositions.hpp"
#include "model/effects/definition.hpp"
#include "model/fit/core.hpp"
#include "model/fit/statistics.hpp"
#include "model/planning/next_measurement.hpp"

namespace ecs::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Left of a column (of its norm), beside the others, below which they do the same: a sigma ten thousand times that of
/// the column alone determines nothing.
constexpr double kDependent = 1e-4;
/// Part of a column's twin that another column must make to be named: a choice; smaller ones are names without use.
constexpr double kTakesPart = 0.05;
/// Size of an effect that the model does not give, in units of the noise: a choice, clearly seen and not large.
constexpr double kAssumedSize = 5.0;

/// A free nonlinear parameter of a slot.
struct FreeParameter {
  std::size_t slot = 0, j = 0;
};

/// Sizes of a slot's columns that the model gives; nothing where it has no values.
std::optional<VectorXd> sizes_given(const Model& model, std::size_t s, const Slot& slot, const Observations& plan) {
  Model alone = model;
  alone.effects = {model.effects[s]};
  const auto values = predicted(alone, plan);
  if (!values) return std::nullopt;
  const VectorXd sum = Eigen::Map<const VectorXd>(values->data(), static_cast<Index>(values->size()));
  return least_norm_solution(slot.columns, sum - slot.fixed);
}

class PlanJudge {
 public:
  PlanJudge(const Model& model, Assembly& assembly, const Regressors& regressors, double noise_um)
      : model_(model), assembly_(assembly), regressors_(regressors), noise_um_(noise_um) {}

  PlanCheck judged() {
    expect_values();
    factorise();
    PlanCheck check;
    const Fit fit = reported(assembly_, regressors_, core_);
    check.effects = fit.effects;
    check.condition = fit.condition;
    check.undetermined = fit.undetermined;
    check.assumed = assumed_;
    for (std::size_t s = 0; s < assembly_.slots.size(); ++s) finish(s, check);
    check.determines = check.undetermined.empty();
    return check;
  }

 private:
  void expect_values() {
    const Observations& plan = regressors_.data();
    for (std::size_t s = 0; s < assembly_.slots.size(); ++s) {
      Slot& slot = assembly_.slots[s];
      if (!slot.nonlinear.empty() && std::isnan(slot.nonlinear.front())) {
        slot.nonlinear.front() = slot.effect.definition().search.assumed(plan, slot.effect, slot.acting);
        assumed_.push_back(fmt::format("{}: {} = {:.4g}", to_text(slot.effect),
                                       slot.effect.definition().searched_parameter(), slot.nonlinear.front()));
      }
      assembly_.renew(s, regressors_);
    }
    for (std::size_t s = 0; s < assembly_.slots.size(); ++s) {
      Slot& slot = assembly_.slots[s];
      auto sizes = sizes_given(model_, s, slot, plan);
      const bool matters = std::ranges::count(slot.nonlinear_free, true) > 0;
      if (!sizes || (matters && sizes->size() > 0 && sizes->squaredNorm() == 0.0)) {
        sizes = assumed_sizes(slot);
        if (matters && slot.columns.cols() > 0)
          assumed_.push_back(fmt::format("{}: as large as {:g} times the noise", to_text(slot.effect), kAssumedSize));
      }
      sizes_.push_back(*sizes);
      for (std::size_t j = 0; j < slot.nonlinear_free.size(); ++j)
        if (slot.nonlinear_free[j] && slot.has_slope()) free_.push_back({s, j});
    }
  }

  [[nodiscard]] VectorXd assumed_sizes(const Slot& slot) const {
    VectorXd sizes = VectorXd::Zero(slot.columns.cols());
    const double rows = std::max<double>(1.0, static_cast<double>(slot.acting.rows.size()));
    if (sizes.size() == 0) return sizes;
    const double norm = slot.columns.col(0).norm();
    if (norm > 0.0) sizes(0) = kAssumedSize * noise_um_ * std::sqrt(rows) / norm;
    return sizes;
  }

  void factorise() {
    const Observations& plan = regressors_.data();
    const auto n = static_cast<Index>(plan.size());
    MatrixXd joint = assembly_.slots.empty() ? MatrixXd(n, 0) : assembly_.columns();
    linear_ = joint.cols();
    joint.conservativeResize(Eigen::NoChange, linear_ + static_cast<Index>(free_.size()));
    for (std::size_t i = 0; i < free_.size(); ++i)
      joint.col(linear_ + static_cast<Index>(i)) =
          assembly_.slope(free_[i].slot, free_[i].j, sizes_[free_[i].slot], regressors_);
    const Index k = joint.cols();
    core_.sizes = VectorXd::Zero(linear_);
    for (std::size_t s = 0; s < sizes_.size(); ++s)
      core_.sizes.segment(assembly_.first_column(s), sizes_[s].size()) = sizes_[s];
    core_.residual = VectorXd::Zero(n);
    core_.noise = plain_noise(plan, noise_um_);
    core_.left_out.assign(plan.size(), false);
    core_.undetermined.assign(static_cast<std::size_t>(k), false);
    core_.collides.assign(static_cast<std::size_t>(k), {});
    core_.covariance = MatrixXd::Zero(k, k);
    if (k > 0) covariance(joint / noise_um_);
    nonlinear_undetermined_.assign(core_.undetermined.begin() + linear_, core_.undetermined.end());
    collides_ = core_.collides;
    core_.undetermined.resize(static_cast<std::size_t>(linear_));
    core_.collides.resize(static_cast<std::size_t>(linear_));
    for (auto& list : core_.collides) std::erase_if(list, [&](Index c) { return c >= linear_; });
  }

  void covariance(const MatrixXd& white) {
    const Index k = white.cols();
    const VectorXd norm = white.colwise().norm();
    MatrixXd scaled = white;
    for (Index j = 0; j < k; ++j) scaled.col(j) *= norm(j) > 0.0 ? 1.0 / norm(j) : 0.0;
    const PivotedQr qr(scaled, kDependent);
    core_.rank = qr.rank();
    const MatrixXd inverse = qr.inverse_gram();
    for (Index i = 0; i < qr.rank(); ++i)
      for (Index j = 0; j < qr.rank(); ++j)
        core_.covariance(qr.place(i), qr.place(j)) = inverse(i, j) / (norm(qr.place(i)) * norm(qr.place(j)));
    if (qr.rank() > 0) core_.condition = qr.condition();
    for (Index i = qr.rank(); i < k; ++i) {
      const auto column = static_cast<std::size_t>(qr.place(i));
      core_.undetermined[column] = true;
      if (column < static_cast<std::size_t>(core_.sizes.size())) core_.sizes(qr.place(i)) = 0.0;
      if (norm(qr.place(i)) <= 0.0) continue;
      const VectorXd share = qr.share(i);
      for (Index m = 0; m < qr.rank(); ++m)
        if (std::abs(share(m)) > kTakesPart) {
          core_.collides[column].push_back(qr.place(m));
          core_.undetermined[static_cast<std::size_t>(qr.place(m))] = true;
        }
    }
  }

  [[nodiscard]] std::string owner_of(Index column) const {
    if (column >= linear_)
      return to_text(assembly_.slots[free_[static_cast<std::size_t>(column - linear_)].slot].effect);
    std::size_t s = 0;
    while (column >= assembly_.first_column(s) + assembly_.slots[s].columns.cols()) ++s;
    return to_text(assembly_.slots[s].effect);
  }

  /// Root mean square over its readings of the sigma of a curve's value.
  [[nodiscard]] std::optional<double> curve_sigma(std::size_t s) const {
    const Slot& slot = assembly_.slots[s];
    const Index count = slot.columns.cols(), at = assembly_.first_column(s);
    if (count == 0) return std::nullopt;
    const MatrixXd own = core_.covariance.block(at, at, count, count);
    double sum = 0.0, rows = 0.0;
    for (const std::size_t k : slot.acting.rows) {
      const double factor = slot.effect.definition().curve_factor({regressors_.data(), k, slot.effect});
      const VectorXd row = slot.columns.row(static_cast<Index>(k)).transpose() / factor;
      sum += row.dot(own * row);
      rows += 1.0;
    }
    return rows > 0.0 ? std::optional(std::sqrt(sum / rows)) : std::nullopt;
  }

  void finish(std::size_t s, PlanCheck& check) const {
    EffectFit& effect = check.effects[s];
    const std::string name = to_text(effect.effect);
    if (effect.readings == 0) {
      std::erase_if(check.undetermined, [&](const std::string& text) { return text.starts_with(name + ":"); });
      const std::string lacking = assembly_.slots[s].acting.lacking;
      check.undetermined.push_back(lacking.empty() ? fmt::format("{}: the plan does not show it", name)
                                                   : fmt::format("{}: the plan lacks {}", name, lacking));
      for (ParameterEstimate& estimate : effect.parameters) {
        if (estimate.held) continue;
        estimate.undetermined = true;
        estimate.sigma = std::nullopt;
      }
      return;
    }
    if (effect.effect.traits().is_curve && !effect.parameters.front().undetermined && !effect.parameters.front().held)
      effect.parameters.front().sigma = curve_sigma(s);
    for (std::size_t i = 0; i < free_.size(); ++i) {
      if (free_[i].slot != s || !nonlinear_undetermined_[i]) continue;
      nonlinear_undetermined(s, i, effect, check);
    }
  }

  void nonlinear_undetermined(std::size_t s, std::size_t i, EffectFit& effect, PlanCheck& check) const {
    const Slot& slot = assembly_.slots[s];
    const std::string parameter = slot.formulas ? slot.effect.user[slot.user_nonlinear[free_[i].j]].name
                                                : std::string(slot.effect.definition().searched_parameter());
    for (ParameterEstimate& estimate : effect.parameters)
      if (estimate.name == parameter) {
        estimate.undetermined = true;
        estimate.sigma = std::nullopt;
      }
    std::vector<std::string> others;
    for (const Index other : collides_[static_cast<std::size_t>(linear_) + i]) {
      const std::string owner = owner_of(other);
      if (std::ranges::find(others, owner) == others.end()) others.push_back(owner);
    }
    check.undetermined.push_back(
        others.empty() ? fmt::format("{}: no reading of the plan depends on its {}", to_text(slot.effect), parameter)
                       : fmt::format("{}: its {} cannot be distinguished from {}", to_text(slot.effect), parameter,
                                     fmt::join(others, ", ")));
  }

  const Model& model_;
  Assembly& assembly_;
  const Regressors& regressors_;
  double noise_um_;
  Index linear_ = 0;
  std::vector<VectorXd> sizes_;  ///< of each slot's columns
  std::vector<FreeParameter> free_;
  std::vector<bool> nonlinear_undetermined_;
  std::vector<std::vector<Index>> collides_;  ///< of linear columns, then of nonlinear parameters
  std::vector<std::string> assumed_;
  CoreFit core_;
};

}  // namespace

Result<PlanCheck> check_plan(const Model& model, const Observations& plan, double noise_um) {
  if (!(noise_um > 0.0)) return problem(ProblemKind::usage, "expected a noise above 0 um, got {}", noise_um);
  if (plan.size() == 0) return problem(ProblemKind::bad_input, "the plan has no rows to measure");
  Observations expected = plan;
  std::ranges::fill(expected.reading, 0.0);
  const Regressors regressors(expected);
  ECS_TRY(assembly, Assembly::of(model, regressors));
  return PlanJudge(model, assembly, regressors, noise_um).judged();
}

}  // namespace ecs::model
