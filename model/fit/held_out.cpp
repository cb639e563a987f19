// Cross-validation by parts (Stone 1974; Geisser 1975), each row weighed by the variance of its prediction; least
// squares by the complete orthogonal decomposition (Golub and Van Loan 2013, 5.4) or by LDLᵀ of the scaled normal
// equations.
#include "model/fit/held_out.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "base/linear/decompositions.hpp"
#include "model/data/curve_basis.hpp"
#include "model/fit/statistics.hpp"

namespace ecs::model {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Parts of a cross-validation: five or ten are usual (Hastie, Tibshirani and Friedman 2009, 7.10); five cost half.
constexpr std::size_t kMostParts = 5;
/// Runs from which whole runs are held out: with two each part would be fitted to one run alone.
constexpr std::size_t kFewestRuns = 3;
/// Targets of a line from which targets are left out: two in each of five parts.
constexpr std::size_t kFewestTargets = 10;
/// Neighbours held out together where there are no runs: a choice; single ones would be predicted by correlated noise.
constexpr std::size_t kBlock = 4;
/// A column of which less than this is left beside the others (of its norm) depends on them: half the digits of a
/// double.
constexpr double kDependent = 1e-7;
/// Of a unit column this is left beside another that it correlates with by 0.995: sqrt(1 - 0.995²).
constexpr double kCollinear = 0.1;
/// Added to a diagonal of 1, so that columns that depend on each other share a size: far below noise.
constexpr double kRidge = 1e-9;
/// A row counts for at most this many mean squares: three sigmas, so that no outlier decides.
constexpr double kMostSquare = 9.0;
/// What is above noise counts as at least this much a row: below it the share of it is chance. A choice.
constexpr double kLeastAboveNoise = 0.05;

/// Number of the target of each reading among those of its sense and axis, from the first one along the axis.
std::vector<std::size_t> numbers_of_targets(const Observations& data) {
  std::map<std::pair<Channel, Axis>, std::vector<double>> targets;
  for (std::size_t k = 0; k < data.size(); ++k) targets[{data.channel(k), data.axis[k]}].push_back(data.along_of(k));
  for (auto& each : targets) each.second = distinct(std::move(each.second), kSamePlace_mm);
  std::vector<std::size_t> numbers;
  for (std::size_t k = 0; k < data.size(); ++k) {
    const auto& list = targets[{data.channel(k), data.axis[k]}];
    const auto after = std::ranges::upper_bound(list, data.along_of(k) + 0.1 * kSamePlace_mm);
    numbers.push_back(static_cast<std::size_t>(after - list.begin()));
  }
  return numbers;
}

}  // namespace

Parts parts_of(const Observations& data) {
  Parts parts;
  const std::set<int> runs(data.run.begin(), data.run.end());
  parts.by_run = runs.size() >= kFewestRuns;
  parts.count = parts.by_run ? std::min(runs.size(), kMostParts) : kMostParts;
  std::map<std::pair<Channel, Axis>, std::set<int>> runs_of;
  for (std::size_t k = 0; k < data.size(); ++k) runs_of[{data.channel(k), data.axis[k]}].insert(data.run[k]);
  const std::vector<std::size_t> targets = numbers_of_targets(data);
  std::map<std::pair<Channel, Axis>, std::size_t> targets_of, readings_of;
  for (std::size_t k = 0; k < data.size(); ++k) {
    std::size_t& count = targets_of[{data.channel(k), data.axis[k]}];
    count = std::max(count, targets[k]);
  }
  for (std::size_t k = 0; k < data.size(); ++k) {
    std::size_t number = k / kBlock;
    if (parts.by_run) number = static_cast<std::size_t>(std::distance(runs.begin(), runs.find(data.run[k])));
    // a line with too few runs would be left out as a whole, one with too few targets as well; all readings of a pose
    // belong together
    const std::pair<Channel, Axis> line{data.channel(k), data.axis[k]};
    if (parts.by_run && data.through_chain.empty() && runs_of[line].size() < kFewestRuns)
      number = targets_of[line] >= parts.count ? targets[k] : readings_of[line] / kBlock;
    ++readings_of[line];
    parts.of.push_back(number % parts.count);
  }
  return parts;
}

Parts parts_by_target(const Observations& data) {
  Parts parts{numbers_of_targets(data), kMostParts, false};
  for (std::size_t& part : parts.of) part %= parts.count;
  return parts;
}

bool has_targets_to_leave_out(const Observations& data) {
  std::map<std::pair<Channel, Axis>, std::vector<double>> targets;
  for (std::size_t k = 0; k < data.size(); ++k) targets[{data.channel(k), data.axis[k]}].push_back(data.along_of(k));
  return std::ranges::all_of(
      targets, [](const auto& each) { return distinct(each.second, kSamePlace_mm).size() >= kFewestTargets; });
}

namespace {

VectorXd of_least_norm(const MatrixXd& white, const VectorXd& target, double dependent) {
  if (white.cols() == 0) return VectorXd(0);
  VectorXd norm = white.colwise().norm();
  for (Index j = 0; j < norm.size(); ++j) norm(j) = norm(j) > 0.0 ? size_in_order(j) / norm(j) : 0.0;
  return norm.asDiagonal() * least_norm_solution(white * norm.asDiagonal(), target, dependent);
}

}  // namespace

VectorXd least_squares(const MatrixXd& white, const VectorXd& target) {
  return of_least_norm(white, target, kDependent);
}

VectorXd smallest_sizes(const MatrixXd& white, const VectorXd& target) {
  return of_least_norm(white, target, kCollinear);
}

namespace {

/// Calls `take` with the number and the residual of every reading, predicted from the other parts.
template <class Take>
void predict_parts(const Observations& data, const NoiseModel& noise, const std::vector<bool>& left_out,
                   const Parts& parts, const MatrixXd& columns, const VectorXd& target, const Take& take) {
  for (std::size_t part = 0; part < parts.count; ++part) {
    std::vector<bool> hidden = left_out;
    for (std::size_t k = 0; k < hidden.size(); ++k)
      if (parts.of[k] == part) hidden[k] = true;
    const Whitener whitener(data, noise, hidden);
    const VectorXd sizes = least_squares(whitener(columns), whitener(target));
    for (std::size_t k = 0; k < hidden.size(); ++k) {
      if (parts.of[k] != part || left_out[k]) continue;
      const auto at = static_cast<Index>(k);
      take(k, target(at) - (sizes.size() > 0 ? columns.row(at).dot(sizes) : 0.0));
    }
  }
}

}  // namespace

double cross_validated_part(const Parts& parts, const MatrixXd& columns, const VectorXd& target,
                            const VectorXd& before) {
  const double n = static_cast<double>(target.size());
  const double most = kMostSquare * std::max(1.0, before.squaredNorm() / n);
  double gained = 0.0, there = 0.0, weights = 0.0;
  for (std::size_t part = 0; part < parts.count; ++part) {
    MatrixXd products = MatrixXd::Zero(columns.cols(), columns.cols());
    VectorXd right = VectorXd::Zero(columns.cols());
    for (std::size_t k = 0; k < parts.of.size(); ++k) {
      if (parts.of[k] == part) continue;
      const auto row = columns.row(static_cast<Index>(k));
      products.noalias() += row.transpose() * row;
      right += row.transpose() * target(static_cast<Index>(k));
    }
    const VectorXd scale = products.diagonal().cwiseMax(kLeastDivisor).cwiseSqrt().cwiseInverse();
    products = scale.asDiagonal() * products * scale.asDiagonal();
    products.diagonal().array() += kRidge;
    const SymmetricSolver solver(products);
    const VectorXd sizes = scale.asDiagonal() * solver.solve(scale.asDiagonal() * right);
    for (std::size_t k = 0; k < parts.of.size(); ++k) {
      if (parts.of[k] != part) continue;
      const auto at = static_cast<Index>(k);
      const VectorXd row = scale.asDiagonal() * columns.row(at).transpose();
      const double weight = 1.0 / (1.0 + std::max(0.0, row.dot(solver.solve(row))));
      const double was = std::min(before(at) * before(at), most);
      const double left = target(at) - columns.row(at).dot(sizes);
      gained += weight * (was - std::min(left * left, most));
      there += weight * (was - 1.0);
      weights += weight;
    }
  }
  return gained / std::max(there, kLeastAboveNoise * weights);
}

double held_out_rms(const Observations& data, const NoiseModel& noise, const std::vector<bool>& left_out,
                    const Parts& parts, const MatrixXd& columns, const VectorXd& target) {
  double sum = 0.0, count = 0.0;
  predict_parts(data, noise, left_out, parts, columns, target, [&](std::size_t, double r) {
    sum += r * r;
    count += 1.0;
  });
  return std::sqrt(sum / std::max(count, 1.0));
}

namespace {

/// Chance that at least, or at most, so many of `n` fall on one side of an even chance; at most 1.
double two_sided_sign_chance(std::size_t better, std::size_t n) {
  double chance = 0.0, of_so_many = std::pow(0.5, static_cast<double>(n));  // of none
  for (std::size_t k = 0; k <= n; ++k) {
    if (k >= better) chance += 2.0 * of_so_many;
    of_so_many *= static_cast<double>(n - k) / static_cast<double>(k + 1);
  }
  return std::min(chance, 1.0);
}

/// Sum of squares about the mean of each channel, of the rows given.
double square_about_means(const Observations& data, const std::vector<std::size_t>& rows, const VectorXd& values) {
  std::map<Channel, std::pair<double, double>> sums;  // count, sum
  for (const std::size_t k : rows) {
    auto& [count, sum] = sums[data.channel(k)];
    count += 1.0;
    sum += values(static_cast<Index>(k));
  }
  double square = 0.0;
  for (const std::size_t k : rows) {
    const auto& [count, sum] = sums.at(data.channel(k));
    const double beyond = values(static_cast<Index>(k)) - sum / count;
    square += beyond * beyond;
  }
  return square;
}

}  // namespace

double chance_of_predicted_runs(const Observations& data, const NoiseModel& noise, const std::vector<bool>& left_out,
                                const MatrixXd& columns, const VectorXd& effect, const VectorXd& target) {
  std::map<int, std::vector<std::size_t>> rows_of;
  for (std::size_t k = 0; k < data.size(); ++k)
    if (!left_out[k]) rows_of[data.run[k]].push_back(k);
  NoiseModel white_noise = noise;  // the whole course of a run counts, not how it changes from reading to reading
  for (NoiseGroup& group : white_noise.groups) {
    group.white = group.sigma();
    group.correlated = 0.0;
  }
  MatrixXd both(columns.rows(), columns.cols() + 1);
  both << columns, effect;
  std::size_t better = 0, runs = 0;
  for (const auto& [run, rows] : rows_of) {
    std::vector<bool> hidden = left_out;
    for (const std::size_t k : rows) hidden[k] = true;
    const Whitener whitener(data, white_noise, hidden);
    const VectorXd white = whitener(target);
    const VectorXd without = target - columns * least_squares(whitener(columns), white);
    const VectorXd with = target - both * least_squares(whitener(both), white);
    const double before = square_about_means(data, rows, without);
    if (square_about_means(data, rows, with - without) <= kDependent * before) continue;
    ++runs;
    if (square_about_means(data, rows, with) < before) ++better;
  }
  return two_sided_sign_chance(better, runs);
}

}  // namespace ecs::model
