#include "model/diagnosis/wander.hpp"

#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include "tests/support/measured_lines.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kNoiseOfOne_um = 0.2;

/// One line there and back, 41 targets; what time does to it is added.
struct OneRun {
  Observations data;
  NoiseModel noise;
  std::vector<bool> left_out;
  VectorXd target;

  explicit OneRun(const std::function<double(double time_s)>& by_time, unsigned seed = 1, int runs = 1)
      : data(observations_of(measured(plan_of(runs), kNoiseOfOne_um, nothing, seed), straight(), mill())),
        noise(plain_noise(data, kNoiseOfOne_um)),
        left_out(data.size(), false),
        target(Eigen::Map<const VectorXd>(data.reading.data(), static_cast<Index>(data.size()))) {
    noise.has_time = true;
    for (Index k = 0; k < target.size(); ++k) target(k) += by_time(data.time_s[static_cast<std::size_t>(k)]);
  }
  static Plan plan_of(int runs) {
    Plan plan;
    plan.runs = runs;
    return plan;
  }
  [[nodiscard]] MatrixXd mean() const { return MatrixXd::Ones(target.size(), 1); }
  [[nodiscard]] MatrixXd mean_and_drift() const {
    MatrixXd columns = MatrixXd::Ones(target.size(), 2);
    for (Index k = 0; k < target.size(); ++k) columns(k, 1) = data.time_s[static_cast<std::size_t>(k)];
    return columns;
  }
  /// How much better a straight drift explains it than a wander.
  [[nodiscard]] double drift_before_wander() const {
    return deviance_of_wander(data, noise, left_out, mean(), target) -
           deviance_of(data, noise, left_out, mean_and_drift(), target) - std::log(static_cast<double>(data.size()));
  }
};

}  // namespace

TEST_CASE("the deviance of independent noise is that of its mean square") {
  const OneRun run([](double) { return 0.0; });
  const double n = static_cast<double>(run.target.size());
  const double mean_square = (run.target.array() - run.target.mean()).square().mean();
  const double expected =
      n * std::log(mean_square / (kNoiseOfOne_um * kNoiseOfOne_um)) + n * std::log(std::pow(kNoiseOfOne_um, 2));
  CHECK(deviance_of(run.data, run.noise, run.left_out, run.mean(), run.target) ==
        doctest::Approx(expected).epsilon(0.01));
}

TEST_CASE("a straight drift has more than a hundred times the evidence of a wander") {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const OneRun run([](double t) { return 0.002 * t; }, seed);
    CHECK(run.drift_before_wander() > 2.0 * std::log(100.0));
  }
}

TEST_CASE("a random walk is no drift: in most sets the wander explains it better") {
  int wanders = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> step(0.0, 0.4);
    double level = 0.0;
    const OneRun run([&](double) { return level += step(random); }, seed);
    if (run.drift_before_wander() < 2.0 * std::log(100.0)) ++wanders;
  }
  CHECK(wanders >= 19);
}

TEST_CASE("another zero in every run is explained by levels of the runs") {
  const OneRun run([](double t) { return 3.0 * std::sin(std::floor(t / 1000.0) * 40.0); }, 3, 5);
  CHECK(deviance_of_wander(run.data, run.noise, run.left_out, run.mean(), run.target) <
        deviance_of(run.data, run.noise, run.left_out, run.mean(), run.target) - 50.0);
}

TEST_CASE("what people set by hand is no wander, a curve only where nothing repeats it") {
  const OneRun run([](double) { return 0.0; });
  NoiseModel repeated = run.noise;
  repeated.pure.from_repeats = true;
  NoiseModel once = run.noise;
  once.pure.from_repeats = false;
  using namespace ecs::model::test::effects;
  for (const EffectId id : {servo_lag, load, map_gain})
    CHECK_FALSE(may_be_wander(once, effect(id, Axis::X, Sense::EX)));
  for (const EffectId id : {time_drift, thermal_drift, warm_up})
    CHECK(may_be_wander(repeated, effect(id, Axis::X, Sense::EX)));
  CHECK(may_be_wander(once, effect(sag, Axis::X, Sense::EX)));
  CHECK_FALSE(may_be_wander(repeated, effect(sag, Axis::X, Sense::EX)));
}
