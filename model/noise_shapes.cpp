#include "model/noise_shapes.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace ecs::model {
namespace {

/// Readings of one pass in order, with the time of each.
struct Pass {
  std::size_t group = 0;
  std::vector<std::size_t> rows;
  std::vector<double> time;  ///< s, or readings
};

std::vector<Pass> usable_passes(const Observations& data, const std::vector<NoiseGroup>& groups,
                                const std::vector<double>& deviation) {
  const std::vector<std::size_t> number = passes_of(data);
  std::vector<Pass> passes;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    std::map<std::size_t, Pass> of_group;
    for (const std::size_t k : groups[g].rows) {
      if (std::isnan(deviation[k]) || (!data.time_s.empty() && std::isnan(data.time_s[k]))) continue;
      Pass& pass = of_group[number[k]];
      pass.group = g;
      pass.time.push_back(data.time_s.empty() ? static_cast<double>(pass.rows.size()) : data.time_s[k]);
      pass.rows.push_back(k);
    }
    for (auto& each : of_group) passes.push_back(std::move(each.second));
  }
  return passes;
}

/// A pass made independent under one shape of noise, a low polynomial in time taken off (what wanders for minutes is no
/// noise): the residuals left, ln of the determinants, degrees of freedom.
struct PassFit {
  std::vector<double> residual;
  double ln_determinant = 0.0;
  double freedom = 0.0;
};
PassFit fitted_pass(const Pass& pass, const std::vector<double>& deviation, double share, double time,
                    double slowest_noise) {
  const auto n = static_cast<Eigen::Index>(pass.rows.size());
  const double first = pass.time.front(), width = std::max(pass.time.back() - first, 1e-9);
  const auto by_length = static_cast<Eigen::Index>(width / slowest_noise);
  const Eigen::Index degree = std::min<Eigen::Index>({5, n / 6, by_length});
  Eigen::MatrixXd columns(n, degree + 2);  // the polynomial, then the deviations
  for (Eigen::Index i = 0; i < n; ++i) {
    const double u = 2.0 * (pass.time[static_cast<std::size_t>(i)] - first) / width - 1.0;
    for (Eigen::Index j = 0; j <= degree; ++j)
      columns(i, j) = std::cos(static_cast<double>(j) * std::acos(std::clamp(u, -1.0, 1.0)));
    columns(i, degree + 1) = deviation[pass.rows[static_cast<std::size_t>(i)]];
  }
  PassFit fit;
  double variance = share;
  Eigen::RowVectorXd state = Eigen::RowVectorXd::Zero(columns.cols());
  for (Eigen::Index i = 0; i < n; ++i) {
    if (i > 0) {
      const double memory =
          std::exp(-(pass.time[static_cast<std::size_t>(i)] - pass.time[static_cast<std::size_t>(i - 1)]) / time);
      variance = memory * memory * (variance - share) + share;
      state *= memory;
    }
    const double innovation = variance + 1.0 - share;
    const Eigen::RowVectorXd fresh = columns.row(i) - state;
    state += variance / innovation * fresh;
    variance *= 1.0 - variance / innovation;
    columns.row(i) = fresh / std::sqrt(innovation);
    fit.ln_determinant += std::log(innovation);
  }
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(columns.leftCols(degree + 1));
  Eigen::VectorXd y = columns.col(degree + 1);
  y -= columns.leftCols(degree + 1) * qr.solve(y);
  for (Eigen::Index j = 0; j <= degree; ++j)
    fit.ln_determinant += 2.0 * std::log(std::max(std::abs(qr.matrixQR()(j, j)), 1e-12));
  fit.residual.assign(y.data(), y.data() + n);
  fit.freedom = static_cast<double>(n - degree - 1);
  return fit;
}

/// Levels of groups with few readings drawn towards the level of all groups of their kind (translations, rotations):
/// strongly where the groups agree as equal noises do (Bartlett's test), a little where they do not.
void shrink_levels(const std::vector<NoiseGroup>& groups, const std::vector<double>& freedom, double information,
                   std::vector<double>& variance) {
  constexpr double kAgreeing = 40.0, kDiffering = 4.0;
  for (const bool rotations : {false, true}) {
    double all = 0.0, sum = 0.0, logs = 0.0, count = 0.0;
    const auto counts = [&](std::size_t g) {
      return is_rotation(groups[g].sense) == rotations && freedom[g] >= 1.0 && variance[g] > 0.0;
    };
    for (std::size_t g = 0; g < groups.size(); ++g) {
      if (!counts(g)) continue;
      const double f = freedom[g] * information;
      all += f;
      sum += f * variance[g];
      logs += f * std::log(variance[g]);
      count += 1.0;
    }
    if (count < 2.0) continue;
    const double common = sum / all;
    const double bartlett = all * std::log(common) - logs;
    const bool agree = bartlett < count - 1.0 + 3.0 * std::sqrt(2.0 * (count - 1.0));
    const double prior = agree ? kAgreeing : kDiffering;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      const double f = freedom[g] * information;
      if (counts(g)) variance[g] = (f * variance[g] + prior * common) / (f + prior);
    }
  }
}

}  // namespace

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

std::vector<NoiseShape> likely_shapes(const Observations& data, const std::vector<NoiseGroup>& groups,
                                      const std::vector<double>& deviation, double information) {
  const std::vector<Pass> passes = usable_passes(data, groups, deviation);
  const std::vector<double> times =
      data.time_s.empty() ? std::vector<double>{1.0, 2.0, 4.0} : std::vector<double>{4.0, 8.0, 15.0, 25.0, 40.0, 60.0};
  std::vector<NoiseShape> shapes{{0.0, 1.0, 0.0, {}}};
  for (const double time : times)
    for (const double share : {0.15, 0.3, 0.45, 0.6, 0.75, 0.9, 0.97}) shapes.push_back({share, time, 0.0, {}});
  double most = -1e300;
  std::vector<double> scatter;
  for (const NoiseGroup& group : groups) {
    std::vector<double> squares;
    for (const std::size_t k : group.rows)
      if (!std::isnan(deviation[k])) squares.push_back(deviation[k] * deviation[k]);
    scatter.push_back(squares.size() < 4 ? kNotMeasured : robust_mean_square(std::move(squares)));
  }
  for (NoiseShape& shape : shapes) {
    std::vector<std::vector<double>> squares(groups.size());
    std::vector<double> freedom(groups.size(), 0.0), count(groups.size(), 0.0);
    double ln_determinant = 0.0;
    for (const Pass& pass : passes) {
      const PassFit fit = fitted_pass(pass, deviation, shape.share, shape.time, data.time_s.empty() ? 20.0 : 200.0);
      for (const double r : fit.residual) squares[pass.group].push_back(r * r);
      freedom[pass.group] += fit.freedom;
      count[pass.group] += static_cast<double>(fit.residual.size());
      ln_determinant += fit.ln_determinant;
    }
    shape.weight = -0.5 * ln_determinant;
    double all = 0.0, all_freedom = 0.0;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      shape.variance.push_back(kNotMeasured);
      if (freedom[g] < 1.0) continue;
      const double mean = robust_mean_square(squares[g]) * count[g] / freedom[g];
      shape.weight -= 0.5 * freedom[g] * std::log(std::max(mean, 1e-300));
      all += mean * freedom[g];
      all_freedom += freedom[g];
      if (freedom[g] >= 6.0) shape.variance[g] = mean;
    }
    if (all_freedom > 0.0)
      for (double& variance : shape.variance)
        if (std::isnan(variance)) variance = all / all_freedom;
    shrink_levels(groups, freedom, information, shape.variance);
    shape.weight *= information;
    // the scatter of the deviations themselves holds all of the noise: more than that is not possible
    double claimed = 0.0, there = 0.0, rows = 0.0;
    for (std::size_t g = 0; g < groups.size(); ++g) {
      if (std::isnan(shape.variance[g]) || std::isnan(scatter[g])) continue;
      const double n = static_cast<double>(groups[g].rows.size());
      claimed += n * shape.variance[g];
      there += n * scatter[g];
      rows += n;
    }
    if (there > 0.0 && claimed > there) shape.weight -= 0.1 * rows * information * std::pow(claimed / there - 1.0, 2);
    most = std::max(most, shape.weight);
  }
  double sum = 0.0;
  for (NoiseShape& shape : shapes) {
    // white noise is one shape, the correlated ones are many: each half of the belief beforehand
    const double belief = shape.share == 0.0 ? 1.0 : 1.0 / static_cast<double>(shapes.size() - 1);
    shape.weight = belief * std::exp(shape.weight - most);
    sum += shape.weight;
  }
  for (NoiseShape& shape : shapes) shape.weight /= sum;
  return shapes;
}

}  // namespace ecs::model
