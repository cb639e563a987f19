// Whitening by the innovations of a Kalman filter (Kalman 1960; Kailath 1968) for white noise plus a first order
// Gauss-Markov process: one pass over the readings of a group in order of time.
#include <cmath>

#include "model/fit/noise.hpp"

namespace ecs::model {

Whitener::Whitener(const Observations& data, const NoiseModel& noise, const std::vector<bool>& left_out) {
  steps_.reserve(data.size());
  const std::vector<std::size_t> pass = passes_of(data);
  for (const NoiseGroup& group : noise.groups) {
    const double stationary = group.correlated * group.correlated;
    const double white = group.white * group.white;
    double variance = stationary;  // of the correlated part, predicted
    bool first = true;
    double before_s = 0.0;
    std::size_t before = 0;
    double carry = 1.0;  // memory over rows left out
    for (const std::size_t k : group.rows) {
      Step step{k, 0.0, 0.0, 0.0};
      double memory = 0.0;
      if (!first && stationary > 0.0) {
        if (noise.has_time && !std::isnan(data.time_s[k]) && !std::isnan(before_s))
          memory = std::exp(-std::max(0.0, data.time_s[k] - before_s) / group.time);
        else if (!noise.has_time && pass[k] == pass[before])
          memory = std::exp(-1.0 / group.time);
      }
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
      if (noise.has_time) before_s = data.time_s[k];
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

void Whitener::apply(const double* from, double* to) const {
  double state = 0.0;
  for (const Step& step : steps_) {
    if (step.scale == 0.0) {
      to[step.row] = 0.0;
      continue;
    }
    const double expected = step.memory * state;
    const double innovation = from[step.row] - expected;
    state = expected + step.gain * innovation;
    to[step.row] = innovation * step.scale;
  }
}

void Whitener::apply_transposed(const double* from, double* to) const {
  double later = 0.0;  // what the steps after this one owe to its state
  for (std::size_t i = steps_.size(); i-- > 0;) {
    const Step& step = steps_[i];
    if (step.scale == 0.0) {
      to[step.row] = 0.0;
      continue;
    }
    const double scaled = step.scale * from[step.row];
    to[step.row] = scaled + step.gain * later;
    later = step.memory * ((1.0 - step.gain) * later - scaled);
  }
}

double Whitener::ln_determinant() const {
  double sum = 0.0;
  for (const Step& step : steps_)
    if (step.scale > 0.0) sum -= 2.0 * std::log(step.scale);
  return sum;
}

Eigen::MatrixXd Whitener::transposed(const Eigen::MatrixXd& white) const {
  Eigen::MatrixXd out(white.rows(), white.cols());
  for (Eigen::Index j = 0; j < white.cols(); ++j) apply_transposed(white.col(j).data(), out.col(j).data());
  return out;
}

Eigen::MatrixXd Whitener::operator()(const Eigen::MatrixXd& columns) const {
  Eigen::MatrixXd white(columns.rows(), columns.cols());
  for (Eigen::Index j = 0; j < columns.cols(); ++j) apply(columns.col(j).data(), white.col(j).data());
  return white;
}

Eigen::VectorXd Whitener::operator()(const Eigen::VectorXd& column) const {
  Eigen::VectorXd white(column.size());
  apply(column.data(), white.data());
  return white;
}

}  // namespace ecs::model
