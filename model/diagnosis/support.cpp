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
constexpr long kTurn = 360'000;

/// In steps that are one value: 1 um, 0.001 deg; angles within a turn.
long value_of(const Observations& data, std::size_t k, std::size_t of) {
  if (of == kRun) return data.run[k];
  const long value = std::lround(data.position_mm[k][of] * 1e3);
  return data.rotary ? ((value % kTurn) + kTurn) % kTurn : value;
}

/// Readings predicted from those at other values, squares added up.
struct Predicted {
  double squares = 0.0;
  double of_noise = 0.0, of_sizes = 0.0;  ///< expected of them if the model is right
  double count = 0.0;
  /// By twice as much as the noise and the fitted sizes explain: a choice. Where the uncertainty of the sizes is most
  /// of it, all errors may be multiples of one: chi-square of one degree of freedom, once in 10,000.
  [[nodiscard]] bool is_bad() const {
    constexpr double kTwice = 4.0, kOfOne = 15.1, kFewest = 12.0;
    return count >= kFewest && squares > (of_sizes > of_noise ? kOfOne : kTwice) * (of_noise + of_sizes);
  }
  [[nodiscard]] double rms() const { return std::sqrt(squares / count); }
  /// Without the noise.
  [[nodiscard]] double sigma() const { return std::sqrt((squares - of_noise) / count); }
  [[nodiscard]] double factor() const { return std::sqrt(squares / (of_noise + of_sizes)); }
};

/// One sense along one axis, or all poses of a ball: its readings, and the zeros of its passes.
struct OneLine {
  std::pair<Channel, Axis> key;
  std::vector<bool> not_of_it;  ///< outliers, and all readings of others
  std::optional<ScatterOfPasses> zeros{};
  [[nodiscard]] bool has(const Observations& data, std::size_t k) const {
    return !data.through_chain.empty() || std::pair(data.channel(k), data.axis[k]) == key;
  }
};

/// What is left out in turn: runs, or values of a coordinate between others and its least and greatest.
class Unseen {
 public:
  Unseen(const Observations& data, const OneLine& line, std::size_t of) : data_(data), line_(line), of_(of) {
    for (std::size_t k = 0; k < data.size(); ++k)
      if (!line.not_of_it[k]) values_.insert(value_of(data, k, of));
    if (of == kRun || values_.empty()) return;
    long widest = *values_.begin() + kTurn - *values_.rbegin(), before = *values_.begin();
    for (const long value : values_) widest = std::max(widest, value - std::exchange(before, value));
    has_ends_ = !data.rotary || widest >= kTurn / 2;
  }
  [[nodiscard]] bool is_new(long value) const { return !values_.contains(value); }
  [[nodiscard]] bool is_beyond(long value) const {
    return has_ends_ && (value < *values_.begin() || value > *values_.rbegin());
  }
  /// Those between the others, or the two at the ends. Sizes are fitted to the others, all else is that of the fit.
  [[nodiscard]] Predicted predicted(const Assembly& assembly, const CoreFit& core, bool at_ends) const {
    constexpr std::size_t kFewestUnseen = 3, kMostUnseen = 200;
    constexpr double kNothing = 1e-9, kDetermined = 1e-6;  // of a row
    Predicted found;
    if (values_.size() < kFewestUnseen || values_.size() > kMostUnseen) return found;
    const MatrixXd columns = assembly.columns();
    const VectorXd target = Eigen::Map<const VectorXd>(data_.reading.data(), static_cast<Index>(data_.size())) -
                            assembly.fixed(data_.size());
    const std::vector<double> noise = core.noise.sigma_by_row(data_.size());
    const double of_zero = line_.zeros ? line_.zeros->between_um * line_.zeros->between_um : 0.0;
    for (const long value : values_) {
      if ((has_ends_ && (value == *values_.begin() || value == *values_.rbegin())) != at_ends) continue;
      std::vector<bool> hidden = core.left_out;
      for (std::size_t k = 0; k < data_.size(); ++k) hidden[k] = hidden[k] || is_at(k, value);
      const Whitener whitener(data_, core.noise, hidden);
      const MatrixXd white = whitener(columns);
      const RowSpace space = row_space_of(white, kNothing);
      const VectorXd sizes = space.back * (space.back.transpose() * (white.transpose() * whitener(target)));
      for (std::size_t k = 0; k < data_.size(); ++k) {
        if (!is_at(k, value)) continue;
        const Eigen::RowVectorXd row = columns.row(static_cast<Index>(k));
        if ((row * space.free).norm() > kDetermined * row.norm()) continue;  // the others do not determine it
        const double error = target(static_cast<Index>(k)) - row.dot(sizes);
        found.squares += error * error;
        found.of_noise += noise[k] * noise[k] + of_zero;
        found.of_sizes += (row * space.back).squaredNorm();
        found.count += 1.0;
      }
    }
    return found;
  }

 private:
  [[nodiscard]] bool is_at(std::size_t k, long value) const {
    return !line_.not_of_it[k] && value_of(data_, k, of_) == value;
  }
  const Observations& data_;
  const OneLine& line_;
  std::size_t of_;
  std::set<long> values_;
  bool has_ends_ = false;
};

/// "extrapolated predictions of EX along X at a value of x_mm without a reading: 2"
std::string words_for(const Observations& data, const OneLine& line, std::size_t of, std::size_t count) {
  const std::string what =
      data.through_chain.empty()
          ? fmt::format(" of {} along {}", name_of(static_cast<Sense>(line.key.first)), data.letter(line.key.second))
          : "";
  const std::string where =
      of == kRun ? "in a run" : fmt::format("at a value of {}", data.position_name(static_cast<Axis>(of)));
  return fmt::format("extrapolated predictions{} {} without a reading: {}", what, where, count);
}

/// Marks the places of a line in a run, or at a value of a coordinate, that none of its readings has, if its readings
/// are predicted badly from those in other runs, or at other values; or if its passes have zeros of their own.
void mark_unseen(const Observations& data, const Observations& at, const Assembly& assembly, const CoreFit& core,
                 const OneLine& line, Supports& supports) {
  const std::string_view unit = laser::unit_of(static_cast<Sense>(line.key.first));
  for (std::size_t of = 0; of <= kRun; ++of) {
    const Unseen unseen(data, line, of);
    std::map<bool, std::vector<std::size_t>> places;  // beyond, or between
    for (std::size_t k = 0; k < at.size(); ++k)
      if (const long value = value_of(at, k, of); line.has(at, k) && unseen.is_new(value))
        places[unseen.is_beyond(value)].push_back(k);
    for (const auto& [is_beyond, list] : places) {
      const bool has_zeros = of == kRun && line.zeros;
      const Predicted predicted = has_zeros ? Predicted{} : unseen.predicted(assembly, core, is_beyond);
      if (!has_zeros && !predicted.is_bad()) continue;
      for (const std::size_t k : list) {
        Support& one = supports.places[k];
        one.sigma = has_zeros ? std::hypot(one.sigma, line.zeros->between_um) : std::max(one.sigma, predicted.sigma());
        one.extrapolated = true;
      }
      std::string note = words_for(data, line, of, list.size());
      if (has_zeros)
        note += fmt::format(
            ". Each pass has a zero of its own: passes differ by {:.3g} {} (one standard deviation), readings within a "
            "pass by {:.3g}. The zero of a further pass cannot be predicted",
            line.zeros->between_um, unit, line.zeros->within_um);
      else
        note += fmt::format(
            ". The model lacks an effect: readings {} differ from their predictions by the other ones by {:.3g} {} "
            "rms, {:.1f} times as much as noise and fit explain",
            of == kRun  ? "of one run"
            : is_beyond ? "at an end value"
                        : "at one value",
            predicted.rms(), unit, predicted.factor());
      supports.notes.push_back(std::move(note));
    }
  }
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
  if (!data.paths.empty() || !at.paths.empty()) return supports;
  for (const auto& each : reached) {
    OneLine line{each.first, core.left_out};
    for (std::size_t k = 0; k < data.size(); ++k) line.not_of_it[k] = line.not_of_it[k] || !line.has(data, k);
    line.zeros = scatter_of_passes(data, core.residual, line.not_of_it);
    mark_unseen(data, at, assembly, core, line, supports);
    if (!data.through_chain.empty()) break;
  }
  return supports;
}

}  // namespace ecs::model
