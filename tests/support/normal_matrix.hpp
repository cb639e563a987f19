// Matrices of normal noise.
#pragma once

#include <random>

#include <Eigen/Core>

#include "base/random.hpp"

namespace ecs::test {

inline Eigen::MatrixXd normal_matrix(Eigen::Index rows, Eigen::Index columns, unsigned seed) {
  std::mt19937_64 random(seed);
  NormalDraws one;
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return one(random); });
}

}  // namespace ecs::test
