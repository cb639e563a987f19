#include "model/diagnosis/e_value.hpp"

#include <numbers>

#include <rapidcheck.h>

#include "tests/model/support/searching.hpp"
#include "tests/support/normal_matrix.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;
using namespace ecs::model::test::effects;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

Plan of_targets(int targets, int runs = 3) { return {.step_mm = 1000.0 / targets, .targets = targets, .runs = runs}; }

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
    const double e =
        of.e_value(effect, kSigma_um * ecs::test::normal_matrix(of.target.size(), 1, seed).col(0)).value_or(1.0);
    seen.mean += e / sets;
    if (e >= 100.0) ++seen.beyond_hundred;
  }
  return seen;
}

double lost_motion_of_two_um(const Reading& r) { return d(r); }

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
  CHECK(Weighed(measured_line([](const Reading& r) { return std::sin(2.0 * std::numbers::pi * p(r) / 87.3); }))
            .e_value(candidate("cyclic:X:EX"))
            .value() > 1e50);
  CHECK(Weighed(measured_line([](const Reading& r) { return p(r) > 512.0 ? 1.5 : 0.0; }))
            .e_value(candidate("step:X:EX"))
            .value() > 1e30);
}

TEST_CASE("of sixteen readings a true step or spike has evidence, and noise has one in the mean at most") {
  const Plan few = of_targets(8, 1);
  const auto e_of = [&](const char* name, const Truth& truth) {
    return must(Weighed(measured(few, kSigma_um, truth)).e_value(candidate(name)));
  };
  CHECK(e_of("step:X:EX", [](const Reading& r) { return p(r) > 500.0 ? 2.0 : 0.0; }) > 100.0);
  CHECK(e_of("warm_up:X:EX", [](const Reading& r) { return -4.0 * std::exp(-*r.time_s / 40.0); }) > 100.0);
  for (const char* name : {"step:X:EX", "warm_up:X:EX"}) CHECK(on_noise(candidate(name), few, 400).mean <= 1.0);
}

TEST_CASE("a wave of four steps has evidence in a single run") {
  const auto wave = [](const Reading& r) { return std::sin(0.5 * std::numbers::pi * p(r) / 10.0 + 0.4); };
  auto set = measured({.step_mm = 10.0, .targets = 72, .runs = 1}, kSigma_um, nothing);
  for (Reading& r : set.readings) {
    r.position_mm[0] = 10.0 * std::round(r.position_mm[0] / 10.0);  // even targets
    r.error += wave(r);
  }
  CHECK(must(Weighed(set).e_value(candidate("cyclic:X:EX"))) > 1e6);
}

TEST_CASE("a curve across, read on few targets beside many positions, has the evidence that it has alone") {
  const auto bow = [](const Reading& r) {
    return r.sense == Sense::EY ? 3.0 * std::sin(2.0 * std::numbers::pi * p(r) / 700.0) : 0.0;
  };
  const Plan across{.sense = Sense::EY, .step_mm = 80.0, .targets = 12, .runs = 1};
  const Model model{.effects = {effect(offset, Axis::X, Sense::EX), effect(offset, Axis::X, Sense::EY)}};
  auto set = measured({.runs = 5}, kSigma_um, bow);
  measure(set, across, kSigma_um, bow);
  const Diagnosis found = diagnosed(model, set);
  CHECK(count_named(found) == 1);
  REQUIRE_FALSE(found.candidates.empty());
  CHECK(found.candidates.front().standing == Standing::proved);
  CHECK(found.candidates.front().effect.sense == Sense::EY);
}

TEST_CASE("evidence for a false cause stays below that for the true one") {
  const Weighed of(measured_line(lost_motion_of_two_um));
  for (const char* text : {"cyclic:X:EX", "sag:X:EX", "step:X:EX", "time_drift:X:EX"}) {
    CAPTURE(text);
    CHECK(of.e_value(candidate(text)).value_or(0.0) < 100.0);
  }
}

TEST_CASE("e depends neither on the unit of the readings nor on what the model itself can take") {
  const Weighed of(measured_line([](const Reading& r) { return 0.1 * d(r); }));
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
    const VectorXd steps = ecs::test::normal_matrix(of.target.size(), 1, seed).col(0);
    VectorXd walk = 0.1 * kSigma_um * ecs::test::normal_matrix(of.target.size(), 1, 100 + seed).col(0);
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
      const VectorXd steps = ecs::test::normal_matrix(of.target.size(), 1, seed).col(0);
      VectorXd y = 0.5 * kSigma_um * ecs::test::normal_matrix(of.target.size(), 1, 1000 + seed).col(0);
      double zero = steps(0);
      for (Index k = 0; k < y.size(); ++k) {
        zero = 0.95 * zero + std::sqrt(1.0 - 0.95 * 0.95) * steps(k);
        y(k) += kSigma_um * zero;
      }
      const auto e = must(e_value_of({of.regressors, once, of.left_out}, of.columns, y, candidate(text),
                                     NullHypothesis::noise_or_wander));
      mean += e / kSets;
      if (e >= 100.0) ++beyond_hundred;
    }
    CHECK(mean < 1.5);
    CHECK(beyond_hundred <= 1);
  }
}

TEST_CASE("beside turbulence of a minute the mean of e is at most one, though both halves of the targets share it") {
  constexpr double kTime_s = 60.0, kShare = 0.9;
  const Weighed of(measured(of_targets(21, 3), kSigma_um, nothing));
  NoiseModel noise = of.noise;
  noise.has_time = true;
  for (NoiseGroup& group : noise.groups) {
    group.white = std::sqrt(1.0 - kShare) * kSigma_um;
    group.correlated = std::sqrt(kShare) * kSigma_um;
    group.time = kTime_s;
  }
  constexpr unsigned kSets = 200;
  double mean = 0.0;
  for (unsigned seed = 1; seed <= kSets; ++seed) {
    const VectorXd steps = ecs::test::normal_matrix(of.target.size(), 1, seed).col(0);
    VectorXd y =
        std::sqrt(1.0 - kShare) * kSigma_um * ecs::test::normal_matrix(of.target.size(), 1, 1000 + seed).col(0);
    double air = 0.0, before_s = -1e9;
    for (Index k = 0; k < y.size(); ++k) {
      const double now_s = of.data.time_s[static_cast<std::size_t>(k)], memory = std::exp((before_s - now_s) / kTime_s);
      air = memory * air + std::sqrt(1.0 - memory * memory) * steps(k);
      y(k) += std::sqrt(kShare) * kSigma_um * air;
      before_s = now_s;
    }
    mean += e_value_of({of.regressors, noise, of.left_out}, of.columns, y, candidate("backlash:X:EX"),
                       NullHypothesis::noise)
                .value_or(1.0) /
            kSets;
  }
  CHECK(mean < 1.5);
}

TEST_CASE("a lost motion has evidence beside zeros of the runs of half its size, not if each pass has such a zero") {
  const auto e_of = [](bool by_pass, unsigned seed) {
    const Eigen::MatrixXd zeros_um = 0.4 * ecs::test::normal_matrix(7, 2, seed);
    const Weighed of(measured(
        of_targets(13, 6), kSigma_um,
        [&](const Reading& r) {
          const double zero_um = zeros_um(r.run, by_pass && d(r) > 0.0 ? 1 : 0);
          return zero_um + (by_pass ? 0.0 : 0.45 * d(r));
        },
        seed));
    NoiseModel noise = of.noise;
    noise.has_time = true;
    noise.pure.noise_um = kSigma_um;
    return e_value_of({of.regressors, noise, of.left_out}, of.columns, of.target, candidate("backlash:X:EX"),
                      NullHypothesis::noise_or_wander)
        .value_or(0.0);
  };
  double mean = 0.0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    CHECK(e_of(false, seed) > 1.0);
    mean += e_of(true, seed) / 20.0;
  }
  CHECK(mean < 1.5);
}

TEST_CASE("a straight drift keeps its evidence against a wander") {
  const Weighed of(measured(of_targets(41, 3), kSigma_um, [](const Reading& r) { return 0.002 * *r.time_s; }));
  NoiseModel noise = of.noise;
  noise.has_time = true;
  CHECK(must(e_value_of({of.regressors, noise, of.left_out}, of.columns, of.target, candidate("time_drift:X:EX"),
                        NullHypothesis::noise_or_wander)) >= 100.0);
}

TEST_CASE("a drift beside which the zero walks a little keeps its evidence: what walks is far less than the drift") {
  constexpr double kUmPerSecond = 0.03, kStep_um = 0.3 * kSigma_um;
  const Weighed of(measured(of_targets(41, 3), kSigma_um, nothing));
  NoiseModel noise = of.noise;
  noise.has_time = true;
  for (const unsigned seed : {1U, 2U}) {
    CAPTURE(seed);
    const VectorXd steps = ecs::test::normal_matrix(of.target.size(), 1, seed).col(0);
    VectorXd y = kSigma_um * ecs::test::normal_matrix(of.target.size(), 1, 100 + seed).col(0);
    double zero = 0.0;
    for (Index k = 0; k < y.size(); ++k) {
      zero += kStep_um * steps(k);
      y(k) += zero + kUmPerSecond * of.data.time_s[static_cast<std::size_t>(k)];
    }
    CHECK(must(e_value_of({of.regressors, noise, of.left_out}, of.columns, y, candidate("time_drift:X:EX"),
                          NullHypothesis::noise_or_wander)) >= 1e60);
  }
}

namespace {

/// Readings against offset and scale; a backlash is tested beside them.
struct Tested {
  Observations data = observations_of(measured_line(nothing), straight(), mill());
  Regressors regressors{data};
  NoiseModel noise = plain_noise(data, kSigma_um);
  std::vector<bool> left_out = std::vector<bool>(data.size(), false);
  MatrixXd columns{static_cast<Index>(data.size()), 2};
  MatrixXd effect = regressors.columns(candidate("backlash:X:EX"), 0.0).of;

  Tested() {
    for (std::size_t k = 0; k < data.size(); ++k)
      columns.row(static_cast<Index>(k)) << 1.0, data.p_mm(k, Axis::X) / 1000.0;
  }
  [[nodiscard]] double p_value(const VectorXd& y, double tests = 1.0) const {
    return p_value_of({regressors, noise, left_out}, columns, y, effect, tests);
  }
  [[nodiscard]] VectorXd of_noise(double size_um, unsigned seed) const {
    return size_um * ecs::test::normal_matrix(columns.rows(), 1, seed).col(0);
  }
};

}  // namespace

TEST_CASE("in noise of any size a p-value is below a chance as often as that chance says") {
  const Tested of;
  constexpr unsigned kSets = 2000;
  for (const double size_um : {0.01, 30.0}) {
    CAPTURE(size_um);
    unsigned below_tenth = 0, below_hundredth = 0;
    for (unsigned seed = 1; seed <= kSets; ++seed) {
      const double p = of.p_value(of.of_noise(size_um, seed));
      below_tenth += p <= 0.1 ? 1U : 0U;
      below_hundredth += p <= 0.01 ? 1U : 0U;
    }
    CHECK(below_tenth / static_cast<double>(kSets) == Approx(0.1).epsilon(0.2));
    CHECK(below_hundredth <= 35);  // of 20 on average: three standard deviations
  }
}

TEST_CASE("a p-value pays for every test, and is at most one") {
  const Tested of;
  const VectorXd y = of.of_noise(kSigma_um, 3) + 0.1 * of.effect.col(0);
  const double p = of.p_value(y);
  CHECK(of.p_value(y, 7.0) == Approx(std::min(1.0, 7.0 * p)));
  CHECK(of.p_value(of.of_noise(kSigma_um, 3), 1e9) == 1.0);
}

TEST_CASE("a p-value depends neither on the unit nor on what the model itself can take") {
  const Tested of;
  const VectorXd y = of.of_noise(kSigma_um, 5) + 0.1 * of.effect.col(0);
  const double p = of.p_value(y);
  REQUIRE(p < 0.5);
  CHECK(of.p_value(1e3 * y + of.columns * Eigen::Vector2d(40.0, -7.0)) == Approx(p).epsilon(1e-6));
}

TEST_CASE("of the shapes of noise that the readings leave possible the one that speaks least for an effect counts") {
  Tested of;
  const VectorXd y = of.of_noise(kSigma_um, 3) + of.effect.col(0);
  const double in_white = of.p_value(y);
  const NoiseShape white = of.noise.shapes.front(), slow{0.9, 60.0, 1e-3, white.variance};
  of.noise.shapes = {slow};
  const double in_slow = of.p_value(y);
  REQUIRE(in_slow > 10.0 * in_white);
  of.noise.shapes = {white, slow};
  CHECK(of.p_value(y) == in_slow);
  of.noise.shapes[1].weight = 1e-12;  // ruled out
  CHECK(of.p_value(y) == in_white);
}

TEST_CASE("an effect that the model takes wholly has no evidence") {
  Tested of;
  of.effect = of.columns.col(1);
  CHECK(of.p_value(of.of_noise(kSigma_um, 3)) == 1.0);
}

TEST_CASE("the causes named for a fleet are those of a whole diagnosis, with p-values that hold among many machines") {
  DiagnoseOptions options{.noise_replicates = 60, .p_values = true};
  for (const double backlash_um : {0.0, 2.0}) {
    CAPTURE(backlash_um);
    const Observations data =
        observations_of(measured_line([&](const Reading& r) { return backlash_um * d(r); }), straight(), mill());
    const Diagnosis whole = diagnose(straight(), data, options).value();
    const NamedCauses names = named_causes(straight(), data, options).value();
    CHECK(names.verdict == whole.verdict);
    std::size_t named = 0;
    for (const Candidate& candidate : whole.candidates) {
      if (!candidate.named) continue;
      REQUIRE(named < names.causes.size());
      CHECK(names.causes[named].name == to_text(candidate.effect));
      CHECK(names.causes[named].probability == candidate.probability);
      CHECK(names.causes[named].e_value == candidate.e_value);
      CHECK(names.causes[named].false_naming == candidate.false_naming);
      ++named;
    }
    CHECK(names.causes.size() == named);
    CHECK(named == (backlash_um > 0.0 ? 1 : 0));
    CHECK((names.p_value < 1e-20) == (backlash_um > 0.0));
  }
}
