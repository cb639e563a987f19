// Curves, waves and steps on few targets, against errors of single targets that have no order.
#include "tests/model/support/measured_lines.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;

namespace {

/// Errors of a line at so many targets, two runs both ways.
Diagnosis diagnosed_line(int targets, unsigned seed, const std::function<double(int target)>& error_um) {
  constexpr double kStep_mm = 47.3;  // no multiple of a pitch
  const auto set = measured(
      {.step_mm = kStep_mm, .targets = targets, .runs = 2}, kNoise_um,
      [&](const Reading& r) { return error_um(static_cast<int>(std::lround(p(r) / kStep_mm))); }, seed);
  return diagnosed(usual_model(set, mill()), set);
}

bool proves_any(const Diagnosis& found) {
  return std::ranges::any_of(found.candidates, [](const Candidate& one) { return one.standing == Standing::proved; });
}

}  // namespace

TEST_CASE("errors of single targets without any order are no proved curve, wave or step, and the answer says why") {
  int proved = 0, named = 0, reasons = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const int targets = 8 + static_cast<int>(seed) % 7;
    std::mt19937_64 random(seed);
    NormalDraws draws(0.0, 8.0 * kNoise_um);
    std::vector<double> errors_um;
    for (int i = 0; i < targets; ++i) errors_um.push_back(draws(random));
    const Diagnosis found =
        diagnosed_line(targets, seed, [&](int target) { return errors_um.at(static_cast<std::size_t>(target)); });
    CHECK(found.verdict != Verdict::adequate);
    proved += proves_any(found) ? 1 : 0;
    named += std::ranges::any_of(found.candidates, &Candidate::in_answer) ? 1 : 0;
    reasons += contains(found.headline, "No effect is named, because errors of single targets") ? 1 : 0;
  }
  CHECK(proved <= 1);
  CHECK(named <= 8);  // eight or nine values can look like a curve
  CHECK(reasons >= 8);
}

TEST_CASE("beside a lost motion without any order, waves of each approach are no proved effects") {
  int proved = 0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    std::mt19937_64 random(seed);
    NormalDraws draws(0.0, 8.0 * kNoise_um);
    std::vector<double> lost_um;
    for (int i = 0; i < 24; ++i)
      lost_um.push_back(i % 4 == 0 ? draws(random) : lost_um.back());  // jumps from zone to zone
    constexpr double kStep_mm = 35.3;
    const auto set = measured({.step_mm = kStep_mm, .targets = 24, .runs = 3}, kNoise_um, [&](const Reading& r) {
      return 0.5 * d(r) * lost_um.at(static_cast<std::size_t>(std::lround(p(r) / kStep_mm)));
    });
    for (const Candidate& one : diagnosed(usual_model(set, mill()), set).candidates)
      proved += one.standing == Standing::proved && one.effect.definition().traits.periodic ? 1 : 0;
  }
  CHECK(proved <= 1);
}

TEST_CASE("a smooth curve on eight targets and more is proved, on six it is likely at least") {
  for (unsigned seed = 1; seed <= 10; ++seed)
    for (const int targets : {6, 8, 12}) {
      CAPTURE(seed);
      CAPTURE(targets);
      const Diagnosis found = diagnosed_line(targets, seed, [&](int target) {
        const double u = target / (targets - 1.0);
        return 40.0 * kNoise_um * u * (1.0 - u) * (1.0 + 0.1 * seed * u);
      });
      CAPTURE(found.headline);
      CHECK(std::ranges::any_of(found.candidates, &Candidate::in_answer));
      if (targets > 6) CHECK(proves_any(found));
    }
}

TEST_CASE("a wave on seven targets is likely, alone or as one of several causes, and single targets are the reason") {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const auto set = measured(
        {.step_mm = 45.0, .targets = 7, .runs = 2}, 1.0,
        [](const Reading& r) { return 4.0 * std::sin(2.0 * std::numbers::pi * p(r) / 75.0 + 0.6); }, seed);
    const Diagnosis found = diagnosed(straight(), set);
    CAPTURE(found.headline);
    CHECK(found.verdict == Verdict::likely_effect);
    CHECK(contains(found.headline, "cyclic:X:EX"));
    CHECK(contains(found.headline, "errors of single targets without any order cannot be excluded"));
    CHECK_FALSE(proves_any(found));
  }
}

TEST_CASE(
    "errors of single targets in one approach are no proved wave of that approach, nor one beside a lost motion") {
  int proved = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const int targets = 7 + static_cast<int>(seed % 2) * 9;
    std::mt19937_64 random(seed);
    NormalDraws draws(0.0, 16.0 * kNoise_um);
    std::vector<double> errors_um;
    for (int i = 0; i < targets; ++i) errors_um.push_back(draws(random));
    constexpr double kStep_mm = 47.3;
    const auto set = measured({.step_mm = kStep_mm, .targets = targets}, kNoise_um, [&](const Reading& r) {
      return d(r) < 0.0 ? errors_um.at(static_cast<std::size_t>(std::lround(p(r) / kStep_mm))) : 0.0;
    });
    proved += proves_any(diagnosed(usual_model(set, mill()), set)) ? 1 : 0;
  }
  CHECK(proved <= 1);
}

TEST_CASE("a lost motion that jumps from zone to zone is no curve, and the answer says why; one that bends is proved") {
  constexpr double kStep_mm = 38.3;
  constexpr int kTargets = 26, kZones = 12;
  const auto diagnosis_of = [&](unsigned seed, const std::function<double(int target)>& lost_um) {
    const auto set = measured(
        {.step_mm = kStep_mm, .targets = kTargets}, kNoise_um,
        [&](const Reading& r) { return 0.5 * d(r) * lost_um(static_cast<int>(std::lround(p(r) / kStep_mm))); }, seed);
    return diagnosed(usual_model(set, mill()), set);
  };
  const auto is_named = [](const Diagnosis& found) {
    return std::ranges::any_of(found.candidates, [](const Candidate& one) {
      return one.in_answer() && one.effect.id == effects::reversal_curve;
    });
  };
  int named = 0, reasons = 0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    std::mt19937_64 random(seed);
    NormalDraws draws(0.0, 8.0 * kNoise_um);
    std::vector<double> zones_um;
    for (int zone = 0; zone < kZones; ++zone) zones_um.push_back(draws(random));
    const Diagnosis jumps = diagnosis_of(
        seed, [&](int target) { return zones_um.at(static_cast<std::size_t>(target * kZones / kTargets)); });
    CHECK(jumps.verdict != Verdict::adequate);
    named += is_named(jumps) ? 1 : 0;
    reasons += contains(jumps.headline, "jumps from one place to the next") ? 1 : 0;
    for (const double rough : {0.0, 0.1}) {  // errors of single targets beside a curve are no jumps
      const Diagnosis bends = diagnosis_of(seed, [&](int target) {
        const double u = target / (kTargets - 1.0);
        return 8.0 * kNoise_um * (zones_um[0] * u * (1.0 - u) + std::sin(6.0 * u + zones_um[1])) +
               rough * zones_um.at(static_cast<std::size_t>(5 * target % kZones));
      });
      CHECK(is_named(bends));
      CHECK(proves_any(bends));
    }
  }
  CHECK(named <= 2);  // of four that no jumps are weighed against
  CHECK(reasons >= 2);
}
