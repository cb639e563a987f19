#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include "base/random.hpp"
#include "model/fit/noise.hpp"
#include "tests/model/support/measured_lines.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;

TEST_CASE("the transposed whitener is the transpose of the whitener, rows left out and all") {
  const auto set = measured({}, 0.3, [](const laser::Reading&) { return 0.0; });
  const Observations data = observations_of(set, straight(), mill());
  NoiseModel noise = plain_noise(data, 0.3);
  for (NoiseGroup& group : noise.groups) {
    group.correlated = 0.4;
    group.time = 25.0;
  }
  std::vector<bool> left_out(data.size(), false);
  left_out[0] = left_out[17] = left_out[18] = left_out[data.size() - 1] = true;
  const Whitener whitener(data, noise, left_out);
  std::mt19937_64 random(3);
  NormalDraws normal;
  const auto n = static_cast<Eigen::Index>(data.size());
  const auto any = [&] { return Eigen::MatrixXd(Eigen::MatrixXd::NullaryExpr(n, 3, [&] { return normal(random); })); };
  const Eigen::MatrixXd x = any(), y = any();
  const Eigen::MatrixXd one = whitener(x).transpose() * y, other = x.transpose() * whitener.transposed(y);
  CHECK((one - other).norm() < 1e-10 * one.norm());
}
