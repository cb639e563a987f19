// Series of readings over the turns of a spindle: ranges, steps, least squares. Internal to its trace and its test
// (Eigen).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>
#include <vector>

#include <Eigen/Core>

#include "base/linear/decompositions.hpp"

namespace ecs::laser {

inline constexpr double kFullTurn_deg = 360.0;

template <class Values>
[[nodiscard]] double range_of(const Values& values) {
  const auto [least, greatest] = std::ranges::minmax_element(values);
  return *greatest - *least;
}

/// Of each value to the next.
[[nodiscard]] inline std::vector<double> steps_of(const std::vector<double>& values) {
  std::vector<double> steps(values.size());
  std::adjacent_difference(values.begin(), values.end(), steps.begin());
  steps.erase(steps.begin());
  return steps;
}

/// Least squares of values by K columns, each a function of the reading's number.
template <std::size_t K, class Columns>
[[nodiscard]] std::array<double, K> fitted(const std::vector<double>& values, std::size_t count,
                                           const Columns& columns_at) {
  constexpr auto kCount = static_cast<Eigen::Index>(K);
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(kCount, kCount);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(kCount);
  for (std::size_t i = 0; i < count; ++i) {
    const std::array<double, K> row = columns_at(i);
    const Eigen::Map<const Eigen::Matrix<double, static_cast<int>(K), 1>> column(row.data());
    gram += column * column.transpose();
    right += column * values[i];
  }
  const Eigen::VectorXd sizes = SymmetricSolver(gram).solve(right);
  std::array<double, K> out{};
  std::copy(sizes.begin(), sizes.end(), out.begin());
  return out;
}

}  // namespace ecs::laser
