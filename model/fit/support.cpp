// Gradients of the predictions in every fitted parameter, from predictions with changed parameters; variances by the
// law of propagation of uncertainty (GUM 5.1.2).
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "model/fit/core.hpp"

namespace ecs::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// A model with one parameter above and below its value.
struct Change {
  Model above, below;
  double step = 0.0;
};

/// In the order of the covariance: sizes, then the free nonlinear parameters.
std::vector<Change> changes_of(const Model& model, Assembly& assembly, const Regressors& regressors, CoreFit& core) {
  constexpr double kPart = 1e-5, kLeast = 1e-7;  // of a nonlinear parameter
  std::vector<Change> changes;
  const auto now = [&] { return with_values(model, reported(assembly, regressors, core)); };
  for (Index j = 0; j < core.sizes.size(); ++j) {
    const double size = core.sizes(j), sigma = std::sqrt(std::max(core.covariance(j, j), 0.0));
    Change change;
    change.step = sigma > 0.0 ? sigma : 1.0;
    core.sizes(j) = size + change.step;
    change.above = now();
    core.sizes(j) = size - change.step;
    change.below = now();
    core.sizes(j) = size;
    changes.push_back(std::move(change));
  }
  for (std::size_t s = 0; s < assembly.slots.size(); ++s)
    for (std::size_t j = 0; j < assembly.slots[s].nonlinear.size(); ++j) {
      if (!assembly.slots[s].nonlinear_free[j] || !assembly.slots[s].has_slope()) continue;
      const double value = assembly.slots[s].nonlinear[j];
      const auto at = [&](double changed) {
        assembly.slots[s].nonlinear[j] = changed;
        assembly.renew(s, regressors);
        return now();
      };
      Change change;
      change.step = std::max(std::abs(value) * kPart, kLeast);
      change.above = at(value + change.step);
      change.below = at(value - change.step);
      static_cast<void>(at(value));
      changes.push_back(std::move(change));
    }
  return changes;
}

/// (places × changes)
Result<MatrixXd> gradient_of(const std::vector<Change>& changes, const Observations& at) {
  MatrixXd gradient(static_cast<Index>(at.size()), static_cast<Index>(changes.size()));
  for (std::size_t j = 0; j < changes.size(); ++j) {
    ECS_TRY(above, predicted(changes[j].above, at));
    ECS_TRY(below, predicted(changes[j].below, at));
    for (std::size_t k = 0; k < at.size(); ++k)
      gradient(static_cast<Index>(k), static_cast<Index>(j)) = (above[k] - below[k]) / (2.0 * changes[j].step);
  }
  return gradient;
}

}  // namespace

Result<std::vector<Support>> support_of(const Model& model, const Observations& data, const Observations& at) {
  const Regressors regressors(data);
  ECS_TRY(assembly, Assembly::of(model, regressors));
  CoreOptions options;
  options.from_values = true;
  CoreFit core = fitted(assembly, regressors, options);
  const std::vector<Change> changes = changes_of(model, assembly, regressors, core);
  ECS_TRY(of_data, gradient_of(changes, data));
  ECS_TRY(of_points, gradient_of(changes, at));
  const auto sigma = [&](const MatrixXd& gradient, std::size_t k) {
    const auto row = gradient.row(static_cast<Index>(k));
    return std::sqrt(std::max(row.dot(core.covariance * row.transpose()), 0.0));
  };
  std::map<std::pair<Channel, Axis>, double> greatest;  // at the readings
  for (std::size_t k = 0; k < data.size(); ++k)
    if (!core.left_out[k]) {
      double& most = greatest[{data.channel(k), data.axis[k]}];
      most = std::max(most, sigma(of_data, k));
    }
  constexpr double kMore = 1.1;  // so much between readings is no extrapolation: a choice
  std::vector<Support> support(at.size());
  for (std::size_t k = 0; k < at.size(); ++k) {
    support[k].sigma = sigma(of_points, k);
    const auto most = greatest.find({at.channel(k), at.axis[k]});
    support[k].extrapolated = most == greatest.end() || support[k].sigma > kMore * most->second;
  }
  return support;
}

}  // namespace ecs::model
