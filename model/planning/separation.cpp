// T-optimality (Atkinson and Fedorov 1975): the χ² by which a rival, refitted to present and new readings together,
// would fail if an explanation is true; refits by orthogonal projection in the whitened space, curves with as many
// functions as Schwarz's criterion (1978) asks for.
#include "model/planning/separation.hpp"

#include <algorithm>
#include <cmath>

#include "model/effects/definition.hpp"
#include "model/fit/search.hpp"
#include "model/fit/statistics.hpp"
#include "model/fit/user_start.hpp"
#include "model/linear/decompositions.hpp"
#include "model/regression/user_formula.hpp"

namespace ecs::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A column of which less than this (of its norm) is left beside others does what they do.
constexpr double kDependentColumn = 1e-5;
/// Change of a nonlinear parameter for its slope: this share of it, and at least this: half the digits of a double.
constexpr double kSlopeStep = 1e-5, kLeastSlopeStep = 1e-7;

void append(MatrixXd& to, const MatrixXd& columns) {
  const Index had = to.cols();
  to.conservativeResize(columns.rows(), had + columns.cols());
  to.rightCols(columns.cols()) = columns;
}

/// Nonlinear values and noise from a fit to the present readings.
Result<std::pair<Assembly, CoreFit>> fitted_to(const Model& model, const Regressors& present) {
  ECS_TRY(assembly, Assembly::of(model, present));
  CoreOptions options;
  options.all_curve_functions = true;
  CoreFit core = fitted(assembly, present, options);
  return std::pair{std::move(assembly), std::move(core)};
}

/// Slopes of the free nonlinear parameters of the model at the sizes found.
MatrixXd slopes_of(Assembly& assembly, const Assembly& fitted_assembly, const VectorXd& sizes, const Regressors& all) {
  MatrixXd slopes(static_cast<Index>(all.data().size()), 0);
  for (std::size_t s = 0; s < assembly.slots.size(); ++s) {
    const Slot& slot = assembly.slots[s];
    if (!slot.has_slope()) continue;
    for (std::size_t j = 0; j < slot.nonlinear.size(); ++j) {
      if (!slot.nonlinear_free[j]) continue;
      const Index first = fitted_assembly.first_column(s);
      const VectorXd own = sizes.segment(first, fitted_assembly.slots[s].columns.cols());
      if (own.size() == slot.columns.cols()) append(slopes, assembly.slope(s, j, own, all));
    }
  }
  return slopes;
}

/// The effect with its fitted values as the starting values of its formulas.
EffectInstance started_at_fit(EffectInstance effect) {
  for (UserParameter& parameter : effect.user)
    if (const auto value = effect.fitted.find(parameter.name); value != effect.fitted.end())
      parameter.start = value->second;
  return effect;
}

/// Change of a nonlinear parameter for its slope.
double slope_step(double value) { return std::max(std::abs(value) * kSlopeStep, kLeastSlopeStep); }

/// Columns of an effect that are fitted, what it holds as its fixed part.
Columns free_columns(const Regressors& regressors, const EffectInstance& effect, double nonlinear) {
  const Columns all = regressors.columns(effect, nonlinear);
  if (effect.traits().is_curve || effect.is_user()) return all;
  Columns free;
  free.fixed = all.fixed.size() > 0 ? all.fixed : VectorXd(VectorXd::Zero(all.of.rows()));
  free.of.resize(all.of.rows(), 0);
  for (Index j = 0; j < all.of.cols(); ++j) {
    if (const auto held = held_coefficient(effect, static_cast<std::size_t>(j)))
      free.fixed += *held * all.of.col(j);
    else
      append(free.of, all.of.col(j));
  }
  return free;
}

/// Sizes of whitened columns beside a base that is absorbed first; 0 for what the base or the others do as well.
VectorXd sizes_beside(const MatrixXd& base, const MatrixXd& columns, const VectorXd& target) {
  Space space;
  space.y = target;
  space.q.resize(target.size(), 0);
  absorb(space, base);
  VectorXd sizes = VectorXd::Zero(columns.cols());
  const MatrixXd left = without(space.q, columns);
  std::vector<Index> kept;
  for (Index j = 0; j < columns.cols(); ++j)
    if (left.col(j).norm() > kDependentColumn * columns.col(j).norm()) kept.push_back(j);
  if (kept.empty()) return sizes;
  MatrixXd own(target.size(), static_cast<Index>(kept.size()));
  VectorXd scale(own.cols());
  for (Index j = 0; j < own.cols(); ++j) {
    const auto column = kept[static_cast<std::size_t>(j)];
    scale(j) = 1.0 / left.col(column).norm();
    own.col(j) = left.col(column) * scale(j);
  }
  const PivotedQr qr(own, kDependentColumn);
  const VectorXd first = qr.independent_sizes(space.y);
  for (Index i = 0; i < qr.rank(); ++i) {
    const Index j = qr.place(i);
    sizes(kept[static_cast<std::size_t>(j)]) = first(i) * scale(j);
  }
  return sizes;
}

/// Leading columns of a curve that the present readings call for (Schwarz); all of anything else.
Index columns_called_for(const EffectInstance& effect, const Columns& columns, const MatrixXd& base,
                         const VectorXd& target, const Whitener& whitener) {
  if (!effect.traits().is_curve) return columns.of.cols();
  const auto n = static_cast<double>(target.size());
  const MatrixXd own = whitener(MatrixXd(columns.of.topRows(target.size())));
  Space space;
  space.y = whitener(target);
  space.q.resize(space.y.size(), 0);
  absorb(space, whitener(MatrixXd(base.topRows(target.size()))));
  Index best = std::min<Index>(1, columns.of.cols());
  double least = kBeyondAll;
  for (Index j = 0; j < own.cols(); ++j) {
    absorb(space, own.col(j));
    const double price = space.chi2() + std::log(n) * static_cast<double>(j + 1);
    if (price < least) {
      least = price;
      best = j + 1;
    }
  }
  return best;
}

/// Of the present circle of that name, else of any; without circles that of a reading of the lines.
NoiseGroup noise_of_circle(const Belief& belief, const std::string& name) {
  NoiseGroup group;
  group.white = belief.noise.pure.noise_um;
  for (const NoiseGroup& known : belief.noise.groups)
    if (!known.path.empty() && (group.path.empty() || known.path == name)) group = known;
  return group;
}

NoiseModel with_new_rows(const Belief& belief, const WithProposals& all,
                         const std::vector<MeasurementProposal>& proposals) {
  NoiseModel noise = belief.noise;
  noise.shapes.clear();
  for (std::size_t i = 0; i < proposals.size(); ++i) {
    NoiseGroup group;
    group.white = belief.noise.pure.noise_um;
    for (const NoiseGroup& known : belief.noise.groups)
      if (known.path.empty() && !proposals[i].circle && known.sense == proposals[i].sense &&
          known.axis == proposals[i].axis)
        group = known;
    if (proposals[i].circle) group = noise_of_circle(belief, name_of(*proposals[i].circle));
    group.rows.clear();
    for (std::size_t k = 0; k < all.count[i]; ++k) group.rows.push_back(all.first[i] + k);
    noise.groups.push_back(std::move(group));
  }
  return noise;
}

}  // namespace

Result<Belief> belief_of(const Model& model, const std::vector<EffectInstance>& known,
                         const std::vector<EffectInstance>& likely, const Observations& present,
                         const Regressors& all) {
  Model with = model;
  with.effects.insert(with.effects.end(), known.begin(), known.end());
  Model more = with;
  more.effects.insert(more.effects.end(), likely.begin(), likely.end());
  const Regressors now(present);
  ECS_TRY(found, fitted_to(with, now));
  auto& [assembly, core] = found;
  Belief belief;
  belief.noise = core.noise;
  belief.left_out = core.left_out;
  if (!likely.empty())
    if (auto better = fitted_to(more, now)) {
      belief.noise = better->second.noise;
      belief.left_out = better->second.left_out;
    }
  belief.target = Eigen::Map<const VectorXd>(present.reading.data(), static_cast<Index>(present.size())) -
                  assembly.fixed(present.size());
  ECS_TRY(wide, Assembly::of(with, all));
  for (std::size_t s = 0; s < wide.slots.size(); ++s) {
    wide.slots[s].nonlinear = assembly.slots[s].nonlinear;
    wide.renew(s, all);
  }
  belief.columns.resize(static_cast<Index>(all.data().size()), 0);
  if (!wide.slots.empty()) belief.columns = wide.columns();
  append(belief.columns, slopes_of(wide, assembly, core.sizes, all));
  return belief;
}

Explanation explained_by(const std::string& name, const EffectInstance& believed, const Belief& belief,
                         const WithProposals& all, const Regressors& regressors) {
  const EffectInstance effect = started_at_fit(believed);
  const auto present = static_cast<Index>(all.present);
  const std::string parameter(effect.definition().searched_parameter());
  const auto value = effect.fitted.find(parameter);
  const double nonlinear = value == effect.fitted.end() ? 0.0 : value->second;
  const Columns columns = free_columns(regressors, effect, nonlinear);
  const Whitener whitener(present_of(all), belief.noise, belief.left_out);
  Explanation one;
  one.name = name;
  one.fixed = columns.fixed.size() > 0 ? columns.fixed : VectorXd(VectorXd::Zero(columns.of.rows()));
  one.columns = columns.of;
  const VectorXd target = belief.target - one.fixed.head(present);
  const MatrixXd base = belief.columns.topRows(present);
  const Index used = columns_called_for(effect, columns, base, target, whitener);
  const VectorXd sizes =
      sizes_beside(whitener(base), whitener(MatrixXd(columns.of.topRows(present).leftCols(used))), whitener(target));
  one.truth = one.fixed + columns.of.leftCols(used) * sizes;
  if (!parameter.empty() && effect.definition().search.has_slope && !effect.parameters.contains(parameter)) {
    const double change = slope_step(nonlinear);
    const Columns moved = free_columns(regressors, effect, nonlinear + change);
    append(one.columns, (moved.of.leftCols(used) * sizes + moved.fixed - one.truth) / change);
  }
  if (effect.is_user())
    for (const std::size_t i : nonlinear_user_parameters(effect, all.data)) {
      EffectInstance moved = effect;
      const double change = slope_step(start_of(effect.user[i]));
      moved.user[i].start = start_of(effect.user[i]) + change;
      append(one.columns, (free_columns(regressors, moved, 0.0).of * sizes - columns.of * sizes) / change);
    }
  return one;
}

Separations::Separations(const WithProposals& all, const std::vector<MeasurementProposal>& proposals,
                         const Belief& belief, const std::vector<Explanation>& explanations, bool zero_matters)
    : all_(all), proposals_(proposals), zero_matters_(zero_matters) {
  MatrixXd everything = belief.columns;
  base_ = everything.cols();
  for (const Explanation& one : explanations) {
    first_.push_back(everything.cols());
    count_.push_back(one.columns.cols());
    append(everything, one.columns);
    append(everything, one.fixed);
    append(everything, one.truth);
  }
  const NoiseModel noise = with_new_rows(belief, all, proposals);
  std::vector<bool> left_out = belief.left_out;
  left_out.resize(all.data.size(), false);
  const MatrixXd white = Whitener(all.data, noise, left_out)(everything);
  const auto present = static_cast<Index>(all.present);
  present_ = white.topRows(present);
  if (present > white.cols()) present_ = PivotedQr(present_).basis().transpose() * present_;
  white_ = white.bottomRows(white.rows() - present);
  for (std::size_t i = 0; i < proposals.size(); ++i)
    sigma_.push_back(noise.groups[belief.noise.groups.size() + i].sigma());
  present_squares_ = squares(present_, false);
}

MatrixXd Separations::squares(const MatrixXd& rows, bool own_zero) const {
  const auto count = static_cast<Index>(first_.size());
  Space base;
  base.y = VectorXd::Zero(rows.rows());
  base.q.resize(rows.rows(), 0);
  absorb(base, rows.leftCols(base_));
  if (own_zero) absorb(base, rows.rightCols(1));
  MatrixXd result = MatrixXd::Zero(count, count + 1);
  for (Index j = 0; j <= count; ++j) {
    Space space = base;
    const bool alone = j == count;
    if (!alone)
      absorb(space, rows.middleCols(first_[static_cast<std::size_t>(j)], count_[static_cast<std::size_t>(j)]));
    for (Index i = 0; i < count; ++i) {
      if (i == j) continue;
      const auto ii = static_cast<std::size_t>(i);
      VectorXd left = rows.col(first_[ii] + count_[ii] + 1);
      if (!alone) left -= rows.col(first_[static_cast<std::size_t>(j)] + count_[static_cast<std::size_t>(j)]);
      result(i, j) = without(space.q, std::move(left)).squaredNorm();
    }
  }
  return result;
}

MatrixXd Separations::of(std::size_t proposal, int runs) const {
  const auto first = static_cast<Index>(all_.first[proposal] - all_.present);
  const auto count = static_cast<Index>(all_.count[proposal]);
  const bool own_zero = proposals_[proposal].own_zero;
  const bool zero = proposals_[proposal].new_set_up || own_zero;
  const Index extra = zero ? 1 : 0;
  // optics that were reset have a zero of their own: free on another line, as good as the mean of ten readings on the
  // same line, where it is set at the same target
  const Index prior = zero && !own_zero && !proposals_[proposal].other_line && !zero_matters_ ? 1 : 0;
  MatrixXd rows = MatrixXd::Zero(present_.rows() + count + prior, white_.cols() + extra);
  rows.topLeftCorner(present_.rows(), white_.cols()) = present_;
  const double weight = std::sqrt(static_cast<double>(runs));
  rows.block(present_.rows(), 0, count, white_.cols()) = weight * white_.middleRows(first, count);
  if (zero) rows.block(present_.rows(), white_.cols(), count, 1).setConstant(weight / sigma_[proposal]);
  constexpr double kReadings = 10.0;  // a choice: that many readings are averaged in effect where a zero is set
  if (prior > 0) rows(rows.rows() - 1, white_.cols()) = std::sqrt(kReadings) / sigma_[proposal];
  return (squares(rows, zero) - present_squares_).cwiseMax(0.0).cwiseSqrt();
}

}  // namespace ecs::model
