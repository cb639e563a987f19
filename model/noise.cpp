#include "model/noise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

namespace ecs::model {
namespace {

constexpr double kLongestLag_s = 150.0;
constexpr std::size_t kFewestPairs = 12;

double rounded(double value, double step) { return std::isnan(value) ? -1e300 : std::round(value / step) * step; }
double cell(const Column& column, std::size_t k) { return column.empty() ? kNotMeasured : column[k]; }

/// Mean square of half the squared differences, without the few that are far out.
double robust_mean_square(std::vector<double> squares) {
  if (squares.empty()) return 0.0;
  const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
  std::nth_element(squares.begin(), middle, squares.end());
  const double limit = 20.0 * *middle / 0.4549;
  double sum = 0.0, count = 0.0;
  for (const double s : squares)
    if (s <= limit || limit <= 0.0) {
      sum += s;
      count += 1.0;
    }
  return sum / std::max(count, 1.0);
}

struct LagClass {
  double lag = 0.0;
  double gamma = 0.0;  ///< half the mean squared difference
  double pairs = 0.0;
};

/// Half squared differences of deviations within passes, by lag.
std::vector<LagClass> variogram(const Observations& data, const NoiseGroup& group, const std::vector<std::size_t>& pass,
                                const std::vector<double>& deviation) {
  constexpr std::array<std::size_t, 14> kSteps{1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128};
  const bool by_time = !data.time_s.empty();
  std::vector<std::size_t> usable;
  for (const std::size_t k : group.rows)
    if (!std::isnan(deviation[k])) usable.push_back(k);
  std::vector<LagClass> classes;
  for (const std::size_t steps : kSteps) {
    if (!by_time && steps > 6) break;
    std::vector<double> squares;
    double lag_sum = 0.0;
    for (std::size_t i = 0; i + steps < usable.size(); ++i) {
      const std::size_t a = usable[i], b = usable[i + steps];
      if (pass[a] != pass[b]) continue;
      const double lag = by_time ? cell(data.time_s, b) - cell(data.time_s, a) : static_cast<double>(steps);
      if (std::isnan(lag) || (by_time && lag > kLongestLag_s && steps > 1)) continue;
      const double d = deviation[a] - deviation[b];
      squares.push_back(0.5 * d * d);
      lag_sum += lag;
    }
    if (squares.size() < kFewestPairs) continue;
    const double pairs = static_cast<double>(squares.size());
    classes.push_back({lag_sum / pairs, robust_mean_square(std::move(squares)), pairs});
  }
  return classes;
}

/// White and correlated variance with γ(lag) = white + correlated·(1 − exp(−lag/time)), none below 0.
struct Split {
  double white = 0.0, correlated = 0.0, time = 0.0, misfit = 1e300;
};
Split split_at(const std::vector<LagClass>& classes, double time) {
  double s11 = 0, s12 = 0, s22 = 0, r1 = 0, r2 = 0, rr = 0;
  for (const LagClass& c : classes) {
    const double w = c.pairs, f = -std::expm1(-c.lag / time);
    s11 += w;
    s12 += w * f;
    s22 += w * f * f;
    r1 += w * c.gamma;
    r2 += w * f * c.gamma;
    rr += w * c.gamma * c.gamma;
  }
  const double determinant = s11 * s22 - s12 * s12;
  Split best{r1 / s11, 0.0, time, 0.0};
  if (determinant > 1e-9 * s11 * s22) {
    const double white = (s22 * r1 - s12 * r2) / determinant;
    const double correlated = (s11 * r2 - s12 * r1) / determinant;
    if (white >= 0.0 && correlated >= 0.0)
      best = {white, correlated, time, 0.0};
    else if (white < 0.0 && r2 > 0.0)
      best = {0.0, r2 / s22, time, 0.0};
  }
  best.misfit = rr - 2.0 * (best.white * r1 + best.correlated * r2) + best.white * best.white * s11 +
                2.0 * best.white * best.correlated * s12 + best.correlated * best.correlated * s22;
  return best;
}

Split split_of(const std::vector<LagClass>& classes, bool by_time) {
  static constexpr std::array<double, 7> kTimes_s{3, 6, 10, 16, 25, 40, 60};
  static constexpr std::array<double, 3> kTimes_readings{1.0, 2.0, 4.0};
  Split best;
  const auto try_one = [&](double time) {
    const Split split = split_at(classes, time);
    if (split.misfit < best.misfit) best = split;
  };
  if (by_time)
    for (const double time : kTimes_s) try_one(time);
  else
    for (const double time : kTimes_readings) try_one(time);
  if (classes.size() < 3 || best.correlated < 0.1 * (best.white + best.correlated)) {
    double sum = 0.0, pairs = 0.0;
    for (const LagClass& c : classes) {
      sum += c.pairs * c.gamma;
      pairs += c.pairs;
    }
    return {sum / pairs, 0.0, 0.0, best.misfit};
  }
  return best;
}

/// Deviations from the mean of the repeats, widened for the mean that was taken off; NaN where there is no repeat.
std::vector<double> deviations_from_repeats(const Repeats& repeats, const Eigen::VectorXd& residual,
                                            const std::vector<bool>& left_out) {
  const std::size_t n = repeats.node_of.size();
  std::vector<double> sum(repeats.nodes, 0.0), count(repeats.nodes, 0.0);
  for (std::size_t k = 0; k < n; ++k) {
    if (left_out[k]) continue;
    sum[repeats.node_of[k]] += residual(static_cast<Eigen::Index>(k));
    count[repeats.node_of[k]] += 1.0;
  }
  std::vector<double> deviation(n, kNotMeasured);
  for (std::size_t k = 0; k < n; ++k) {
    const double c = count[repeats.node_of[k]];
    if (left_out[k] || c < 2.0) continue;
    deviation[k] = (residual(static_cast<Eigen::Index>(k)) - sum[repeats.node_of[k]] / c) * std::sqrt(c / (c - 1.0));
  }
  return deviation;
}

/// Deviations from what the smooth columns can produce.
std::vector<double> deviations_from_smooth(const Eigen::VectorXd& residual, const Eigen::MatrixXd& smooth,
                                           const std::vector<bool>& left_out) {
  const auto n = residual.size();
  Eigen::MatrixXd columns = smooth;
  Eigen::VectorXd y = residual;
  double kept = 0.0;
  for (Eigen::Index k = 0; k < n; ++k) {
    if (left_out[static_cast<std::size_t>(k)]) {
      columns.row(k).setZero();
      y(k) = 0.0;
    } else {
      kept += 1.0;
    }
  }
  double rank = 0.0;
  if (columns.cols() > 0) {
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(columns);
    y -= columns * qr.solve(y);
    rank = static_cast<double>(qr.rank());
  }
  const double widen = std::sqrt(kept / std::max(1.0, kept - rank));
  std::vector<double> deviation(static_cast<std::size_t>(n), kNotMeasured);
  for (std::size_t k = 0; k < deviation.size(); ++k)
    if (!left_out[k]) deviation[k] = widen * y(static_cast<Eigen::Index>(k));
  return deviation;
}

/// Step of the readings: the greatest number of which (nearly) all are multiples; 0 if there is none of use.
double resolution_of(const Observations& data, const NoiseGroup& group) {
  std::vector<double> values;
  for (const std::size_t k : group.rows) values.push_back(data.reading[k]);
  const auto sorted = [&] {
    std::sort(values.begin(), values.end());
    return values;
  }();
  double smallest = 0.0;
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    const double gap = sorted[i] - sorted[i - 1];
    if (gap > 1e-9 && (smallest == 0.0 || gap < smallest)) smallest = gap;
  }
  if (smallest < 1e-4) return 0.0;
  for (const double v : sorted)
    if (std::abs(v / smallest - std::round(v / smallest)) > 1e-3) return 0.0;
  return smallest;
}

std::vector<NoiseGroup> groups_of(const Observations& data) {
  std::map<std::pair<Sense, Axis>, NoiseGroup> groups;
  for (std::size_t k = 0; k < data.size(); ++k) {
    NoiseGroup& group = groups[{data.sense[k], data.axis[k]}];
    group.sense = data.sense[k];
    group.axis = data.axis[k];
    group.rows.push_back(k);
  }
  std::vector<NoiseGroup> list;
  for (auto& each : groups) list.push_back(std::move(each.second));
  return list;
}

double mean_square(const std::vector<double>& deviation, const std::vector<std::size_t>& rows) {
  std::vector<double> squares;
  for (const std::size_t k : rows)
    if (!std::isnan(deviation[k])) squares.push_back(deviation[k] * deviation[k]);
  return squares.size() < 4 ? kNotMeasured : robust_mean_square(std::move(squares));
}

}  // namespace

double NoiseGroup::sigma() const { return std::hypot(white, correlated); }

std::vector<double> NoiseModel::sigma_by_row(std::size_t n) const {
  std::vector<double> sigma(n, 1.0);
  for (const NoiseGroup& group : groups)
    for (const std::size_t k : group.rows) sigma[k] = group.sigma();
  return sigma;
}

Repeats repeats_of(const Observations& data) {
  using Key = std::tuple<Sense, Axis, int, std::array<double, 6>>;
  std::map<Key, std::size_t> nodes;
  Repeats repeats;
  for (std::size_t k = 0; k < data.size(); ++k) {
    const std::array<double, 6> place{rounded(data.position_mm[k][0], 1e-4), rounded(data.position_mm[k][1], 1e-4),
                                      rounded(data.position_mm[k][2], 1e-4), rounded(cell(data.feed_mm_min, k), 1e-3),
                                      rounded(cell(data.load_kg, k), 1e-3),  data.compensated[k] ? 1.0 : 0.0};
    const Key key{data.sense[k], data.axis[k], data.approach[k], place};
    repeats.node_of.push_back(nodes.try_emplace(key, nodes.size()).first->second);
  }
  repeats.nodes = nodes.size();
  return repeats;
}

std::vector<std::size_t> passes_of(const Observations& data) {
  using Key = std::tuple<Sense, Axis, int, int, Vector3>;
  std::map<Key, std::size_t> numbers;
  std::vector<std::size_t> pass;
  for (std::size_t k = 0; k < data.size(); ++k) {
    Vector3 parked = data.position_mm[k];
    parked[index_of(data.axis[k])] = 0.0;
    pass.push_back(
        numbers.try_emplace({data.sense[k], data.axis[k], data.run[k], data.approach[k], parked}, numbers.size())
            .first->second);
  }
  return pass;
}

NoiseModel plain_noise(const Observations& data, double sigma_um) {
  NoiseModel noise;
  noise.groups = groups_of(data);
  noise.has_time = !data.time_s.empty();
  for (NoiseGroup& group : noise.groups) group.white = sigma_um;
  return noise;
}

NoiseModel noise_of(const Observations& data, const Eigen::VectorXd& residual, const Eigen::MatrixXd& smooth,
                    const std::vector<bool>& left_out) {
  NoiseModel noise;
  noise.groups = groups_of(data);
  noise.has_time = !data.time_s.empty();
  const Repeats repeats = repeats_of(data);
  const std::vector<std::size_t> pass = passes_of(data);
  std::vector<double> deviation = deviations_from_repeats(repeats, residual, left_out);
  const auto repeated = static_cast<std::size_t>(
      std::count_if(deviation.begin(), deviation.end(), [](double d) { return !std::isnan(d); }));
  noise.pure.from_repeats = repeated >= 8 && repeated * 2 >= data.size();
  if (!noise.pure.from_repeats) deviation = deviations_from_smooth(residual, smooth, left_out);

  const double largest =
      residual.size() > 0 ? std::sqrt(residual.squaredNorm() / static_cast<double>(residual.size())) : 0.0;
  std::vector<std::size_t> all(data.size());
  for (std::size_t k = 0; k < all.size(); ++k) all[k] = k;
  const double everywhere = mean_square(deviation, all);
  double sum = 0.0, count = 0.0;
  for (NoiseGroup& group : noise.groups) {
    const auto classes = variogram(data, group, pass, deviation);
    Split split;
    if (!classes.empty()) {
      split = split_of(classes, noise.has_time);
    } else {
      const double own = mean_square(deviation, group.rows);
      split.white = std::isnan(own) ? (std::isnan(everywhere) ? largest * largest : everywhere) : own;
    }
    const double step = resolution_of(data, group);
    double group_square = 0.0;
    for (const std::size_t k : group.rows)
      group_square += residual(static_cast<Eigen::Index>(k)) * residual(static_cast<Eigen::Index>(k));
    const double floor =
        std::max({0.25 * step, 2e-3 * std::sqrt(group_square / static_cast<double>(group.rows.size())), 1e-9});
    group.white = std::sqrt(std::max(split.white, split.correlated > 0 ? 0.02 * split.correlated : 0.0));
    group.correlated = std::sqrt(split.correlated);
    group.time = split.time;
    if (group.sigma() < floor) group.white = floor;
    sum += group.sigma() * group.sigma() * static_cast<double>(group.rows.size());
    count += static_cast<double>(group.rows.size());
  }
  noise.pure.noise_um = std::sqrt(sum / std::max(count, 1.0));
  noise.pure.dof = noise.pure.from_repeats ? static_cast<double>(repeated) - static_cast<double>(repeats.nodes)
                                           : static_cast<double>(data.size()) - static_cast<double>(smooth.cols());
  noise.pure.dof = std::max(noise.pure.dof, 1.0);
  return noise;
}

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
