// Verdicts on noise, on structure that nothing explains, and on models with free parameters.
#include <numbers>

#include "model/data/curve_basis.hpp"
#include "tests/model/support/measured_lines.hpp"
#include "tests/support/normal_matrix.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;

namespace {

/// Another value at every target, the same in all runs and both approaches: no effect of the library.
Truth with_value_of_target(double size_um, const Truth& truth, unsigned seed) {
  return [=, values = std::map<double, double>{}, random = std::mt19937_64(seed)](const Reading& r) mutable {
    NormalDraws normal;
    const auto value = values.find(p(r));
    return truth(r) + (value == values.end() ? values[p(r)] = size_um * normal(random) : value->second);
  };
}

}  // namespace

TEST_CASE("where the structure outweighs the cause the verdict is the structure, and the cause is listed as proved") {
  const Diagnosis found = diagnosed(straight(), measured({}, kNoise_um,
                                                         with_value_of_target(
                                                             3.0, [](const Reading& r) { return d(r); }, 1)));
  CHECK(found.verdict == Verdict::unexplained_structure);
  const auto backlash = std::find_if(found.candidates.begin(), found.candidates.end(),
                                     [](const Candidate& c) { return to_text(c.effect) == "backlash:X:EX"; });
  REQUIRE(backlash != found.candidates.end());
  CHECK(backlash->standing == Standing::proved);
  CHECK_MESSAGE(contains(found.headline, "the lesser part"), found.headline);
}

TEST_CASE("a proved cause is named beside structure that nothing explains: partly explained") {
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const Diagnosis found =
        diagnosed(straight(), measured({}, kNoise_um,
                                       with_value_of_target(
                                           1.0, [](const Reading& r) { return 5.0 * d(r); }, seed)));
    CHECK(found.verdict == Verdict::partly_explained);
    REQUIRE(count_named(found) == 1);
    const Candidate& first = found.candidates.front();
    CHECK(first.named);
    CHECK(to_text(first.effect) == "backlash:X:EX");
    CHECK(first.e_value.value_or(0.0) >= 100.0);
    CHECK(first.explainable_share >= 0.9);
    REQUIRE_FALSE(found.where.empty());
  }
}

TEST_CASE("of a square wave the first waves are proved, but they are a shape that repeats and no two causes") {
  int told = 0;
  for (const double noise_um : {1.2, 2.0, 2.5, 3.0, 3.5}) {  // the further ones lie above the noise, or in it
    const auto square = measured({.step_mm = 11.0, .targets = 90, .runs = 3}, noise_um,
                                 [](const Reading& r) { return std::fmod(p(r), 210.0) < 105.0 ? 4.0 : -4.0; });
    const Diagnosis diagnosis = diagnosed(straight(), square);
    CHECK_MESSAGE(count_named(diagnosis) * (diagnosis.verdict == Verdict::missing_effect) < 2, diagnosis.headline);
    if (contains(diagnosis.headline, "waves are only the first terms of another shape")) ++told;
  }
  CHECK(told >= 3);
}

TEST_CASE("a wave whose size changes a little along the travel is named, one that grows from nothing is not") {
  const auto found_with = [](double change) {
    return diagnosed(straight(), measured({.step_mm = 10.0, .targets = 101}, kNoise_um, [=](const Reading& r) {
                       const double u = p(r) / 500.0 - 1.0;  // -1 to 1
                       return 8.0 * (1.0 + change * u) * std::sin(2.0 * std::numbers::pi * p(r) / 90.0);
                     }));
  };
  const Diagnosis steady = found_with(0.3);
  CHECK(steady.verdict == Verdict::partly_explained);
  REQUIRE(count_named(steady) == 1);
  CHECK(to_text(steady.candidates.front().effect) == "cyclic:X:EX");
  CHECK(steady.candidates.front().parameters.front().value == Approx(90.0).epsilon(0.01));
  const Diagnosis growing = found_with(1.0);
  CHECK(growing.verdict == Verdict::unexplained_structure);
  CHECK(count_named(growing) == 0);
}

TEST_CASE("readings of unknown approach at the beginning of runs judge no lost motion") {
  laser::MeasurementSet set = measured({.runs = 5}, kNoise_um, [](const Reading& r) { return 3.0 * d(r); });
  int run = 0;
  for (Reading& r : set.readings)
    if (r.run != std::exchange(run, r.run)) r.approach = Approach::unknown;
  const Diagnosis found = diagnosed(straight(), set);
  CHECK(found.verdict == Verdict::missing_effect);
  REQUIRE(count_named(found) == 1);
  CHECK(to_text(found.candidates.front().effect) == "backlash:X:EX");
  CHECK(found.candidates.front().parameters.front().value == Approx(6.0).epsilon(0.02));
  CHECK(found.outliers.empty());
}

TEST_CASE("a jump of all readings between two of four runs is no drift, and no run is blamed for it") {
  const Diagnosis found =
      diagnosed(straight(), measured({.runs = 4}, kNoise_um, [](const Reading& r) { return r.run >= 3 ? 9.0 : 0.0; }));
  CHECK(found.verdict == Verdict::unexplained_structure);
  CHECK(count_named(found) == 0);
  CHECK_MESSAGE(found.headline.starts_with("All readings rise by 9 um between runs 2 and 3"), found.headline);
}

TEST_CASE("an adequate model lists the closest candidates with their probability, none of them named") {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Diagnosis found = diagnosed(straight(), measured({}, kNoise_um, nothing, seed));
    CHECK(found.verdict == Verdict::adequate);
    CHECK_FALSE(found.candidates.empty());
    CHECK(count_named(found) == 0);
    double sum = 0.0;
    for (const Candidate& candidate : found.candidates) {
      CHECK(candidate.probability > 0.0);
      sum += candidate.probability;
    }
    CHECK(sum < 1.0);  // the rest is that nothing is missing
  }
}

TEST_CASE("a slope that is missing beside a wave of free period is reported as the slope") {
  Model model;
  model.effects = {effect(effects::offset, Axis::X, Sense::EX), effect(effects::cyclic, Axis::X, Sense::EX)};
  for (unsigned seed = 1; seed <= 3; ++seed) {
    const Diagnosis found = diagnosed(model, measured(
                                                 {}, kNoise_um,
                                                 [](const Reading& r) {
                                                   return 1.5 * std::sin(2.0 * std::numbers::pi * p(r) / 87.3) +
                                                          6.0 * (p(r) / 1000.0 - 0.5);
                                                 },
                                                 seed));
    CHECK(found.verdict == Verdict::missing_effect);
    REQUIRE_FALSE(found.candidates.empty());
    CHECK(count_named(found) == 1);
    const Candidate& first = found.candidates.front();
    CHECK(to_text(first.effect) == "scale:X:EX");
    REQUIRE(first.parameters.front().sigma);
    CHECK(std::abs(first.parameters.front().value - 6.0) < 4.0 * *first.parameters.front().sigma);
  }
}

TEST_CASE("what is shown of any candidate stays inside its limits") {
  Model model = straight();
  model.effects.push_back(effect(effects::cyclic, Axis::X, Sense::EX));
  model.effects.push_back(effect(effects::warm_up, Axis::X, Sense::EX));
  auto set = measured({}, kNoise_um, [](const Reading& r) {
    return 20.0 * std::pow(p(r) / 1000.0 - 0.5, 2) + 4.0 * *r.time_s / 3600.0 + d(r);
  });
  double longest_mm = 0.0, session_s = 0.0;
  for (Reading& r : set.readings) {
    r.travel_since_reversal_mm = d(r) > 0.0 ? p(r) + 6.0 : 1006.0 - p(r);
    longest_mm = std::max(longest_mm, *r.travel_since_reversal_mm);
    session_s = std::max(session_s, *r.time_s);
  }
  for (const Model& base : {straight(), model})
    for (const Candidate& candidate : diagnosed(base, set).candidates)
      for (const ParameterEstimate& parameter : candidate.parameters) {
        CAPTURE(to_text(candidate.effect));
        if (parameter.name == "period_mm") CHECK(parameter.value <= 505.0);  // half of the travel
        if (parameter.name == "tau_s") CHECK(parameter.value <= session_s * 1.001);
        if (parameter.name == "u0_mm") CHECK(parameter.value <= 0.501 * longest_mm);
      }
}

TEST_CASE(
    "a drift seen in one run is at most likely, and the answer says if a wandering zero explains it nearly as well") {
  const auto looked_at = [](double um_per_s, unsigned seed) {
    return diagnosed(straight(), measured(
                                     {.step_mm = 60.0, .targets = 9, .runs = 1}, 0.3,
                                     [&](const Reading& r) { return um_per_s * *r.time_s; }, seed));
  };
  int told = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Diagnosis clear = looked_at(0.03, seed), weak = looked_at(0.012, seed);
    CHECK_MESSAGE(clear.verdict == Verdict::likely_effect, clear.headline);
    CHECK_MESSAGE((weak.verdict == Verdict::likely_effect || weak.verdict == Verdict::cannot_tell), weak.headline);
    if (contains(weak.headline, "a zero that wanders without any law explains the same nearly as well")) ++told;
  }
  CHECK(told > 5);
}

TEST_CASE("a curve of seven targets measured twice is likely, though no half of them shows all of it") {
  const Plan few{.step_mm = 150.0, .targets = 7, .runs = 2, .both_ways = false};
  const auto bends = [](const Reading& r) {
    constexpr double um[] = {-2.2, -0.1, 4.1, 1.7, -1.8, -2.9, 1.3};
    return um[std::lround(p(r) / 150.0)];
  };
  for (const unsigned seed : {1U, 2U, 3U, 4U, 5U}) {
    const Diagnosis found = diagnosed(straight(), measured(few, 0.3, bends, seed));
    CHECK_MESSAGE(found.verdict == Verdict::likely_effect, found.headline);
    REQUIRE_FALSE(found.candidates.empty());
    CHECK_MESSAGE(contains(found.headline, "progressive:X:EX"), found.headline);
  }
}

TEST_CASE("a curve of nine targets that no half of them shows is likely, or errors of single targets are the reason") {
  const Plan few{.step_mm = 60.0, .targets = 9, .runs = 2, .both_ways = false};
  const auto bends = [](const Reading& r) {
    constexpr double um[] = {7.3, -7.6, 0.7, 0.6, -4.6, -2.6, 9.5, -0.4, -3.0};
    return um[std::lround(p(r) / 60.0)];
  };
  Model level;
  level.effects = {effect(effects::offset, Axis::X, Sense::EX)};
  for (const unsigned seed : {1U, 2U, 3U, 4U, 5U}) {
    const Diagnosis found = diagnosed(level, measured(few, 0.5, bends, seed));
    CHECK_MESSAGE((found.verdict == Verdict::likely_effect || contains(found.headline, "errors of single targets")),
                  found.headline);
  }
}

TEST_CASE("a free curve of the model follows a smooth error of nine degrees at thirteen targets") {
  const auto bends = [](const Reading& r) {
    double sum = 0.0;
    for (std::size_t order = 1; order <= 8; ++order) sum += 1.5 * smooth_shape(order, p(r) / 960.0);
    return sum;
  };
  Model bent = straight();
  bent.effects.push_back(effect(effects::progressive, Axis::X, Sense::EX));
  for (const unsigned seed : {1U, 2U, 3U}) {
    const Diagnosis found = diagnosed(bent, measured({.step_mm = 80.0, .targets = 13, .runs = 5}, 0.2, bends, seed));
    CHECK_MESSAGE(found.verdict == Verdict::adequate, found.headline);
  }
}

TEST_CASE("a machine that warms up since the first line explains the drift of a line that was read last") {
  const auto warming = [](const Reading& r) {
    return r.sense == Sense::EY ? 300.0 * -std::expm1(-*r.time_s / 2500.0) : 0.0;
  };
  Model model{.effects = {effect(effects::offset, Axis::X, Sense::EX), effect(effects::offset, Axis::X, Sense::EY),
                          effect(effects::warm_up, Axis::X, Sense::EY)}};
  for (const unsigned seed : {1U, 2U, 3U}) {
    auto set = measured({.runs = 8}, kNoise_um, warming, seed);
    measure(set, {.sense = Sense::EY, .targets = 21, .runs = 1}, 0.1, warming, seed + 10);
    const Diagnosis found = diagnosed(model, set);
    CHECK_MESSAGE(found.verdict == Verdict::adequate, found.headline);
  }
}

TEST_CASE("an angle that acts through one lever is one cause, and a note says that a slope and a curve look the same") {
  Plan off_the_line;
  off_the_line.parked_mm = {0.0, -300.0, -500.0};
  const auto set = measured(off_the_line, kNoise_um, [](const Reading& r) {
    return 30.0 * p(r) / 1000.0 + std::sin(3.0 * p(r) / 1000.0) + std::cos(7.0 * p(r) / 1000.0);
  });
  Model level;
  level.effects = {effect(effects::offset, Axis::X, Sense::EX)};
  const Diagnosis found = diagnosed(level, set);
  CHECK(found.verdict == Verdict::missing_effect);
  REQUIRE(count_named(found) == 1);
  CHECK(found.candidates.front().effect.traits().keeps_slope);
  CHECK(std::ranges::count_if(found.notes, [](const std::string& note) {
          return contains(note, "a scale error and a smooth error");
        }) == 1);
}

TEST_CASE("a curve that explains as much alone as beside a wave is one cause") {
  struct Shape {
    std::array<double, 3> size_um, phase_rad;  // of one, one and a half and two waves over the travel
  };
  Model level;
  level.effects = {effect(effects::offset, Axis::X, Sense::EX), effect(effects::scale, Axis::X, Sense::EX)};
  for (const Shape& shape : {Shape{{-8.0, 1.6, -8.3}, {4.9, 4.5, 5.8}}, Shape{{7.0, -6.5, -7.9}, {5.4, 4.0, 3.5}},
                             Shape{{12.5, 5.2, 4.8}, {2.0, 5.9, 5.0}}, Shape{{15.7, 5.0, -4.8}, {3.7, 4.9, 5.5}}}) {
    const auto truth = [&](const Reading& r) {
      double sum = 0.0;
      for (std::size_t k = 0; k < shape.size_um.size(); ++k)
        sum += shape.size_um[k] *
               std::cos(std::numbers::pi * (static_cast<double>(k) + 2.0) * p(r) / 1000.0 + shape.phase_rad[k]);
      return sum;
    };
    const Diagnosis found = diagnosed(level, measured({}, kNoise_um, truth));
    REQUIRE_MESSAGE(count_named(found) == 1, found.headline);
    CHECK(to_text(found.candidates.front().effect) == "progressive:X:EX");
  }
}

TEST_CASE("a curve beside an effect that is nearly a slope is two causes, though one angle is nearly both") {
  Plan off_the_line;
  off_the_line.parked_mm = {0.0, -300.0, -500.0};
  const auto truth = [](const Reading& r) {
    const double m = p(r) / 1000.0, from_middle = m - 0.5;  // even about the middle: without a slope
    return 2.0 * std::cos(7.0 * from_middle) + 1.5 * std::cos(13.0 * from_middle) + 2.0 * d(r) +
           4.0 * (r.sensors_degC.at("t_material_degC") - 20.0) * m;
  };
  const auto hardly_warmer = [](Reading& r) {
    r.sensors_degC["t_material_degC"] = 22.0 + 0.1 * std::sin(*r.time_s / 500.0);
  };
  Model level;
  level.effects = {effect(effects::offset, Axis::X, Sense::EX)};
  const Diagnosis found = diagnosed(level, session(off_the_line, truth, hardly_warmer));
  CHECK_MESSAGE(found.verdict == Verdict::missing_effect, found.headline);
  std::vector<std::string> names;
  for (const Candidate& one : found.candidates)
    if (one.named) names.push_back(to_text(one.effect));
  std::ranges::sort(names);
  CHECK(fmt::format("{}", fmt::join(names, " ")) == "backlash:X:EX progressive:X:EX thermal_scale:X:EX");
}

TEST_CASE("a free wave takes much of the noise of few readings: noise alone rarely names an effect beside it") {
  Model model;
  model.effects = {effect(effects::offset, Axis::X, Sense::EX), effect(effects::cyclic, Axis::X, Sense::EX)};
  int told = 0;
  for (unsigned seed = 1; seed <= 100; ++seed) {
    const auto wave = [](const Reading& r) { return 30.0 * std::sin(2.0 * std::numbers::pi * p(r) / 156.0); };
    const Diagnosis found = diagnosed(model, measured({.step_mm = 60.0, .targets = 7, .runs = 1}, 1.7, wave, seed));
    if (found.verdict != Verdict::adequate && found.verdict != Verdict::cannot_tell) ++told;
  }
  CHECK(told <= 5);
}

TEST_CASE("a wave in a line that was read once is found beside positions that were repeated, as it is alone") {
  const auto wave = [](const Reading& r) {
    return d(r) > 0.0 ? 5.8 * std::sin(2.0 * std::numbers::pi * p(r) / 770.0 + 0.3) : 0.0;
  };
  for (unsigned seed = 1; seed <= 6; ++seed) {
    laser::MeasurementSet set;
    measure(set, {.step_mm = 200.0, .targets = 14, .runs = 3}, 0.5, nothing, seed);
    measure(set, {.sense = Sense::EY, .step_mm = 200.0, .targets = 14, .runs = 1}, 0.3, wave, seed + 100);
    const Diagnosis found = diagnosed(usual_model(set, mill()), set);
    CAPTURE(found.headline);
    CHECK(found.verdict == Verdict::missing_effect);
    CHECK(count_named(found) == 1);
    REQUIRE_FALSE(found.candidates.empty());
    CHECK(to_text(found.candidates.front().effect) == "cyclic:X:EY");
  }
}

TEST_CASE(
    "readings at targets that are their own means show how well a position repeats, and nothing about its error") {
  Model model;
  model.effects = {effect(effects::offset, Axis::X, Sense::EX), effect(effects::scale, Axis::X, Sense::EX)};
  laser::MeasurementSet set = measured(
      {.step_mm = 60.0, .targets = 7, .runs = 5}, 1.7, [](const Reading&) { return 0.0; }, 3);
  CHECK(diagnosed(model, set).verdict == Verdict::adequate);
  std::map<std::pair<double, Approach>, std::pair<double, int>> sums;
  for (const Reading& one : set.readings) {
    auto& [sum, count] = sums[{p(one), one.approach}];
    sum += one.error;
    ++count;
  }
  for (Reading& one : set.readings)
    one.error -= sums[{p(one), one.approach}].first / sums[{p(one), one.approach}].second;
  const Diagnosis found = diagnosed(model, set);
  CHECK(found.verdict == Verdict::cannot_tell);
  CHECK_MESSAGE(contains(found.headline, "every target is the mean of its own readings"), found.headline);
}

TEST_CASE("passes that lie apart from each other are adequate for a map, and it is said that none corrects them") {
  int said = 0, adequate = 0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    CAPTURE(seed);
    const auto zero = [values = std::map<std::pair<int, Approach>, double>{},
                       random = std::mt19937_64(seed)](const Reading& r) mutable {
      NormalDraws normal;
      const auto [value, is_new] = values.try_emplace({r.run, r.approach}, 0.0);
      if (is_new) value->second = 6.0 * normal(random);
      return value->second;
    };
    const Diagnosis found =
        diagnosed(straight(), measured({.step_mm = 60.0, .targets = 6, .runs = 5}, 2.0, zero, seed));
    if (found.verdict != Verdict::adequate) continue;
    ++adequate;
    said += static_cast<int>(contains(found.headline, "Each pass has a zero of its own"));
  }
  CHECK(adequate >= 3);
  CHECK(said == adequate);
  const Diagnosis quiet = diagnosed(
      straight(), measured(
                      {.step_mm = 60.0, .targets = 6, .runs = 5}, 2.0, [](const Reading&) { return 0.0; }, 11));
  CHECK_FALSE(contains(quiet.headline, "Each pass has"));
}

TEST_CASE("of six readings a cause far above the noise is likely, and noise alone is too little to tell") {
  const Plan few{.step_mm = 300.0, .targets = 3, .runs = 1};
  int right = 0, named = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Diagnosis strong =
        diagnosed(straight(), measured(
                                  few, kNoise_um, [](const Reading& r) { return 15.0 * d(r); }, seed));
    right += static_cast<int>(strong.verdict == Verdict::likely_effect &&
                              to_text(strong.candidates.front().effect) == "backlash:X:EX");
    const Diagnosis quiet = diagnosed(straight(), measured(few, kNoise_um, nothing, seed));
    CHECK(quiet.verdict != Verdict::unexplained_structure);
    named += static_cast<int>(quiet.verdict != Verdict::cannot_tell);
  }
  CHECK(right >= 15);
  CHECK(named <= 1);
}

TEST_CASE("of one pass each way with a strong wave in one of them the wave is likely, and noise alone names little") {
  const Plan one_run{.step_mm = 60.0, .targets = 9, .runs = 1};
  const auto wave = [](const Reading& r) {
    return d(r) > 0.0 ? 4.0 * std::sin(2.0 * std::numbers::pi * p(r) / 160.0) : 0.0;
  };
  unsigned found = 0, false_names = 0;
  for (unsigned seed = 1; seed <= 50; ++seed) {
    for (const Candidate& one : diagnosed(straight(), measured(one_run, 0.5, wave, seed)).candidates)
      if (one.in_answer() && one.effect.id == effects::cyclic) ++found;
    const Diagnosis noise = diagnosed(straight(), measured(one_run, 0.5, nothing, seed));
    if (std::ranges::any_of(noise.candidates, &Candidate::in_answer)) ++false_names;
  }
  CHECK(found >= 40);
  CHECK(false_names <= 2);
}

TEST_CASE(
    "beside a free wave on ten targets that were read once, noise is rarely taken for a curve that takes all of it") {
  Model model = straight();
  model.effects.push_back(effect(effects::cyclic, Axis::X, Sense::EX));
  unsigned named = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    const auto set = measured({.step_mm = 90.0, .targets = 10, .runs = 1, .both_ways = false}, 0.8, nothing, seed);
    if (std::ranges::any_of(diagnosed(model, set).candidates, &Candidate::in_answer)) ++named;
  }
  CHECK(named <= 3);
}

TEST_CASE("a drift over the visits that held-out visits do not confirm is not adequate") {
  int adequate = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Diagnosis found = diagnosed(straight(), measured(
                                                      {.step_mm = 200.0, .targets = 4, .runs = 6, .both_ways = false},
                                                      1.0, [](const Reading& r) { return 1.2 * r.run; }, seed));
    adequate += static_cast<int>(found.verdict == Verdict::adequate);
  }
  CHECK(adequate <= 2);
}

TEST_CASE("zeros of four parallel lines are these zeros and no angle of another carriage") {
  int complete = 0;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    std::mt19937_64 random(seed);
    NormalDraws zero(0.0, 8.0);
    laser::MeasurementSet set;
    for (const Vector3& parked_mm : {Vector3{}, Vector3{0, 800, 0}, Vector3{0, 0, 600}, Vector3{0, 800, 600}})
      measure(
          set, {.step_mm = 50.0, .targets = 21, .parked_mm = parked_mm}, kNoise_um,
          [zero_um = zero(random)](const Reading&) { return zero_um; }, seed);
    const Diagnosis found = diagnosed(straight(), set);
    complete += static_cast<int>(found.verdict == Verdict::missing_effect);
    for (const Candidate& one : found.candidates)
      if (one.named) CHECK_MESSAGE(contains(to_text(one.effect), "offset:X:EX"), to_text(one.effect));
  }
  CHECK(complete >= 4);
}

TEST_CASE("at even targets, written to a tenth of a millimetre, a worn zone is no wave shorter than two steps") {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    laser::MeasurementSet set =
        measured({.step_mm = 1000.0 / 26.0, .targets = 27, .runs = 4}, kNoise_um, nothing, seed);
    const double middle_mm = 150.0 + 60.0 * seed, width_mm = 40.0 + 10.0 * seed;
    for (laser::Reading& r : set.readings) {
      r.position_mm[0] = 0.1 * std::round(10.0 * r.position_mm[0]);
      r.error += 3.0 * std::exp(-0.5 * std::pow((p(r) - middle_mm) / width_mm, 2));
    }
    for (const Candidate& one : diagnosed(straight(), set).candidates) {
      const auto period = one.effect.traits().periodic ? searched_value(one.effect) : std::nullopt;
      if (one.in_answer() && period) CHECK_MESSAGE(*period > 2000.0 / 26.0, to_text(one.effect));
    }
  }
}

TEST_CASE(
    "at even targets on whole pitches a bow and a lost motion are these, not the harmonic of a wave of the pitch") {
  const auto truth = [](const Reading& r) {
    const double m = p(r) / 1000.0;
    return 20.0 * m * m - 8.0 * m * m * m + 2.0 * d(r) * std::sin(6.0 * m);
  };
  for (const unsigned seed : {1U, 2U}) {
    auto set = measured({.sense = Sense::EY, .targets = 21}, kNoise_um, nothing, seed);
    for (Reading& r : set.readings) {
      r.position_mm[0] = 25.0 * std::round(r.position_mm[0] / 25.0);
      r.error += truth(r);
    }
    const Diagnosis found = diagnosed(straight(Axis::X, Sense::EY), set);
    CHECK_MESSAGE(found.verdict == Verdict::missing_effect, found.headline);
    for (const Candidate& one : found.candidates)
      CHECK_FALSE_MESSAGE((one.in_answer() && one.effect.traits().periodic), found.headline);
  }
}

TEST_CASE("a lost motion is likely, not proved, if drifts beside it are no better than a zero of each pass") {
  const Eigen::MatrixXd zeros_um = ecs::test::normal_matrix(3, 2, 1);
  const auto set = measured({.targets = 29, .runs = 2}, kNoise_um,
                            [&](const Reading& r) { return 1.2 * d(r) + zeros_um(r.run, d(r) > 0.0 ? 1 : 0); });
  const Diagnosis found = diagnosed(straight(), set);
  CHECK(found.verdict == Verdict::likely_effect);
  REQUIRE_FALSE(found.candidates.empty());
  CHECK(to_text(found.candidates.front().effect) == "backlash:X:EX");
  CHECK_MESSAGE(found.candidates.front().standing == Standing::likely, found.headline);
}
