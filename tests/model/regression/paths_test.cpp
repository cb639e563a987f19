// Effects on readings along paths.
#include "model/data/motions.hpp"
#include "model/regression/regressors.hpp"
#include "tests/model/support/made_paths.hpp"
#include "tests/model/support/measured_lines.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;
using namespace ecs::model::test::effects;

namespace {

Observations quiet_circle() {
  CircleMade made{.noise_um = 0.0};
  return observations_of(set_of_circle(made_circle([](const PathPlace&) { return Vector3{}; }, made)), Model{}, mill());
}

/// Largest difference of a column and what a function of angle [rad] and direction says.
template <class Expected>
double off(const Observations& data, const Eigen::VectorXd& column, const Expected& expected) {
  double largest = 0.0;
  for (std::size_t k = 0; k < data.size(); ++k)
    largest = std::max(largest, std::abs(column(static_cast<Eigen::Index>(k)) -
                                         expected(data.along[k] * std::numbers::pi / 180.0, data.approach[k])));
  return largest;
}

}  // namespace

TEST_CASE("squareness makes an ellipse at 45 degrees of a circle, unlike scales one along the axes") {
  const Observations data = quiet_circle();
  const Regressors regressors(data);
  EffectInstance lean = effect(squareness, Axis::Y, Sense::EX);
  lean.sense.reset();
  lean.code = Component::C0Y;
  const double radius_m = 0.1;
  CHECK(off(data, regressors.columns(lean, 0.0).of.col(0),
            [&](double a, int) { return -0.5 * radius_m * std::sin(2.0 * a); }) < 1e-9);
  CHECK(off(data, regressors.columns(effect(scale, Axis::X, Sense::EX), 0.0).of.col(0),
            [&](double a, int) { return 0.5 * radius_m * std::cos(2.0 * a); }) < 1e-9);
  CHECK(off(data, regressors.columns(effect(scale, Axis::Y, Sense::EY), 0.0).of.col(0),
            [&](double a, int) { return -0.5 * radius_m * std::cos(2.0 * a); }) < 1e-9);
}

TEST_CASE("lost motion and lag follow the motion of their own axis") {
  const Observations data = quiet_circle();
  const Regressors regressors(data);
  // in steps at 90 and 270 degrees: cos θ sign(...) has no centre, no radius
  CHECK(off(data, regressors.columns(effect(backlash, Axis::X, Sense::EX), 0.0).of.col(0),
            [](double a, int d) { return 0.5 * std::cos(a) * (-std::sin(a) * d > 0.0 ? 1.0 : -1.0); }) < 5e-3);
  CHECK(off(data, regressors.columns(effect(servo_lag, Axis::X, Sense::EX), 0.0).of.col(0), [](double a, int d) {
          return -2.0 * d * std::sin(a) * std::cos(a);  // 2 m/min
        }) < 1e-9);
  // straightness reversal of Y in X: the same all round but for the size of the cosine, its mean is radius
  const Eigen::VectorXd across = regressors.columns(effect(backlash, Axis::Y, Sense::EX), 0.0).of.col(0);
  CHECK(off(data, across, [](double a, int d) { return 0.5 * d * (std::abs(std::cos(a)) - 2.0 / std::numbers::pi); }) <
        5e-3);
}

TEST_CASE("what is centre or radius of a pass alone does not act") {
  const Observations data = quiet_circle();
  const Regressors regressors(data);
  CHECK(regressors.columns(effect(offset, Axis::X, Sense::EX), 0.0).of.isZero(0.0));
  CHECK(regressors.acting(effect(offset, Axis::Z, Sense::EZ)).readings.empty());
}

TEST_CASE("products with readings are products with the motions they are made up of") {
  const Observations data = quiet_circle();
  const Regressors regressors(data);
  const auto motions = static_cast<Eigen::Index>(regressors.motions().size());
  const Eigen::MatrixXd of_motions = Eigen::MatrixXd::Random(motions, 3);
  const Eigen::MatrixXd of_readings = Eigen::MatrixXd::Random(static_cast<Eigen::Index>(data.size()), 2);
  const Eigen::MatrixXd one = of_readings.transpose() * regressors.readings_from(of_motions);
  const Eigen::MatrixXd other = regressors.motions_from(of_readings).transpose() * of_motions;
  CHECK((one - other).norm() < 1e-9 * one.norm());
}

TEST_CASE("a part of the readings sees what all of them see there") {
  const Observations data = quiet_circle();
  std::vector<std::size_t> third;
  for (std::size_t k = 0; k < data.size(); k += 3) third.push_back(k);
  const Observations part = subset(data, third);
  const EffectInstance spike = effect(backlash, Axis::Y, Sense::EY);
  const Eigen::VectorXd all = Regressors(data).columns(spike, 0.0).of.col(0);
  const Eigen::VectorXd some = Regressors(part).columns(spike, 0.0).of.col(0);
  for (std::size_t i = 0; i < third.size(); ++i)
    CHECK(some(static_cast<Eigen::Index>(i)) == all(static_cast<Eigen::Index>(third[i])));
}
