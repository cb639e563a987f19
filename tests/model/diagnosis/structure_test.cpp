#include "model/diagnosis/structure.hpp"

#include <numbers>

#include "tests/model/support/searching.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Tests of what offset and scale leave of a line, most certain first.
std::vector<StructureTest> tests_of(const Truth& truth, unsigned seed = 1) {
  const Searching of(measured({}, kSigma_um, truth, seed), kSigma_um, {});
  auto tests = Structure(of.data, of.whitener, 164.0).tests(of.search.base());
  std::sort(tests.begin(), tests.end(),
            [](const StructureTest& a, const StructureTest& b) { return a.minus_log_p > b.minus_log_p; });
  return tests;
}

const Variable& variable_named(const std::vector<Variable>& variables, const std::string& name) {
  return *std::find_if(variables.begin(), variables.end(), [&](const Variable& v) { return v.name == name; });
}

}  // namespace

TEST_CASE("the logarithm of a chance agrees with a printed F table") {
  CHECK(minus_log_p(4.964603, 1.0, 10.0) == Approx(-std::log10(0.05)).epsilon(1e-5));
  CHECK(minus_log_p(5.0 * 3.325835, 5.0, 10.0) == Approx(-std::log10(0.05)).epsilon(1e-5));
  CHECK(minus_log_p(100.0, 0.0, 10.0) == 0.0);  // no function, no test
}

TEST_CASE("noise depends on nothing") {
  for (const unsigned seed : {1U, 2U, 3U})
    for (const StructureTest& test : tests_of(nothing, seed)) CHECK(test.minus_log_p < 4.0);
}

TEST_CASE("a run of its own is found under run, a reversal error under approach, a wave under its position") {
  CHECK(tests_of([](const Reading& r) { return r.run == 2 ? 0.6 : 0.0; }).front().variable == "run");
  CHECK(tests_of([](const Reading& r) { return 0.3 * d(r); }).front().variable == "approach");
  CHECK(tests_of([](const Reading& r) { return 0.5 * std::sin(p(r) / 20.0); }).front().variable == "x_mm");
}

TEST_CASE("a variable gains about one for every function on noise, and all of its own shape") {
  for (const StructureTest& test : tests_of(nothing))
    CHECK(std::abs(test.gain - test.freedom) < 4.0 * std::sqrt(2.0 * test.freedom));
  const StructureTest found = tests_of([](const Reading& r) { return 0.4 * d(r); }).front();
  CHECK(found.excess == Approx(4.0).epsilon(0.2));  // (0.4/0.2)² per reading
}

TEST_CASE("a variable that never changes is left out") {
  const Searching of(measured({}, kSigma_um, nothing), kSigma_um, {});
  std::vector<std::string> names;
  for (const Variable& variable : variables_of(of.data)) names.push_back(variable.name);
  const auto has = [&](const char* name) { return std::find(names.begin(), names.end(), name) != names.end(); };
  CHECK(has("x_mm"));
  CHECK(has("approach"));
  CHECK(has("run"));
  CHECK(has("time_s"));
  CHECK(has("t_material_degC"));
  CHECK_FALSE(has("y_mm"));
  CHECK_FALSE(has("feed_mm_min"));
  CHECK_FALSE(has("compensated"));
}

TEST_CASE("what all runs share is not a function of the run") {
  const Searching of(measured({}, kSigma_um, nothing), kSigma_um, {});
  const auto variables = variables_of(of.data);
  const MatrixXd& columns = variable_named(variables, "run").columns;
  for (Index j = 0; j < columns.cols(); ++j) CHECK(std::abs(columns.col(j).sum()) < 1e-9);
}

TEST_CASE("the share of a variable is all of its own shape, nothing of another, and never negative") {
  const Searching of(measured({}, kSigma_um, nothing), kSigma_um, {});
  const auto variables = variables_of(of.data);
  VectorXd reversal(246), runs(246);
  for (Index k = 0; k < 246; ++k) {
    reversal(k) = of.data.approach[static_cast<std::size_t>(k)];
    runs(k) = of.data.run[static_cast<std::size_t>(k)] - 2.0;
  }
  const auto share = [&](const char* name, const VectorXd& residual, double noise_um) {
    return share_beyond_position(of.data, variable_named(variables, name), residual, noise_um);
  };
  CHECK(share("approach", reversal, 0.0) == Approx(1.0));
  CHECK(share("approach", runs, 0.0) == Approx(0.0));
  CHECK(share("run", runs, 0.0) == Approx(1.0));
  CHECK(share("run", runs, 100.0) == 0.0);
  CHECK(share("run", VectorXd::Zero(246), 1.0) == 0.0);
}

TEST_CASE("where an axis is parked explains nothing that the position along the measured line explains") {
  laser::MeasurementSet set;
  for (const double parked : {0.0, 300.0}) {
    measure(set, {.targets = 21, .runs = 1, .parked_mm = {0.0, parked, 0.0}}, 0.1,
            [&](const Reading& r) { return 5.0 * std::sin(p(r) / 60.0) + (r.position_mm[1] > 0.0 ? 0.18 : 0.0); });
  }
  for (std::size_t k = 0; k < set.readings.size(); ++k) set.readings[k].row = static_cast<int>(k) + 1;
  const Observations data = observations_of(set, straight(), mill());
  const auto variables = variables_of(data);
  const VectorXd residual =
      Eigen::Map<const VectorXd>(data.reading.data(), static_cast<Index>(data.size())).array() - 0.09;
  // the step of 0.18 um is ±0.09 about its mean, the wave is 5/√2 rms
  const double step = 0.09 * 0.09 / (5.0 * 5.0 / 2.0);
  CHECK(share_beyond_position(data, variable_named(variables, "y_mm"), residual, 0.1) < 5.0 * step);
  CHECK(share_beyond_position(data, variable_named(variables, "x_mm"), residual, 0.1) > 0.9);
}

TEST_CASE("the largest of noise replicates is what the tests of each replicate give") {
  const Searching of(measured({}, kSigma_um, nothing), kSigma_um, {});
  const Structure structure(of.data, of.whitener, 164.0);
  std::mt19937_64 random(6);
  NormalDraws normal;
  MatrixXd replicates = MatrixXd::NullaryExpr(246, 3, [&] { return normal(random); });
  const MatrixXd& q = of.search.base().q;
  replicates -= q * (q.transpose() * replicates);
  const auto largest = structure.largest_of(of.search.base(), replicates.cast<float>());
  REQUIRE(largest.size() == 3);
  for (Index b = 0; b < 3; ++b) {
    Space space = of.search.base();
    space.y = replicates.col(b);
    double most = 0.0;
    for (const StructureTest& test : structure.tests(space)) most = std::max(most, test.minus_log_p);
    CHECK(largest[static_cast<std::size_t>(b)] == Approx(most).epsilon(1e-3));
  }
}

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
    noise.pure.noise_um = kNoiseOfOne_um;
    for (Index k = 0; k < target.size(); ++k) target(k) += by_time(data.time_s[static_cast<std::size_t>(k)]);
  }
  static Plan plan_of(int runs) {
    Plan plan{.runs = runs};
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
  CHECK(run.of_noise() == Approx(expected).epsilon(1e-9));
}

TEST_CASE("the deviance does not depend on what the model itself can take") {
  const OneRun run([](double t) { return 0.001 * t; });
  const VectorXd moved = run.target + 12.5 * run.mean();
  CHECK(deviance_of(run.data, {run.noise, 0.0}, run.left_out, run.mean(), run.drift(), moved) ==
        Approx(deviance_of(run.data, {run.noise, 0.0}, run.left_out, run.mean(), run.drift(), run.target)));
}

TEST_CASE("readings that the model reproduces whatever they are tell of no law of noise") {
  const OneRun run([](double) { return 0.0; });
  const MatrixXd all = MatrixXd::Identity(run.target.size(), run.target.size());
  CHECK(deviance_of(run.data, {run.noise, 0.0}, run.left_out, all, run.drift(), run.target) == 0.0);
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

TEST_CASE("noise that wanders is drawn where the readings do, and wanders like them") {
  constexpr std::size_t kReplicates = 50;
  const auto drawn_for = [](const OneRun& run) {
    return wandering_noise(run.data, run.noise, run.left_out, run.mean(), run.target, kReplicates);
  };
  int of_steady = 0;
  for (unsigned seed = 1; seed <= 10; ++seed)
    of_steady += drawn_for(OneRun([](double) { return 0.0; }, seed)).replicates.cols() > 0 ? 1 : 0;
  CHECK(of_steady <= 1);
  const OneRun levels([](double t) { return 3.0 * std::sin(std::floor(t / 1020.0) * 40.0); }, 3, 5);
  const WanderingNoise wandering = drawn_for(levels);
  CHECK(wandering.probability > 0.99);
  REQUIRE(wandering.replicates.cols() == Index{kReplicates});
  const auto share_between_runs = [&](VectorXd readings) {
    readings.array() -= readings.mean();
    const MatrixXd runs = levels_of_runs(levels.data);
    const VectorXd counts = runs.colwise().sum().transpose();
    return ((runs.transpose() * readings).array().square() / counts.array()).sum() / readings.squaredNorm();
  };
  double sum = 0.0;
  for (Index b = 0; b < wandering.replicates.cols(); ++b) sum += share_between_runs(wandering.replicates.col(b));
  CHECK(sum / double{kReplicates} == Approx(share_between_runs(levels.target)).epsilon(0.2));
}

TEST_CASE("the chance that noise looks like a candidate is stated for readings that wander too") {
  int rare = 0, common = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    std::mt19937_64 random(seed);
    NormalDraws step(0.0, 0.3);
    double level = 0.0;
    const Truth walk = [&](const Reading&) { return level += step(random); };
    const Diagnosis diagnosis = diagnosed(straight(), measured({}, kNoiseOfOne_um, walk, seed));
    double least = 1.0;
    for (const Candidate& candidate : diagnosis.candidates) least = std::min(least, candidate.false_naming);
    rare += least < 0.05 ? 1 : 0;
    common += least > 0.3 ? 1 : 0;
  }
  CHECK(rare <= 4);  // 19 where the simulated noise does not wander
  CHECK(common >= 8);
  CHECK(common <= 19);
}
