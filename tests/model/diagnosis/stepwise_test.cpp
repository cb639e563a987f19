#include "model/diagnosis/stepwise.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <string>

#include "tests/model/support/searching.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;

namespace {

const StepwiseOptions kOptions{.most_effects = 3, .entry_score = 15.0};

std::vector<EffectInstance> usual_suspects() {
  return candidates_named({"cyclic:X:EX", "backlash:X:EX", "sag:X:EX", "step:X:EX", "time_drift:X:EX"});
}

double step_and_backlash(const Reading& r) { return (p(r) > 512.0 ? 1.5 : 0.0) + 0.8 * d(r); }

}  // namespace

TEST_CASE("nothing is added to noise") {
  for (const unsigned seed : {1U, 2U, 3U, 4U, 5U}) {
    const Searching of(measured_line(nothing, seed), kSigma_um, usual_suspects());
    CHECK(best_solution(of.search, kOptions).chosen.empty());
  }
}

TEST_CASE("two causes of different kinds are both found") {
  const Searching of(measured_line(step_and_backlash), kSigma_um, usual_suspects());
  const Solution found = best_solution(of.search, kOptions);
  CHECK(of.names_of(found.chosen) == std::vector<std::string>{"backlash:X:EX", "step:X:EX"});
}

TEST_CASE("the order of the candidates does not change the answer") {
  auto candidates = usual_suspects();
  const Searching forward(measured_line(step_and_backlash), kSigma_um, candidates);
  std::reverse(candidates.begin(), candidates.end());
  const Searching backward(measured_line(step_and_backlash), kSigma_um, candidates);
  const Solution one = best_solution(forward.search, kOptions), other = best_solution(backward.search, kOptions);
  CHECK(forward.names_of(one.chosen) == backward.names_of(other.chosen));
  CHECK(one.score() == Approx(other.score()));
}

TEST_CASE("a pair is found at once, but only where it need not be alike") {
  const auto drift_and_backlash = [](const Reading& r) { return 1e-3 * r.time_s.value_or(0.0) + 0.8 * d(r); };
  const std::vector<std::string> hidden{"backlash:X:EX", "time_drift:X:EX"};
  const Searching of(measured_line(drift_and_backlash), kSigma_um, usual_suspects());
  const auto pairs = of.search.pairs_of(of.search.alone().space, 1, 0.0);
  REQUIRE(pairs.size() == 1);
  CHECK(of.names_of({pairs[0].first, pairs[0].second}) == hidden);
  for (const auto& [one, other] : of.search.pairs_of(of.search.alone().space, 100, 0.5))
    CHECK(of.names_of({one, other}) != hidden);
}

TEST_CASE("what is left after two causes were found is noise") {
  const Searching of(measured_line(step_and_backlash), kSigma_um, usual_suspects());
  const Solution found = best_solution(of.search, kOptions);
  const double freedom = 246.0 - 2.0 - 2.0 - 1.0;  // readings, offset and scale, two sizes, the place of the step
  CHECK(found.space.chi2() == Approx(freedom).epsilon(3.0 * std::sqrt(2.0 / freedom)));
}

TEST_CASE("no more effects are added than allowed, and none that gains less than asked") {
  const Searching of(measured_line(step_and_backlash), kSigma_um, usual_suspects());
  StepwiseOptions one = kOptions;
  one.most_effects = 1;
  CHECK(best_solution(of.search, one).chosen.size() == 1);
  StepwiseOptions proud = kOptions;
  proud.entry_gain = 1e6;
  CHECK(best_solution(of.search, proud).chosen.empty());
}

TEST_CASE("two drifts that nearly cancel each other are found together, though neither explains anything alone") {
  const Searching of(measured_line([](const Reading& r) {
                       return 40.0 * (r.sensors_degC.at("t_material_degC") - 20.5) - 0.00924 * *r.time_s;
                     }),
                     kSigma_um, [] {
                       auto candidates = usual_suspects();
                       candidates.push_back(candidate("thermal_drift:X:EX", "t_material_degC"));
                       return candidates;
                     }());
  for (const Choice& alone : of.search.expand(of.search.alone().space))
    if (of.name_of(alone) == "time_drift:X:EX" || of.name_of(alone) == "thermal_drift:X:EX")
      CHECK(alone.score() < 60.0);
  CHECK(of.names_of(best_solution(of.search, kOptions).chosen) ==
        std::vector<std::string>{"thermal_drift:X:EX", "time_drift:X:EX"});
}

TEST_CASE("a wave has to explain six targets better than any values of their own do") {
  const auto has_wave = [](int targets, const Truth& truth) {
    const Searching of(measured({.step_mm = 1000.0 / targets, .targets = targets, .runs = 2}, kSigma_um, truth),
                       kSigma_um, candidates_named({"cyclic:X:EX"}));
    return !best_solution(of.search, kOptions).chosen.empty();
  };
  const Truth any = [](const Reading& r) { return 9.0 * std::sin(77.0 * p(r)); };  // far below the distance of targets
  CHECK_FALSE(has_wave(6, any));
  CHECK(has_wave(40, [](const Reading& r) { return 9.0 * std::sin(p(r) / 30.0); }));
}

TEST_CASE("an effect with the same columns is a rival, one that explains less is not") {
  auto set = measured_line([](const Reading& r) { return 3.0 * (r.sensors_degC.at("t_material_degC") - 20.5); });
  for (auto& r : set.readings) r.sensors_degC["t_copy_degC"] = r.sensors_degC.at("t_material_degC");
  const std::vector<EffectInstance> candidates{candidate("thermal_drift:X:EX", "t_material_degC"),
                                               candidate("thermal_drift:X:EX", "t_copy_degC"),
                                               candidate("backlash:X:EX")};
  const Searching of(set, kSigma_um, candidates);
  const Solution found = best_solution(of.search, kOptions);
  REQUIRE(found.chosen.size() == 1);
  const std::vector<Group> groups = groups_of(of.search, found, kOptions.entry_score);
  CHECK(of.search.families()[only(groups).member.family].effect.sensor == "t_material_degC");  // the first of equals
  CHECK(of.search.families()[only(groups.front().rivals).family].effect.sensor == "t_copy_degC");
}

TEST_CASE("a shape that fits anything is not a rival of a reversal error") {
  const Searching of(measured_line([](const Reading& r) { return 0.8 * d(r); }), kSigma_um, usual_suspects());
  const Solution found = best_solution(of.search, kOptions);
  const std::vector<Group> groups = groups_of(of.search, found, kOptions.entry_score);
  CHECK(of.name_of(only(groups).member) == "backlash:X:EX");
  CHECK(groups.front().rivals.empty());
}

namespace {

/// Three runs one way. Drifts of two temperatures nearly cancel each other: what is left changes as fast as the
/// temperatures differ, and repeats differ by that.
Diagnosis diagnosis_of_cancelling_drifts(double um_per_degC, unsigned seed) {
  auto set = measured({.targets = 30, .both_ways = false}, 0.0, nothing);
  std::mt19937_64 random(seed);
  NormalDraws normal;
  double apart_degC = 0.0;
  for (Reading& r : set.readings) {
    apart_degC = 0.9 * apart_degC + 0.03 * normal(random);
    const double room_degC = 20.0 + 0.8 * std::sin(*r.time_s / 400.0 + seed);
    r.sensors_degC = {{"t_bed_degC", room_degC}, {"t_column_degC", room_degC + apart_degC}};
    r.error = um_per_degC * apart_degC + kNoise_um * normal(random);
  }
  return diagnosed(straight(), set);
}

}  // namespace

TEST_CASE("two drifts that nearly cancel each other are found although repeats differ by them as by noise") {
  int both = 0, any = 0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    std::set<std::string> sensors;
    for (const Candidate& candidate : diagnosis_of_cancelling_drifts(11.0, seed).candidates)
      if (candidate.in_answer() && candidate.effect.id == effects::thermal_drift)
        sensors.insert(candidate.effect.sensor);
    if (sensors == std::set<std::string>{"t_bed_degC", "t_column_degC"}) ++both;
    for (const Candidate& candidate : diagnosis_of_cancelling_drifts(0.0, seed).candidates)
      any += candidate.in_answer() ? 1 : 0;
  }
  CHECK(both >= 9);
  CHECK(any == 0);
}
