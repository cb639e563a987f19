// Gradients of the predictions in every fitted parameter, from predictions with changed parameters; variances by the
// law of propagation of uncertainty (GUM 5.1.2). Where a coordinate has a value that no reading has: cross-validation
// by the values of that coordinate (Roberts et al. 2017, Ecography 40, 913).
#include "model/diagnosis/support.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "base/linear/decompositions.hpp"
#include "model/diagnosis/bad_run.hpp"
#include "model/fit/core.hpp"

namespace ecs::model {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

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

/// What readings can have in common: a coordinate, by the number of its axis, or the run.
constexpr std::size_t kRun = kAxes;

/// In steps that are one value: 1 um, 0.001 deg.
long value_of(const Observations& data, std::size_t k, std::size_t of) {
  return of == kRun ? data.run[k] : std::lround(data.position_mm[k][of] * 1e3);
}

/// Readings predicted from those at other values, squares added up.
struct Predicted {
  double squares = 0.0;
  double of_noise = 0.0, of_sizes = 0.0;  ///< expected of them if the model is right
  double count = 0.0;
  /// By twice as much as the noise and the fitted sizes explain: a choice; by chance never with so many readings.
  [[nodiscard]] bool is_bad() const {
    constexpr double kFactor = 2.0, kFewest = 12.0;
    return count >= kFewest && squares > kFactor * kFactor * (of_noise + of_sizes);
  }
  [[nodiscard]] double rms() const { return std::sqrt(squares / count); }
  /// Without the noise.
  [[nodiscard]] double sigma() const { return std::sqrt((squares - of_noise) / count); }
  [[nodiscard]] double factor() const { return std::sqrt(squares / (of_noise + of_sizes)); }
};

/// What is left out in turn: runs, or values of a coordinate between others and its least and greatest.
struct Unseen {
  std::set<long> values;  ///< empty: too few or too many to leave them out
  Predicted between, beyond;
};

Unseen unseen_values(const Observations& data, const Assembly& assembly, const CoreFit& core, std::size_t of) {
  constexpr std::size_t kFewestUnseen = 3, kMostUnseen = 200;
  constexpr double kDetermined = 1e-6;  // of a row
  Unseen unseen;
  for (std::size_t k = 0; k < data.size(); ++k) unseen.values.insert(value_of(data, k, of));
  if (unseen.values.size() < kFewestUnseen || unseen.values.size() > kMostUnseen) unseen.values.clear();
  const MatrixXd columns = assembly.columns();
  const VectorXd target =
      Eigen::Map<const VectorXd>(data.reading.data(), static_cast<Index>(data.size())) - assembly.fixed(data.size());
  const std::vector<double> noise = core.noise.sigma_by_row(data.size());
  for (const long value : unseen.values) {
    std::vector<bool> hidden = core.left_out;
    for (std::size_t k = 0; k < data.size(); ++k) hidden[k] = hidden[k] || value_of(data, k, of) == value;
    const Whitener whitener(data, core.noise, hidden);
    const MatrixXd white = whitener(columns), inverse = pseudo_inverse(white);
    const VectorXd sizes = inverse * whitener(target);
    const bool is_end = of != kRun && (value == *unseen.values.begin() || value == *unseen.values.rbegin());
    Predicted& predicted = is_end ? unseen.beyond : unseen.between;
    for (std::size_t k = 0; k < data.size(); ++k) {
      if (core.left_out[k] || value_of(data, k, of) != value) continue;
      const Eigen::RowVectorXd row = columns.row(static_cast<Index>(k)), by_readings = row * inverse;
      if ((row - by_readings * white).norm() > kDetermined * row.norm()) continue;  // the others do not determine it
      const double error = target(static_cast<Index>(k)) - row.dot(sizes);
      predicted.squares += error * error;
      predicted.of_noise += noise[k] * noise[k];
      predicted.of_sizes += by_readings.squaredNorm();
      predicted.count += 1.0;
    }
  }
  return unseen;
}

/// "in a run", "at a value of c_deg"
std::string words_for(const Observations& data, std::size_t of) {
  return of == kRun ? "in a run" : fmt::format("at a value of {}", data.position_name(static_cast<Axis>(of)));
}

/// Marks the places in a run, or at a value of a coordinate, that no reading has, if readings are predicted badly from
/// those in other runs, or at other values.
void mark_unseen(const Observations& data, const Observations& at, const Assembly& assembly, const CoreFit& core,
                 bool and_runs, Supports& supports) {
  if (!data.paths.empty() || !at.paths.empty()) return;
  for (std::size_t of = 0; of < kAxes + (and_runs ? 1 : 0); ++of) {
    const Unseen unseen = unseen_values(data, assembly, core, of);
    if (unseen.values.empty()) continue;
    std::map<bool, std::size_t> marked;
    for (std::size_t k = 0; k < at.size(); ++k) {
      const long value = value_of(at, k, of);
      const bool is_beyond = of != kRun && (value < *unseen.values.begin() || value > *unseen.values.rbegin());
      const Predicted& predicted = is_beyond ? unseen.beyond : unseen.between;
      if (unseen.values.contains(value) || !predicted.is_bad()) continue;
      Support& one = supports.places[k];
      one.sigma = std::max(one.sigma, predicted.sigma());
      one.extrapolated = true;
      ++marked[is_beyond];
    }
    for (const auto& [is_beyond, count] : marked) {
      const Predicted& predicted = is_beyond ? unseen.beyond : unseen.between;
      supports.notes.push_back(fmt::format(
          "extrapolated predictions {} without a reading: {}. The model lacks an effect: readings {} differ from their "
          "predictions by the other ones by {:.3g} {} rms, {:.1f} times as much as noise and fit explain",
          words_for(data, of), count,
          of == kRun  ? "of one run"
          : is_beyond ? "at an end value"
                      : "at one value",
          predicted.rms(), data.reading_unit(), predicted.factor()));
    }
  }
}

/// Marks the places in other runs if every pass has a zero of its own, and returns whether it has.
bool mark_other_runs(const Observations& data, const Observations& at, const CoreFit& core, Supports& supports) {
  const auto passes = scatter_of_passes(data, core.residual, core.left_out);
  if (!passes) return false;
  const std::set<int> runs(data.run.begin(), data.run.end());
  std::size_t marked = 0;
  for (std::size_t k = 0; k < at.size(); ++k) {
    if (runs.contains(at.run[k])) continue;
    Support& one = supports.places[k];
    one.sigma = std::hypot(one.sigma, passes->between_um);
    one.extrapolated = true;
    ++marked;
  }
  if (marked > 0)
    supports.notes.push_back(fmt::format(
        "extrapolated predictions in a run without a reading: {}. Each pass has a zero of its own: passes differ by "
        "{:.3g} {} (one standard deviation), readings within a pass by {:.3g}. The zero of a further pass cannot be "
        "predicted",
        marked, passes->between_um, data.reading_unit(), passes->within_um));
  return true;
}

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
  const bool has_zeros = mark_other_runs(data, at, core, supports);
  mark_unseen(data, at, assembly, core, !has_zeros, supports);
  return supports;
}

}  // namespace ecs::model
