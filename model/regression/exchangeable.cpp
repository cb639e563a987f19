#include "model/regression/exchangeable.hpp"

#include <algorithm>
#include <cmath>

#include "model/regression/candidates.hpp"

namespace ecs::model {
namespace {

/// Fitted values of an effect's columns, in the order of its parameters.
Eigen::VectorXd values_of(const EffectInstance& effect) {
  const auto& parameters = effect.definition().parameters;
  Eigen::VectorXd values = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(parameters.size()));
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const std::string name(parameters[i].name);
    const auto& from = effect.parameters.contains(name) ? effect.parameters : effect.fitted;
    if (const auto found = from.find(name); found != from.end()) values(static_cast<Eigen::Index>(i)) = found->second;
  }
  return values;
}

bool acts_on_ball(const EffectInstance& effect) {
  if (effect.is_user()) return false;
  const Place place = effect.definition().place;
  return place == Place::artefact || place == Place::location;
}

}  // namespace

double own_share(const Eigen::MatrixXd& others, const Eigen::VectorXd& column) {
  if (others.cols() == 0) return 1.0;
  return (column - others * others.colPivHouseholderQr().solve(column)).norm() / column.norm();
}

bool is_zero_of_axis(const EffectInstance& location) { return direction_of(*location.sense) == *location.axis; }

std::vector<Exchangeable> exchangeable_locations(const Observations& data, const std::vector<EffectInstance>& fitted) {
  std::vector<Exchangeable> list;
  if (data.through_chain.empty()) return list;
  const Regressors regressors(data);
  Eigen::MatrixXd known(static_cast<Eigen::Index>(data.size()), 0);
  Eigen::VectorXd values(0);
  for (const EffectInstance& one : fitted) {
    if (!acts_on_ball(one)) continue;
    const Eigen::MatrixXd columns = regressors.columns(one, 0.0).of;
    const Eigen::VectorXd own = values_of(one);
    if (own.size() != columns.cols()) continue;
    known.conservativeResize(Eigen::NoChange, known.cols() + columns.cols());
    known.rightCols(columns.cols()) = columns;
    values.conservativeResize(values.size() + own.size());
    values.tail(own.size()) = own;
  }
  if (known.cols() == 0) return list;
  const auto qr = known.colPivHouseholderQr();
  for (const EffectInstance& one : candidate_instances(data)) {
    if (one.definition().place != Place::location || is_zero_of_axis(one)) continue;
    if (std::any_of(fitted.begin(), fitted.end(), [&](const auto& other) { return same_place(one, other); })) continue;
    const Eigen::VectorXd column = regressors.columns(one, 0.0).of.col(0);
    const Eigen::VectorXd share = qr.solve(column);
    if ((column - known * share).norm() > kLeastOwnShare * column.norm()) continue;
    Exchangeable found{one, 0.0};
    for (Eigen::Index j = 0; j < share.size(); ++j)
      if (std::abs(share(j)) * known.col(j).norm() > kLeastOwnShare * column.norm())
        found.stands_for = std::max(found.stands_for, std::abs(values(j) / share(j)));
    list.push_back(std::move(found));
  }
  return list;
}

}  // namespace ecs::model
