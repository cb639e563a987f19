#include "model/diagnosis/e_value.hpp"

#include <cmath>
#include <numbers>

#include <doctest/doctest.h>
#include <rapidcheck.h>

#include "tests/model/normal_matrix.hpp"
#include "tests/model/support/searching.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;
using namespace ecs::model::test::effects;
using doctest::Approx;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

Plan of_targets(int targets, int runs = 3) {
  Plan plan;
  plan.targets = targets;
  plan.step_mm = 1000.0 / targets;
  plan.runs = runs;
  return plan;
}

/// Readings against offset and scale.
struct Weighed {
  Observations data;
  Regressors regressors;
  NoiseModel noise;
  std::vector<bool> left_out;
  MatrixXd columns;
  VectorXd target;

  explicit Weighed(const laser::MeasurementSet& set)
      : data(observations_of(set, straight(), mill())),
        regressors(data),
        noise(plain_noise(data, kSigma_um)),
        left_out(data.size(), false),
        columns(static_cast<Index>(data.size()), 2),
        target(Eigen::Map<const VectorXd>(data.reading.data(), static_cast<Index>(data.size()))) {
    for (std::size_t k = 0; k < data.size(); ++k)
      columns.row(static_cast<Index>(k)) << 1.0, data.p_mm(k, Axis::X) / 1000.0;
  }
  [[nodiscard]] std::optional<double> e_value(const EffectInstance& effect, const VectorXd& y) const {
    return e_value_of({regressors, noise, left_out}, columns, y, effect, NullHypothesis::noise);
  }
  [[nodiscard]] std::optional<double> e_value(const EffectInstance& effect) const { return e_value(effect, target); }
};

/// Mean of e over sets of white noise, and how many of them reach 100.
struct OnNoise {
  double mean = 0.0;
  unsigned beyond_hundred = 0;
};
OnNoise on_noise(const EffectInstance& effect, const Plan& plan, unsigned sets) {
  const Weighed of(measured(plan, kSigma_um, nothing));
  OnNoise seen;
  for (unsigned seed = 1; seed <= sets; ++seed) {
    const auto e = of.e_value(effect, kSigma_um * normal_matrix(of.target.size(), 1, seed).col(0));
    REQUIRE(e);
    seen.mean += *e / sets;
    if (*e >= 100.0) ++seen.beyond_hundred;
  }
  return seen;
}

double lost_motion_of_two_um(const laser::Reading& r) { return d(r); }

}  // namespace

TEST_CASE("on a thousand sets of white noise the mean of e is at most one, and one in a hundred reaches a hundred") {
  for (const char* text : {"backlash:X:EX", "sag:X:EX"}) {
    CAPTURE(text);
    const OnNoise seen = on_noise(candidate(text), of_targets(11), 1000);
    CHECK(seen.mean < 1.1);
    CHECK(seen.beyond_hundred <= 10);
  }
}

TEST_CASE("on noise a wave whose period is sought, or a step whose place is, has no more evidence than one in size") {
  for (const char* text : {"cyclic:X:EX", "step:X:EX"}) {
    CAPTURE(text);
    const OnNoise seen = on_noise(candidate(text), of_targets(15), 200);
    CHECK(seen.mean < 1.1);
    CHECK(seen.beyond_hundred <= 2);
  }
}

TEST_CASE("a true effect has overwhelming evidence, sought parameters or not") {
  CHECK(Weighed(measured_line(lost_motion_of_two_um)).e_value(candidate("backlash:X:EX")).value() > 1e50);
  CHECK(Weighed(measured_line([](const laser::Reading& r) { return std::sin(2.0 * std::numbers::pi * p(r) / 87.3); }))
            .e_value(candidate("cyclic:X:EX"))
            .value() > 1e50);
  CHECK(Weighed(measured_line([](const laser::Reading& r) { return p(r) > 512.0 ? 1.5 : 0.0; }))
            .e_value(candidate("step:X:EX"))
            .value() > 1e30);
}

TEST_CASE("evidence for a false cause stays below that for the true one") {
  const Weighed of(measured_line(lost_motion_of_two_um));
  for (const char* text : {"cyclic:X:EX", "sag:X:EX", "step:X:EX", "time_drift:X:EX"}) {
    CAPTURE(text);
    CHECK(of.e_value(candidate(text)).value_or(0.0) < 100.0);
  }
}

TEST_CASE("e depends neither on the unit of the readings nor on what the model itself can take") {
  const Weighed of(measured_line([](const laser::Reading& r) { return 0.1 * d(r); }));
  const EffectInstance backlash_of_x = candidate("backlash:X:EX");
  const double e = of.e_value(backlash_of_x).value();
  REQUIRE(e > 1.0);
  CHECK(rc::check([&] {
    const double size = std::pow(10.0, *rc::gen::inRange(-3, 4));
    const VectorXd any = of.columns * Eigen::Vector2d(*rc::gen::inRange(-50, 51), *rc::gen::inRange(-50, 51));
    const auto again = of.e_value(backlash_of_x, size * (of.target + any));
    RC_ASSERT(again.has_value());
    RC_ASSERT(std::abs(std::log(*again / e)) < 1e-4);
  }));
}

TEST_CASE("nothing can be said of an effect that no split shows on both sides") {
  CHECK_FALSE(Weighed(measured_line(nothing)).e_value(candidate("scale:X:EX")));  // the model has it
  Weighed of(measured(of_targets(3, 1), kSigma_um, nothing));                     // six readings
  CHECK_FALSE(of.e_value(candidate("backlash:X:EX")));
}

TEST_CASE("outliers do not count") {
  Weighed of(measured_line(lost_motion_of_two_um));
  const double e = of.e_value(candidate("backlash:X:EX")).value();
  of.left_out[50] = true;
  of.target(50) += 1e4;
  CHECK(std::log(of.e_value(candidate("backlash:X:EX")).value()) == Approx(std::log(e)).epsilon(0.02));
}

TEST_CASE("large sets are weighed in part, with the answer that a small set of the kind gets") {
  const Plan large = of_targets(300, 4);  // 2400 readings
  CHECK(Weighed(measured(large, kSigma_um, lost_motion_of_two_um)).e_value(candidate("backlash:X:EX")).value() > 1e100);
  CHECK(Weighed(measured(large, kSigma_um, nothing)).e_value(candidate("backlash:X:EX")).value() < 100.0);
  CHECK_FALSE(Weighed(measured(large, kSigma_um, nothing)).e_value(candidate("scale:X:EX")));
}

TEST_CASE("against a random walk a drift has little evidence, however much it has against white noise") {
  const EffectInstance drift = candidate("time_drift:X:EX");
  const Weighed of(measured(of_targets(41, 1), kSigma_um, nothing));
  NoiseModel noise = of.noise;
  noise.has_time = true;
  unsigned against_noise = 0, against_wander = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const VectorXd steps = normal_matrix(of.target.size(), 1, seed).col(0);
    VectorXd walk = 0.1 * kSigma_um * normal_matrix(of.target.size(), 1, 100 + seed).col(0);
    double sum = 0.0;
    for (Index k = 0; k < walk.size(); ++k) walk(k) += sum += kSigma_um * steps(k);
    const auto reaches = [&](NullHypothesis null) {
      return e_value_of({of.regressors, noise, of.left_out}, of.columns, walk, drift, null).value_or(0.0) >= 100.0;
    };
    if (reaches(NullHypothesis::noise)) ++against_noise;
    if (reaches(NullHypothesis::noise_or_wander)) ++against_wander;
  }
  CHECK(against_noise >= 10);
  CHECK(against_wander <= 4);
}

TEST_CASE("against a zero that moves slowly the mean of e is at most one, though both halves move together") {
  const Weighed of(measured(of_targets(21, 3), kSigma_um, nothing));
  NoiseModel noise = of.noise;
  noise.has_time = true;
  for (const char* text : {"time_drift:X:EX", "sag:X:EX"}) {
    CAPTURE(text);
    NoiseModel once = noise;
    once.pure.from_repeats = false;
    double mean = 0.0;
    unsigned beyond_hundred = 0;
    constexpr unsigned kSets = 100;
    for (unsigned seed = 1; seed <= kSets; ++seed) {
      const VectorXd steps = normal_matrix(of.target.size(), 1, seed).col(0);
      VectorXd y = 0.5 * kSigma_um * normal_matrix(of.target.size(), 1, 1000 + seed).col(0);
      double zero = steps(0);
      for (Index k = 0; k < y.size(); ++k) {
        zero = 0.95 * zero + std::sqrt(1.0 - 0.95 * 0.95) * steps(k);
        y(k) += kSigma_um * zero;
      }
      const auto e = e_value_of({of.regressors, once, of.left_out}, of.columns, y, candidate(text),
                                NullHypothesis::noise_or_wander);
      REQUIRE(e);
      mean += *e / kSets;
      if (*e >= 100.0) ++beyond_hundred;
    }
    CHECK(mean < 1.5);
    CHECK(beyond_hundred <= 1);
  }
}

TEST_CASE("a straight drift keeps its evidence against a wander") {
  const Weighed of(measured(of_targets(41, 3), kSigma_um, [](const laser::Reading& r) { return 0.002 * *r.time_s; }));
  NoiseModel noise = of.noise;
  noise.has_time = true;
  const auto e = e_value_of({of.regressors, noise, of.left_out}, of.columns, of.target, candidate("time_drift:X:EX"),
                            NullHypothesis::noise_or_wander);
  REQUIRE(e);
  CHECK(*e >= 100.0);
}
