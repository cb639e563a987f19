// Gradients of the predictions in every fitted parameter, from predictions with changed parameters; variances by the
// law of propagation of uncertainty (GUM 5.1.2).
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "model/fit/core.hpp"

namespace ecs::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// A model with one parameter above its value, and for a nonlinear one below it.
struct Change {
  Model above;
  std::optional<Model> below{};
  double step = 0.0;
};

/// In the order of the covariance: sizes, then the free nonlinear parameters.
std::vector<Change> changes_of(const Model& model, Assembly& assembly, const Regressors& regressors, CoreFit& core) {
  constexpr double kPart = 1e-5, kLeast = 1e-7;  // of a nonlinear parameter
  std::vector<Change> changes;
  const auto now = [&] { return with_values(model, reported(assembly, regressors, core)); };
  for (Index j = 0; j < core.sizes.size(); ++j) {
    const double size = core.sizes(j), sigma = std::sqrt(std::max(core.covariance(j, j), 0.0));
    const double step = sigma > 0.0 ? sigma : 1.0;
    core.sizes(j) = size + step;
    changes.push_back({now(), std::nullopt, step});
    core.sizes(j) = size;
  }
  for (std::size_t s = 0; s < assembly.slots.size(); ++s)
    for (std::size_t j = 0; j < assembly.slots[s].nonlinear.size(); ++j) {
      if (!assembly.slots[s].nonlinear_free[j] || !assembly.slots[s].has_slope()) continue;
      const double value = assembly.slots[s].nonlinear[j], step = std::max(std::abs(value) * kPart, kLeast);
      const auto at = [&](double changed) {
        assembly.slots[s].nonlinear[j] = changed;
        assembly.renew(s, regressors);
        return now();
      };
      Model above = at(value + step), below = at(value - step);
      changes.push_back({std::move(above), std::move(below), step});
      static_cast<void>(at(value));
    }
  return changes;
}

/// (places × changes); one-sided where a formula has no value below.
Result<MatrixXd> gradient_of(const Model& model, const std::vector<Change>& changes, const Observations& at) {
  MatrixXd gradient(static_cast<Index>(at.size()), static_cast<Index>(changes.size()));
  ECS_TRY(here, predicted(model, at));
  for (std::size_t j = 0; j < changes.size(); ++j) {
    ECS_TRY(above, predicted(changes[j].above, at));
    std::vector<double> below = here;
    double apart = changes[j].step;
    if (changes[j].below)
      if (auto found = predicted(*changes[j].below, at)) {
        below = std::move(*found);
        apart *= 2.0;
      }
    for (std::size_t k = 0; k < at.size(); ++k)
      gradient(static_cast<Index>(k), static_cast<Index>(j)) = (above[k] - below[k]) / apart;
  }
  return gradient;
}

/// Of the readings of one sense and axis.
struct Reached {
  double sigma = 0.0, least = std::numeric_limits<double>::infinity(), greatest = -least;
};

}  // namespace

Result<Supports> support_of(const Model& model, const Observations& data, const Observations& at) {
  constexpr double kMore = 1.1;      // so much between readings is no extrapolation: a choice
  constexpr double kBeyond = 0.01;   // of the range of positions: rounding
  constexpr double kOtherFit = 2.0;  // standard uncertainties
  const Regressors regressors(data);
  ECS_TRY(assembly, Assembly::of(model, regressors));
  CoreOptions options;
  options.from_values = true;
  CoreFit core = fitted(assembly, regressors, options);
  const Model refitted = with_values(model, reported(assembly, regressors, core));
  const std::vector<Change> changes = changes_of(model, assembly, regressors, core);
  ECS_TRY(of_data, gradient_of(refitted, changes, data));
  ECS_TRY(of_points, gradient_of(refitted, changes, at));
  ECS_TRY(of_model, predicted(model, data));
  ECS_TRY(of_fit, predicted(refitted, data));
  const auto sigma = [&](const MatrixXd& gradient, std::size_t k) {
    const auto row = gradient.row(static_cast<Index>(k));
    return std::sqrt(std::max(row.dot(core.covariance * row.transpose()), 0.0));
  };
  Supports supports;
  std::map<std::pair<Channel, Axis>, Reached> reached;
  for (std::size_t k = 0; k < data.size(); ++k) {
    if (core.left_out[k]) continue;
    Reached& here = reached[{data.channel(k), data.axis[k]}];
    const double of_reading = sigma(of_data, k);
    here.sigma = std::max(here.sigma, of_reading);
    here.least = std::min(here.least, data.along_of(k));
    here.greatest = std::max(here.greatest, data.along_of(k));
    supports.is_other_fit = supports.is_other_fit || std::abs(of_model[k] - of_fit[k]) > kOtherFit * of_reading + 1e-6;
  }
  for (std::size_t k = 0; k < at.size(); ++k) {
    Support one{sigma(of_points, k), true};
    if (const auto found = reached.find({at.channel(k), at.axis[k]}); found != reached.end()) {
      const Reached& here = found->second;
      const double margin = kBeyond * (here.greatest - here.least);
      const bool is_beyond =
          !at.on_path(k) && (at.along_of(k) < here.least - margin || at.along_of(k) > here.greatest + margin);
      one.extrapolated = is_beyond || one.sigma > kMore * here.sigma;
    }
    supports.places.push_back(one);
  }
  return supports;
}

}  // namespace ecs::model
