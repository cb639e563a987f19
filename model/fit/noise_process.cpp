// A known noise at work, group after group in order of time: replicates of it by the parametric bootstrap (Efron and
// Tibshirani 1993, 6.5), their size drawn from a scaled inverse χ²; whitening by the innovations of a Kalman filter
// (Kalman 1960; Kailath 1968), one pass over the readings. Does not live here: how much noise there is (noise.cpp).
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "model/fit/noise.hpp"

namespace ecs::model {
namespace {

/// Part of the freedom of repeats that the size of replicates is drawn with: correlated repeats tell less than their
/// number. A choice: a smaller part names less and later.
constexpr double kFreedomOfReplicates = 0.7;

/// What correlated noise keeps from one reading of an instrument to its next: nothing where the clock restarts,
/// where a time is unknown, and between passes where there is no time.
double memory_of(const Observations& data, const NoiseModel& noise, const std::vector<std::size_t>& pass,
                 double correlation_time, std::size_t before, std::size_t k) {
  if (!noise.has_time) return pass[k] == pass[before] ? std::exp(-1.0 / correlation_time) : 0.0;
  const double since_s = data.time_s[k] - data.time_s[before];
  return since_s >= 0.0 ? std::exp(-since_s / correlation_time) : 0.0;
}

}  // namespace

SimulatedNoise::SimulatedNoise(const Observations& data, const NoiseModel& noise, const std::vector<bool>& left_out,
                               std::uint64_t seed)
    : data_(data),
      noise_(noise),
      left_out_(left_out),
      pass_(passes_of(data)),
      random_(seed),
      spread_(std::max(kFewestNoiseFreedom, kFreedomOfReplicates * noise.pure.dof)) {
  std::vector<double> weights;
  for (const NoiseShape& shape : noise.shapes) weights.push_back(shape.weight);
  any_ = WeightedDraws(weights);
}

Eigen::MatrixXd SimulatedNoise::next(std::size_t count) {
  const auto n = static_cast<Eigen::Index>(data_.size());
  Eigen::MatrixXd sets = Eigen::MatrixXd::Zero(n, static_cast<Eigen::Index>(count));
  struct Memory {
    double kept = 0.0, fresh = 1.0;  ///< of the reading before; new beside it
  };
  std::vector<std::vector<Memory>> memories(noise_.shapes.size());  // of each shape drawn, at each reading
  for (Eigen::Index b = 0; b < sets.cols(); ++b) {
    const std::size_t number = any_(random_);
    const NoiseShape& shape = noise_.shapes[number];
    std::vector<Memory>& memory_at = memories[number];
    const double widen = std::sqrt(spread_.freedom() / spread_(random_));
    if (memory_at.empty() && shape.share > 0.0) {
      memory_at.resize(data_.size());
      for (const NoiseGroup& group : noise_.groups)
        for (std::size_t i = 0; i < group.rows.size(); ++i) {
          const double kept =
              memory_of(data_, noise_, pass_, shape.time, group.rows[i == 0 ? 0 : i - 1], group.rows[i]);
          memory_at[group.rows[i]] = {kept, std::sqrt(std::max(0.0, 1.0 - kept * kept))};
        }
    }
    for (std::size_t g = 0; g < noise_.groups.size(); ++g) {
      const double white = widen * std::sqrt((1.0 - shape.share) * shape.variance[g]);
      const double correlated = widen * std::sqrt(shape.share * shape.variance[g]);
      double state = correlated > 0.0 ? normal_(random_) : 0.0;
      for (const std::size_t k : noise_.groups[g].rows) {
        if (correlated > 0.0) state = memory_at[k].kept * state + memory_at[k].fresh * normal_(random_);
        if (!left_out_[k])
          sets(static_cast<Eigen::Index>(k), b) =
              noise_.relative_of(k) * (white * normal_(random_) + correlated * state);
      }
    }
  }
  return sets;
}

Whitener::Whitener(const Observations& data, const NoiseModel& noise, const std::vector<bool>& left_out) {
  steps_.reserve(data.size());
  const std::vector<std::size_t> pass = noise.has_time ? std::vector<std::size_t>() : passes_of(data);
  for (const NoiseGroup& group : noise.groups) {
    const double stationary = group.correlated * group.correlated;
    const double white = group.white * group.white;
    double variance = stationary;  // of the correlated part, predicted
    bool first = true;
    std::size_t before = 0;
    double carry = 1.0;  // memory over rows left out
    for (const std::size_t k : group.rows) {
      Step step{k, 0.0, 0.0, 0.0, 1.0 / noise.relative_of(k)};
      const double memory = !first && stationary > 0.0 ? memory_of(data, noise, pass, group.time, before, k) : 0.0;
      carry *= memory;
      variance = memory * memory * (variance - stationary) + stationary;
      if (!left_out[k]) {
        const double innovation = variance + white;
        step.memory = carry;
        step.gain = variance / innovation;
        step.scale = 1.0 / std::sqrt(innovation);
        variance *= 1.0 - step.gain;
        carry = 1.0;
      }
      before = k;
      first = false;
      steps_.push_back(step);
    }
    if (!group.rows.empty()) {
      // the first step of a group forgets the group before
      for (std::size_t i = steps_.size() - group.rows.size(); i < steps_.size(); ++i)
        if (steps_[i].scale > 0.0) {
          steps_[i].memory = 0.0;
          break;
        }
    }
  }
}

template <int kColumns>
void Whitener::apply(const double* from, double* to, Eigen::Index rows) const {
  Eigen::Vector<double, kColumns> state = Eigen::Vector<double, kColumns>::Zero();
  for (const Step& step : steps_)
    for (Eigen::Index j = 0; j < kColumns; ++j) {
      const auto at = static_cast<Eigen::Index>(step.row) + j * rows;
      if (step.scale == 0.0) {
        to[at] = 0.0;
        continue;
      }
      const double expected = step.memory * state(j);
      const double innovation = step.share * from[at] - expected;
      state(j) = expected + step.gain * innovation;
      to[at] = innovation * step.scale;
    }
}

template <int kColumns>
void Whitener::apply_transposed(const double* from, double* to, Eigen::Index rows) const {
  Eigen::Vector<double, kColumns> later =
      Eigen::Vector<double, kColumns>::Zero();  // what the steps after this one owe to its state
  for (std::size_t i = steps_.size(); i-- > 0;) {
    const Step& step = steps_[i];
    for (Eigen::Index j = 0; j < kColumns; ++j) {
      const auto at = static_cast<Eigen::Index>(step.row) + j * rows;
      if (step.scale == 0.0) {
        to[at] = 0.0;
        continue;
      }
      const double scaled = step.scale * from[at];
      to[at] = step.share * (scaled + step.gain * later(j));
      later(j) = step.memory * ((1.0 - step.gain) * later(j) - scaled);
    }
  }
}

bool Whitener::is_white() const {
  return std::ranges::all_of(steps_, [](const Step& step) { return step.memory == 0.0; });
}

double Whitener::ln_determinant() const {
  double sum = 0.0;
  for (const Step& step : steps_)
    if (step.scale > 0.0) sum -= 2.0 * std::log(step.scale * step.share);
  return sum;
}

namespace {

/// Each step waits for the one before: several columns at once take little longer than one.
constexpr int kAtOnce = 4;

template <class Several, class One>
Eigen::MatrixXd by_columns(const Eigen::MatrixXd& columns, const Several& several, const One& one) {
  Eigen::MatrixXd out(columns.rows(), columns.cols());
  Eigen::Index j = 0;
  for (; j + kAtOnce <= columns.cols(); j += kAtOnce) several(columns.col(j).data(), out.col(j).data(), columns.rows());
  for (; j < columns.cols(); ++j) one(columns.col(j).data(), out.col(j).data(), columns.rows());
  return out;
}

}  // namespace

Eigen::MatrixXd Whitener::transposed(const Eigen::MatrixXd& white) const {
  return by_columns(
      white, [&](auto... columns) { apply_transposed<kAtOnce>(columns...); },
      [&](auto... column) { apply_transposed<1>(column...); });
}

Eigen::MatrixXd Whitener::operator()(const Eigen::MatrixXd& columns) const {
  return by_columns(
      columns, [&](auto... several) { apply<kAtOnce>(several...); }, [&](auto... one) { apply<1>(one...); });
}

Eigen::VectorXd Whitener::operator()(const Eigen::VectorXd& column) const {
  Eigen::VectorXd white(column.size());
  apply<1>(column.data(), white.data(), column.size());
  return white;
}

}  // namespace ecs::model
