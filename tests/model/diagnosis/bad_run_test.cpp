#include "model/diagnosis/bad_run.hpp"

#include <array>
#include <numbers>
#include <random>

#include <rapidcheck.h>

#include "tests/model/support/searching.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;
using namespace ecs::model::test::effects;
using Eigen::Index;
using Eigen::VectorXd;

namespace {

Plan line_of_runs(int runs, int targets = 41) { return {.targets = targets, .runs = runs}; }

std::optional<RunOffset> best_offset_in(const laser::MeasurementSet& set) {
  const Searching of(set, kSigma_um, {});
  return best_run_offset(of.data, of.whitener, of.search.base());
}

/// Normal deviates, those of one run times a factor.
struct Scatter {
  Observations data;
  VectorXd residual;
  std::vector<bool> left_out;
};
Scatter scatter_of(const Plan& plan, unsigned seed, int wide_run = 0, double factor = 1.0) {
  Scatter made;
  made.data = observations_of(measured(plan, 1.0, nothing, seed), straight(), mill());
  made.residual = Eigen::Map<const VectorXd>(made.data.reading.data(), static_cast<Index>(made.data.size()));
  for (std::size_t k = 0; k < made.data.size(); ++k)
    if (made.data.run[k] == wide_run) made.residual(static_cast<Index>(k)) *= factor;
  made.left_out.assign(made.data.size(), false);
  return made;
}
std::optional<NoisyRun> noisy_run_in(const Scatter& made) {
  return noisy_run(made.data, made.residual / kSigma_um, made.residual, made.left_out);
}

}  // namespace

TEST_CASE("the offset of a run gains its square for every reading of it, less the part that the mean of all takes") {
  const auto found = must(
      best_offset_in(measured(line_of_runs(5), kSigma_um, [](const Reading& r) { return r.run == 3 ? 1.0 : 0.0; })));
  CHECK(found.run == 3);
  CHECK(found.sense == Sense::EX);
  const double promised = 1.0 * 82.0 * (1.0 - 82.0 / 410.0) / (kSigma_um * kSigma_um);  // 82 of 410 readings
  CHECK(found.gain == Approx(promised).epsilon(0.1));
  // one coefficient, and one run chosen out of five
  CHECK(found.score == Approx(found.gain - std::log(410.0) - 2.0 * std::log(5.0)).epsilon(0.01));
}

TEST_CASE("a run that drifts along the axis gains offset and slope together") {
  const auto set = measured(line_of_runs(4), kSigma_um,
                            [](const Reading& r) { return r.run == 2 ? 0.3 + 4.0 * (p(r) - 500.0) / 1000.0 : 0.0; });
  const Searching of(set, kSigma_um, {});
  const auto found = must(best_run_offset(of.data, of.whitener, of.search.base()));
  CHECK(found.run == 2);
  const double left = of.search.base().chi2() - found.gain;
  CHECK(left == Approx(328.0 - 4.0).epsilon(0.2));  // noise of 328 readings, √(2/328) = 8 %
  CHECK(found.has_slope);
}

TEST_CASE("an answer states the slope of a run that has one") {
  const auto set = measured(line_of_runs(3, 21), kSigma_um,
                            [](const Reading& r) { return r.run == 2 ? 6.0 * (p(r) - 250.0) / 500.0 : 0.0; });
  const Model model = straight();
  const std::string text = must(must(diagnose(model, observations_of(set, model, mill()))).different_run).text;
  CHECK_MESSAGE(contains(text, "Run 2 changes by +6"), text);
}

TEST_CASE("a reversal that all runs share is no drift of the last run, a drift in it is one") {
  const auto drift_in = [](const Truth& truth) {
    const Scatter made{.data = observations_of(measured(line_of_runs(4), kSigma_um, truth), straight(), mill())};
    return drift_of_last_run(
        made.data, Eigen::Map<const VectorXd>(made.data.reading.data(), static_cast<Index>(made.data.size())), 4);
  };
  CHECK_FALSE(drift_in([](const Reading& r) { return 3.0 * d(r); }));
  const double before_s = 3.0 * (820.0 + 200.0);  // three runs of 82 readings, one each 10 s
  CHECK(must(drift_in([=](const Reading& r) { return 3.0 * d(r) + 0.005 * std::max(0.0, *r.time_s - before_s); })) ==
        Approx(0.005 * 810.0).epsilon(0.1));
}

TEST_CASE("whichever run is off, up or down, is the one that is found") {
  CHECK(rc::check([] {
    const int runs = *rc::gen::inRange(3, 7), bad = *rc::gen::inRange(1, runs + 1);
    const double height_um = *rc::gen::element(-3.0, -0.7, 0.7, 3.0);
    const auto found = best_offset_in(measured(
        line_of_runs(runs, 15), kSigma_um, [&](const Reading& r) { return r.run == bad ? height_um : 0.0; },
        static_cast<unsigned>(*rc::gen::inRange(1, 1000))));
    RC_ASSERT(found.has_value());
    RC_ASSERT(found->run == bad);
    RC_ASSERT(found->score > 0.0);
  }));
}

TEST_CASE("where each run has a zero of its own none is the bad one, unless it is far off all of them") {
  const auto zeros_and = [](double far_um) {
    return best_offset_in(measured(line_of_runs(7, 15), kSigma_um, [=](const Reading& r) {
      constexpr std::array kZeros_um{0.9, -1.1, 1.0, -0.8, 1.3, -0.9, -1.0};
      return kZeros_um.at(static_cast<std::size_t>(r.run) - 1) + (r.run == 5 ? far_um : 0.0);
    }));
  };
  CHECK_FALSE(zeros_and(0.0));
  CHECK(must(zeros_and(15.0)).run == 5);
}

TEST_CASE("of two runs none is the bad one") {
  CHECK_FALSE(
      best_offset_in(measured(line_of_runs(2), kSigma_um, [](const Reading& r) { return r.run == 2 ? 5.0 : 0.0; })));
}

TEST_CASE("effects that are together no more than another zero of one of two runs are no causes") {
  // a drift, a lost motion that grows along the axis and a constant lost motion sum up to the second run's zero
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const auto set = measured(
        line_of_runs(2, 13), kSigma_um, [](const Reading& r) { return r.run == 2 ? 6.0 : 0.0; }, seed);
    Model model = straight();
    model.effects.push_back(effect(backlash, Axis::X, Sense::EX));
    const Diagnosis found = must(diagnose(model, observations_of(set, model, mill())));
    CHECK_MESSAGE(found.verdict != Verdict::missing_effect, found.headline);
    CHECK_FALSE_MESSAGE(contains(found.headline, "Found:"), found.headline);
  }
}

TEST_CASE("runs that differ by noise alone score nothing in nineteen sets of twenty") {
  unsigned above = 0;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    const auto found = must(best_offset_in(measured(line_of_runs(3, 15), kSigma_um, nothing, seed)));
    if (found.score > 0.0) ++above;
  }
  CHECK(above <= 10);
}

TEST_CASE("a run comes first where it explains as much, and is mentioned up to a hundredth of the evidence") {
  const EffectInstance drift = effect(time_drift, Axis::X, Sense::EX);
  CHECK(rc::check([&] {
    RunOffset run;
    run.score = 0.1 * *rc::gen::inRange(1, 10'000);
    const double hundredfold = 2.0 * std::log(100.0);  // scores are twice logarithms of evidence
    RC_ASSERT(run_beside(run, drift, run.score) == RunBeside::as_good);
    RC_ASSERT(run_beside(run, drift, run.score + 0.01) == RunBeside::nearly_as_good);
    RC_ASSERT(run_beside(run, drift, run.score + hundredfold - 0.01) == RunBeside::nearly_as_good);
    RC_ASSERT(run_beside(run, drift, run.score + hundredfold + 0.01) == RunBeside::worse);
  }));
}

TEST_CASE("a run that gains less than it costs never comes first") {
  RunOffset run;
  run.score = -1.0;
  CHECK(run_beside(run, effect(time_drift, Axis::X, Sense::EX), 0.0) == RunBeside::worse);
}

TEST_CASE("feed, load and the map are set run by run: their effects stand whatever an offset of a run explains") {
  RunOffset run;
  run.score = 1e6;
  for (const EffectId id : {servo_lag, load, map_polarity, map_gain, map_shift, map_direction_swap}) {
    CAPTURE(name_of(id));
    CHECK(run_beside(run, effect(id, Axis::X, Sense::EX), 20.0) == RunBeside::worse);
  }
  for (const EffectId id : {time_drift, thermal_drift, dead_path, warm_up}) {
    CAPTURE(name_of(id));
    CHECK(run_beside(run, effect(id, Axis::X, Sense::EX), 20.0) == RunBeside::as_good);
  }
}

TEST_CASE("a run that scatters three times as much as the others is found with its factor") {
  for (int runs = 3; runs <= 6; ++runs) {
    // The mean of |N(0, 1)| of n readings is uncertain by √((π/2 − 1)/n) of itself, n = 82 of the run, 82 (runs − 1) of
    // the others: 10 % of the ratio of three runs. At five sigmas one choice of these 900 seeds in 2,000 has a set
    // beyond.
    const double sigma = 3.0 * std::sqrt((0.5 * std::numbers::pi - 1.0) / 82.0 * (1.0 + 1.0 / (runs - 1)));
    for (int wide = 1; wide <= runs; ++wide)
      for (unsigned seed = 1; seed <= 50; ++seed) {
        CAPTURE(runs);
        CAPTURE(wide);
        CAPTURE(seed);
        const auto found = must(noisy_run_in(scatter_of(line_of_runs(runs), seed, wide, 3.0)));
        CHECK(found.run == wide);
        CHECK(std::abs(found.ratio - 3.0) < 5.0 * sigma);
      }
  }
}

TEST_CASE("of three short runs the one that scatters four times as much is found in four of five sets") {
  unsigned found = 0;
  for (unsigned seed = 1; seed <= 100; ++seed)
    if (noisy_run_in(scatter_of(line_of_runs(3, 9), seed, 2, 4.0))) ++found;  // 18 readings a run
  CHECK(found >= 80);
}

TEST_CASE("of a thousand sets of equal runs one at most shows a noisy one, however short the runs are") {
  for (const int targets : {4, 8, 41}) {  // 8, 16, 82 readings a run
    CAPTURE(targets);
    unsigned found = 0;
    for (unsigned seed = 1; seed <= 1000; ++seed)
      if (noisy_run_in(scatter_of(line_of_runs(3, targets), seed))) ++found;
    CHECK(found <= 1);
  }
}

TEST_CASE("a run is noisy only where the residual shows it both as it is and whitened") {
  const Scatter wide = scatter_of(line_of_runs(4), 1, 2, 4.0), even = scatter_of(line_of_runs(4), 1);
  REQUIRE(noisy_run(wide.data, wide.residual, wide.residual, wide.left_out));
  CHECK_FALSE(noisy_run(wide.data, wide.residual, even.residual, wide.left_out));
  CHECK_FALSE(noisy_run(wide.data, even.residual, wide.residual, wide.left_out));
}

TEST_CASE("outliers of all runs make none noisy, a burst of them in one run does, and one of two runs is none") {
  const auto with_outliers = [](std::size_t every, int of_run) {
    Scatter made = scatter_of(line_of_runs(4), 3);
    for (std::size_t k = 0; k < made.data.size(); k += every)
      if (of_run == 0 || made.data.run[k] == of_run) {
        made.residual(static_cast<Index>(k)) *= 50.0;
        made.left_out[k] = true;
      }
    return made;
  };
  CHECK_FALSE(noisy_run_in(with_outliers(9, 0)));  // 36 or 37, 9 a run
  Scatter burst = with_outliers(14, 2);            // 6 of 82
  const auto found = must(noisy_run_in(burst));
  CHECK(found.run == 2);
  CHECK(found.ratio > 2.0);
  burst.left_out.assign(burst.data.size(), false);  // too few to be more than heavy tails
  CHECK_FALSE(noisy_run_in(burst));
  CHECK_FALSE(noisy_run_in(scatter_of(line_of_runs(2), 1, 2, 5.0)));
}

TEST_CASE("of a thousand sets of which one reading in twenty is an outlier two at most show a burst") {
  unsigned found = 0;
  for (unsigned seed = 1; seed <= 1000; ++seed) {
    Scatter made = scatter_of(line_of_runs(5, 20), seed);
    std::mt19937_64 random(seed);
    for (std::size_t k = 0; k < made.data.size(); ++k) made.left_out[k] = random() % 20 == 0;
    if (noisy_run_in(made)) ++found;
  }
  CHECK(found <= 2);
}

namespace {

std::optional<OddPass> odd_pass_in(const laser::MeasurementSet& set) {
  const Observations data = observations_of(set, straight(), mill());
  const Eigen::VectorXd residual =
      Eigen::Map<const Eigen::VectorXd>(data.reading.data(), static_cast<Eigen::Index>(data.size()));
  return odd_pass(data, residual, std::vector<bool>(data.size(), false));
}

}  // namespace

TEST_CASE("an axis that stuck in one direction of one run of five makes that pass odd, by what it stuck") {
  const auto found = must(odd_pass_in(measured(line_of_runs(5, 14), kSigma_um, [](const Reading& r) {
    return r.run == 2 && r.approach == Approach::forward ? -10.0 * kSigma_um : 0.0;
  })));
  CHECK(found.run == 2);
  CHECK(found.off_um == Approx(-10.0 * kSigma_um).epsilon(0.1));
}

TEST_CASE("of passes that differ from each other by far none is odd") {
  CHECK_FALSE(odd_pass_in(measured(line_of_runs(6, 14), kSigma_um, [](const Reading& r) {
    return 10.0 * kSigma_um * static_cast<double>(r.run * r.run % 7);
  })));
}

TEST_CASE("noise alone makes no pass odd in two hundred sets") {
  for (unsigned seed = 1; seed <= 200; ++seed)
    CHECK_FALSE(odd_pass_in(measured(line_of_runs(5, 14), kSigma_um, nothing, seed)));
}

namespace {

/// Readings of eight runs, 50 a run, whose means are these.
std::optional<StepOfRuns> step_in(const std::vector<double>& means_um, double noise_um = 0.4) {
  Plan plan = line_of_runs(static_cast<int>(means_um.size()), 25);
  const auto set =
      measured(plan, noise_um, [&](const Reading& r) { return means_um[static_cast<std::size_t>(r.run) - 1]; });
  const Observations data = observations_of(set, straight(), mill());
  const VectorXd residual = Eigen::Map<const VectorXd>(data.reading.data(), static_cast<Index>(data.size()));
  return step_of_runs(data, residual, std::vector<bool>(data.size()));
}

}  // namespace

TEST_CASE("a jump of all readings between two runs beside a drift is a step, not a bad run") {
  // 1.8 um from run to run, and a fall of 7.7 um from run 4 to 5: 9.5 um beside the drift
  const auto step = must(step_in({-1.55, 0.25, 2.05, 3.85, -3.85, -2.05, -0.25, 1.55}));
  CHECK(step.before == 4);
  CHECK(step.after == 5);
  CHECK(step.height_um == Approx(-7.7 - 1.8).epsilon(0.02));
}

TEST_CASE("one run apart from the others is no step, and neither is noise") {
  CHECK_FALSE(step_in({0.0, 0.0, 0.0, 0.0, -4.0, 0.0, 0.0, 0.0}));
  CHECK_FALSE(step_in({0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -4.0}));  // of the last run both are the same
  CHECK_FALSE(step_in({0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0}));
  CHECK_FALSE(step_in({0.0, 0.0, 0.0, -4.0}));  // four runs: a trend and a step fit anything
}

namespace {

std::optional<OddPass> run_apart_in(const std::vector<double>& means_um, unsigned seed = 1) {
  Scatter made = scatter_of(line_of_runs(static_cast<int>(means_um.size())), seed);
  for (std::size_t k = 0; k < made.data.size(); ++k)
    made.residual(static_cast<Index>(k)) += means_um[static_cast<std::size_t>(made.data.run[k]) - 1];
  return run_apart(made.data, made.residual, made.left_out);
}

}  // namespace

TEST_CASE("a run lies apart only if the others lie closer to each other than chance allows") {
  const auto found = must(run_apart_in({0.0, 0.0, 0.0, 0.0, -5.0, 0.0}));
  CHECK(found.run == 5);
  CHECK(found.off_um == Approx(-5.0).epsilon(0.1));
  CHECK(must(run_apart_in({1.0, -1.0, 0.5, 0.0, -15.0, 0.0})).run == 5);  // far beyond what the others differ
  CHECK_FALSE(run_apart_in({-9.94, 9.74, -5.82, 9.50, -8.96, 5.47}));     // a law of the load
  CHECK_FALSE(run_apart_in({-4.0, 0.0, 4.0}));                            // each of three differs
  CHECK(must(run_apart_in({-4.0, 0.0, 0.0})).run == 1);
  CHECK_FALSE(run_apart_in({-4.0, 0.0}));
}

TEST_CASE("of runs of noise alone one lies apart once in a hundred sets") {
  unsigned found = 0;
  for (unsigned seed = 1; seed <= 400; ++seed)
    if (run_apart_in({0.0, 0.0, 0.0, 0.0}, seed)) ++found;
  CHECK(found <= 10);  // 4 expected: three standard deviations
}

TEST_CASE("where other effects take all differences between the other runs none is apart") {
  const auto truth = [](const Reading& r) { return r.run == 2 ? 2.0 : 0.0; };
  Searching of(measured(line_of_runs(4), kSigma_um, truth), kSigma_um, {});
  REQUIRE(best_run_offset(of.data, of.whitener, of.search.base()));
  Space taken = of.search.base();
  Eigen::MatrixXd runs = Eigen::MatrixXd::Zero(static_cast<Index>(of.data.size()), 2);
  for (std::size_t k = 0; k < of.data.size(); ++k)
    if (of.data.run[k] > 2) runs(static_cast<Index>(k), of.data.run[k] - 3) = 1.0;
  absorb(taken, of.whitener(runs));
  CHECK_FALSE(best_run_offset(of.data, of.whitener, taken));
}

TEST_CASE("a bad run is said in the ratio of what the sentence says in um") {
  Scatter made = scatter_of(line_of_runs(5), 3);
  VectorXd whitened = made.residual;  // the whitener makes much of run 3
  for (std::size_t k = 0; k < made.data.size(); ++k) {
    if (made.data.run[k] != 3) continue;
    made.residual(static_cast<Index>(k)) += 4.0;
    whitened(static_cast<Index>(k)) = 3.0 * made.residual(static_cast<Index>(k));
  }
  const auto run = must(noisy_run(made.data, whitened, made.residual, made.left_out));
  CHECK(run.run == 3);
  CHECK(must(run.off_um) == Approx(4.0).epsilon(0.1));
  CHECK(run.ratio == Approx(4.0 / 0.8).epsilon(0.1));  // mean |N(0, 1)| is 0.80
}

namespace {

/// Five runs of a line with an error of its own; run 3 as it was written.
laser::MeasurementSet with_run_written(const std::function<double(double error_um)>& written, unsigned seed) {
  auto set = measured(
      {.targets = 17, .runs = 5}, kNoise_um,
      [](const Reading& r) { return 2.5 + 0.014 * p(r) + 3.0 * std::sin(p(r) / 170.0) + 1.6 * d(r); }, seed);
  for (Reading& r : set.readings)
    if (r.run == 3) r.error = written(r.error);
  return set;
}

}  // namespace

TEST_CASE("a run in another unit or with the wrong sign is named with its factor, before an offset of that run") {
  for (const double factor : {-1.0, 0.001, 1000.0, 25.4, 1.0 / 25.4, 10.0, 0.1, 2.0, 0.5}) {
    CAPTURE(factor);
    Model model = straight();
    for (const EffectId id : {backlash, progressive}) model.effects.push_back(effect(id, Axis::X, Sense::EX));
    const Diagnosis found = diagnosed(model, with_run_written([&](double error_um) { return factor * error_um; }, 1));
    CAPTURE(found.headline);
    const std::string says = fmt::format("The readings of run 3 are {:.4g} times those of the other runs", factor);
    CHECK(found.headline.starts_with(says));
    CHECK(must(found.different_run).run == 3);
    REQUIRE_FALSE(found.where.empty());
    CHECK(found.where.front().variable == "run");
    for (const std::string& note : found.notes) CHECK_FALSE(contains(note, "offset of run"));
    const auto told = std::ranges::find(found.left, "arithmetic", &LeftProperty::property);
    REQUIRE(told != found.left.end());
    CHECK(told->is == fmt::format("{:.5g}", factor));
  }
}

TEST_CASE("another zero, another size, or more scatter of a run is no factor of it, and neither is noise") {
  std::mt19937_64 random(5);
  NormalDraws noise(0.0, 4.0);
  int turned = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const auto scaled = [&](const std::function<double(double)>& written) {
      return scaled_run(observations_of(with_run_written(written, seed), straight(), mill()));
    };
    CHECK_FALSE(scaled([](double error_um) { return error_um; }));
    CHECK_FALSE(scaled([](double error_um) { return error_um - 8.0; }));
    CHECK_FALSE(scaled([](double error_um) { return 1.4 * error_um; }));
    CHECK_FALSE(scaled([&](double error_um) { return error_um + noise(random); }));
    turned += scaled([](double error_um) { return -error_um; }) ? 1 : 0;
  }
  CHECK(turned >= 38);
}

namespace {

/// The line of with_run_written at two heights, three runs each; at the second one as it was written.
laser::MeasurementSet with_line_written(const std::function<double(double error_um, const Reading& r)>& written,
                                        unsigned seed) {
  std::mt19937_64 random(seed);
  NormalDraws noise(0.0, kNoise_um);
  laser::MeasurementSet set = measured({.targets = 17, .runs = 6}, kNoise_um, nothing, seed);
  for (Reading& r : set.readings) {
    r.error = 2.5 + 0.014 * p(r) + 3.0 * std::sin(p(r) / 170.0) + 1.6 * d(r) + noise(random);
    r.position_mm[2] = r.run > 3 ? 370.0 : 50.0;
    if (r.run > 3) r.error = written(r.error, r);
  }
  return set;
}

}  // namespace

TEST_CASE("if one of two lines is in another unit, the answer states the factor and names no angular error") {
  for (const double factor : {-1.0, 0.001, 25.4, 1.0 / 25.4, 2.0}) {
    CAPTURE(factor);
    Model model = straight();
    for (const EffectId id : {backlash, progressive}) model.effects.push_back(effect(id, Axis::X, Sense::EX));
    const Diagnosis found =
        diagnosed(model, with_line_written([&](double error_um, const Reading&) { return factor * error_um; }, 1));
    CAPTURE(found.headline);
    CHECK(found.headline.starts_with("The line of EX along X at Y 0, Z "));
    CHECK(contains(found.headline, "times as much as the other line at the same targets"));
    CHECK(found.verdict == Verdict::unexplained_structure);
    CHECK(std::ranges::none_of(found.candidates, &Candidate::in_answer));
    CHECK(std::ranges::find(found.left, "arithmetic", &LeftProperty::property) != found.left.end());
  }
}

TEST_CASE("an angle that acts through the distance of two lines, another zero and noise are no other unit") {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const auto scaled = [&](const std::function<double(double, const Reading&)>& written) {
      return scaled_line(observations_of(with_line_written(written, seed), straight(), mill()));
    };
    CHECK_FALSE(scaled([](double error_um, const Reading&) { return error_um; }));
    CHECK_FALSE(scaled([](double error_um, const Reading&) { return error_um + 12.0; }));
    CHECK_FALSE(scaled([](double error_um, const Reading& r) { return error_um + 0.012 * p(r); }));
    CHECK_FALSE(scaled([](double error_um, const Reading& r) { return error_um + 5.0 * std::sin(p(r) / 90.0); }));
  }
}

TEST_CASE("an angle alone that acts twice as much on the farther line is named") {
  std::mt19937_64 random(3);
  NormalDraws noise(0.0, kNoise_um);
  laser::MeasurementSet set = measured({.targets = 17, .runs = 6}, kNoise_um, nothing, 3);
  for (Reading& r : set.readings) {
    r.position_mm[2] = r.run > 3 ? 400.0 : 200.0;  // of the line Z 0 along which X was measured
    r.error = 0.02 * r.position_mm[2] * std::sin(p(r) / 170.0) + noise(random);
  }
  REQUIRE(must(scaled_line(observations_of(set, straight(), mill()))).factor == 2.0);
  const Diagnosis found = diagnosed(straight(), set);
  CAPTURE(found.headline);
  CHECK(found.verdict == Verdict::missing_effect);
  CHECK(count_named(found) == 1);
  CHECK(stands_for(found.candidates.front(), "angular:X:EBX"));
}

TEST_CASE("an angle is named on lines of which one is twice as far as the median of the others, which differ too") {
  std::mt19937_64 random(4);
  NormalDraws noise(0.0, kNoise_um);
  laser::MeasurementSet set = measured({.targets = 17, .runs = 6}, kNoise_um, nothing, 4);
  for (Reading& r : set.readings) {
    r.position_mm[2] = r.run > 4 ? 400.0 : r.run > 2 ? 300.0 : 100.0;
    r.error = 0.02 * r.position_mm[2] * std::sin(p(r) / 170.0) + noise(random);
  }
  REQUIRE(must(scaled_line(observations_of(set, straight(), mill()))).factor == 2.0);
  const Diagnosis found = diagnosed(straight(), set);
  CAPTURE(found.headline);
  CHECK(found.verdict == Verdict::missing_effect);
  CHECK(stands_for(found.candidates.front(), "angular:X:EBX"));
}

TEST_CASE("a third line in another unit or with the wrong sign is reported although an angle could explain it") {
  for (const double factor : {10.0, -1.0})
    for (const unsigned seed : {1U, 2U, 3U}) {
      std::mt19937_64 random(seed);
      NormalDraws noise(0.0, kNoise_um);
      laser::MeasurementSet set = measured({.targets = 17, .runs = 6}, kNoise_um, nothing, seed);
      for (Reading& r : set.readings) {
        r.position_mm[1] = r.run > 4 ? 300.0 : 0.0;
        r.position_mm[2] = r.run == 3 || r.run == 4 ? 300.0 : 0.0;
        r.error = 3.0 * std::sin(p(r) / 170.0) + 0.0036 * r.position_mm[2] * p(r) / 300.0 + noise(random);
        if (r.run > 4) r.error *= factor;
      }
      Model model = straight();
      model.effects.push_back(effect(progressive, Axis::X, Sense::EX));
      const Diagnosis found = diagnosed(model, set);
      CAPTURE(found.headline);
      CHECK(found.headline.starts_with("The line of EX along X at Y 300, Z 0 "));
      CHECK(std::ranges::none_of(found.candidates, &Candidate::in_answer));
    }
}

TEST_CASE("six readings of one run that jump far to both sides are a burst; the answer states the run") {
  constexpr std::array kBurst_um{-3.3, -2.9, 4.2, 2.6, -4.4, -0.7};
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const auto set = measured(
        {.targets = 25, .runs = 3, .both_ways = false}, kNoise_um,
        [&](const Reading& r) {
          const long place = std::lround(p(r) / 25.0) - 9;
          return r.run == 2 && place >= 0 && place < 6 ? kBurst_um.at(static_cast<std::size_t>(place)) : 0.0;
        },
        seed);
    const Diagnosis found = diagnosed(straight(), set);
    CAPTURE(found.headline);
    CHECK(found.verdict == Verdict::unexplained_structure);
    CHECK(contains(found.headline, "Run 2 scatters"));
  }
}

TEST_CASE("noise with far readings here and there has no burst") {
  int bursts = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    std::mt19937_64 random(seed);
    std::student_t_distribution<double> tails(3.0);
    const auto set = measured(
        {.targets = 41, .runs = 4}, 0.0, [&](const Reading&) { return kNoise_um * tails(random); }, seed);
    bursts += contains(diagnosed(straight(), set).headline, "scatters") ? 1 : 0;
  }
  CHECK(bursts == 0);
}
