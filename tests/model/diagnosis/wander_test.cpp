#include "model/diagnosis/wander.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include <doctest/doctest.h>

#include "base/random.hpp"
#include "tests/model/support/measured_lines.hpp"

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
  [[nodiscard]] MatrixXd none() const { return MatrixXd(target.size(), 0); }
  [[nodiscard]] MatrixXd drift() const {
    MatrixXd column(target.size(), 1);
    for (Index k = 0; k < target.size(); ++k) column(k, 0) = data.time_s[static_cast<std::size_t>(k)];
    return column;
  }
  [[nodiscard]] double of_noise() const { return deviance_of(data, {noise, 0.0}, left_out, mean(), none(), target); }
  [[nodiscard]] double of_wander() const {
    return likely_wanders(data, noise, left_out, mean(), target).front().deviance;
  }
  /// How much better a straight drift explains it than a wander.
  [[nodiscard]] double drift_before_wander() const {
    return of_wander() - deviance_of(data, {noise, 0.0}, left_out, mean(), drift(), target) -
           std::log(static_cast<double>(data.size()));
  }
};

}  // namespace

TEST_CASE("the deviance of independent noise is Student's density of what a mean leaves") {
  const OneRun run([](double) { return 0.0; });
  const double n = static_cast<double>(run.target.size()), freedom = n - 1.0;
  const double squares = (run.target.array() - run.target.mean()).square().sum();
  // the integral over mean and ln σ by hand: covariance σ₁²·I, columns of ones
  const double ln_sigma = std::log(kNoiseOfOne_um);
  const double expected = freedom * (std::log(std::numbers::pi * squares) - 2.0 * ln_sigma) -
                          2.0 * std::lgamma(0.5 * freedom) + 2.0 * n * ln_sigma + std::log(n) - 2.0 * ln_sigma;
  CHECK(run.of_noise() == doctest::Approx(expected).epsilon(1e-9));
}

TEST_CASE("the deviance does not depend on what the model itself can take") {
  const OneRun run([](double t) { return 0.001 * t; });
  const VectorXd moved = run.target + 12.5 * run.mean();
  CHECK(deviance_of(run.data, {run.noise, 0.0}, run.left_out, run.mean(), run.drift(), moved) ==
        doctest::Approx(deviance_of(run.data, {run.noise, 0.0}, run.left_out, run.mean(), run.drift(), run.target)));
}

TEST_CASE("of columns that follow from the others none is kept, nor one that only an outlier shows") {
  const OneRun run([](double) { return 0.0; });
  MatrixXd columns(run.target.size(), 4);
  columns << run.mean(), run.drift(), 2.0 * run.mean() - run.drift(), MatrixXd::Zero(run.target.size(), 1);
  columns(7, 3) = 1.0;
  std::vector<bool> left_out(run.data.size(), false);
  CHECK(independent_columns(columns, left_out).cols() == 3);
  left_out[7] = true;
  CHECK(independent_columns(columns, left_out).cols() == 2);
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
    NormalDraws step(0.0, 0.4);
    double level = 0.0;
    const OneRun run([&](double) { return level += step(random); }, seed);
    if (run.drift_before_wander() < 2.0 * std::log(100.0)) ++wanders;
  }
  CHECK(wanders >= 19);
}

TEST_CASE("another zero in every run is explained by levels of the runs") {
  const OneRun run([](double t) { return 3.0 * std::sin(std::floor(t / 1000.0) * 40.0); }, 3, 5);
  CHECK(run.of_wander() < run.of_noise() - 50.0);
}

TEST_CASE("what changes in time or is set by hand may be a wander, a curve only where nothing repeats it") {
  const OneRun run([](double) { return 0.0; });
  NoiseModel repeated = run.noise;
  repeated.pure.from_repeats = true;
  NoiseModel once = run.noise;
  once.pure.from_repeats = false;
  using namespace ecs::model::test::effects;
  for (const EffectId id : {time_drift, thermal_drift, warm_up, servo_lag, load, map_gain})
    CHECK(may_be_wander(repeated, effect(id, Axis::X, Sense::EX)));
  CHECK(may_be_wander(once, effect(sag, Axis::X, Sense::EX)));
  CHECK_FALSE(may_be_wander(repeated, effect(sag, Axis::X, Sense::EX)));
}
