#include "model/fit/core.hpp"

#include <array>
#include <numbers>

#include <rapidcheck.h>

#include "tests/model/support/measured_lines.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;
using namespace ecs::model::test::effects;

namespace {

double range_over(const std::vector<double>& values) {
  const auto [least, greatest] = std::minmax_element(values.begin(), values.end());
  return *greatest - *least;
}

/// Offset, slope and a wave so long that it is a parabola: the three cancel each other.
Model with_long_wave(double period_mm) {
  Model model = straight();
  model.effects.push_back(effect(cyclic, Axis::X, Sense::EX));
  model.effects.back().parameters["period_mm"] = period_mm;
  return model;
}

/// Fitted with the searched parameter of one more effect free, from a start far outside its limits where one is given.
double searched_value(EffectId id, const laser::MeasurementSet& set, std::optional<double> start = {},
                      Model model = straight()) {
  model.effects.push_back(effect(id, Axis::X, Sense::EX));
  const std::string name(model.effects.back().definition().searched_parameter());
  if (start) model.effects.back().fitted[name] = *start;
  const auto found = must(fit(model, observations_of(set, model, mill())));
  for (const ParameterEstimate& one : found.effects.back().parameters)
    if (one.name == name) return one.value;
  return kNotMeasured;
}

laser::MeasurementSet with_travel_since_reversal(laser::MeasurementSet set) {
  for (Reading& r : set.readings) r.travel_since_reversal_mm = d(r) > 0.0 ? p(r) + 6.0 : 1006.0 - p(r);
  return set;
}

}  // namespace

TEST_CASE("terms that would cancel each other stay below three times the readings, and each is named as colliding") {
  CHECK(rc::check([] {
    const Model model = with_long_wave(1000.0 * *rc::gen::inRange(4, 60));
    const auto set = measured({}, kNoise_um, nothing, static_cast<unsigned>(*rc::gen::inRange(1, 1000)));
    const Observations data = observations_of(set, model, mill());
    const auto found = fit(model, data);
    RC_ASSERT(found.has_value());
    for (const EffectFit& one : found->effects)
      RC_ASSERT(range_over(one.contribution) <= 3.0 * range_over(data.reading));
    RC_ASSERT(found->rms_um < 1.2 * kNoise_um);
  }));
}

TEST_CASE("the terms of which the smallest sizes are taken are undetermined, each beside those it collides with") {
  const Model model = with_long_wave(40'000.0);
  const Observations data = observations_of(measured({}, kNoise_um, nothing), model, mill());
  const Regressors regressors(data);
  auto assembly = must(Assembly::of(model, regressors));
  const CoreFit core = fitted(assembly, regressors, {});
  CHECK(std::count(core.undetermined.begin(), core.undetermined.end(), true) >= 2);
  for (std::size_t j = 0; j < core.undetermined.size(); ++j) CHECK(core.undetermined[j] == !core.collides[j].empty());
  const auto told = must(fit(model, data));
  REQUIRE_FALSE(told.undetermined.empty());
  CHECK(contains(told.undetermined.front(), "cannot be distinguished from"));
}

TEST_CASE("terms that share little are fitted as they are, however large they are together") {
  Model model = straight();
  model.effects.push_back(effect(backlash, Axis::X, Sense::EX));
  const auto found = must(fit(
      model, observations_of(
                 measured({}, kNoise_um, [](const Reading& r) { return 1e3 + 500.0 * p(r) / 1000.0 + 200.0 * d(r); }),
                 model, mill())));
  CHECK(found.undetermined.empty());
}

TEST_CASE("a free period never passes half of the travel, whatever the readings and the former fit say") {
  const auto parabola = [](const Reading& r) { return 20.0 * std::pow(p(r) / 1000.0 - 0.5, 2); };
  const auto half_turn = [](const Reading& r) { return 5.0 * std::sin(std::numbers::pi * p(r) / 1000.0); };
  const auto set = measured({}, kNoise_um, parabola);
  double least = 1e9, greatest = -1e9;
  for (const Reading& r : set.readings) {
    least = std::min(least, p(r));
    greatest = std::max(greatest, p(r));
  }
  for (const Truth& truth : {Truth(parabola), Truth(half_turn), Truth(nothing)})
    for (const std::optional<double> start : {std::optional<double>(), std::optional(700.0), std::optional(1e5)})
      CHECK(searched_value(cyclic, measured({}, kNoise_um, truth), start) <= 0.5 * (greatest - least) * (1.0 + 1e-9));
}

TEST_CASE(
    "the period of a wave with a strong second harmonic is found on nine targets, where the first alone shows "
    "another") {
  constexpr std::array at_mm{259.506, 517.648, 753.17, 1035.544, 1320.928, 1621.269, 1874.977, 2083.297, 2378.14};
  constexpr double kPeriod_mm = 307.5;
  Model level;
  level.effects = {effect(offset, Axis::X, Sense::EX)};
  for (const unsigned seed : {1U, 2U, 3U}) {
    auto set = measured({.targets = 9, .runs = 2}, 0.1, nothing, seed);
    for (Reading& r : set.readings) {
      r.position_mm[0] = at_mm.at(static_cast<std::size_t>(std::lround(p(r) / 25.0)));
      const double turn = 2.0 * std::numbers::pi * (2610.0 - p(r)) / kPeriod_mm;
      r.error += 2.5 + 0.66 * std::sin(turn) + 6.57 * std::cos(turn) + 0.09 * std::sin(2.0 * turn) -
                 2.32 * std::cos(2.0 * turn);
    }
    CHECK(searched_value(cyclic, set, {}, level) == Approx(kPeriod_mm).epsilon(0.01));
  }
}

TEST_CASE("a time constant lies between a fiftieth of the session and the session") {
  const auto set = measured({}, kNoise_um, nothing);
  const double session_s = *set.readings.back().time_s - *set.readings.front().time_s;
  const auto creep = [](const Reading& r) { return 5.0 * *r.time_s / 3600.0; };
  const auto at_once = [&](const Reading& r) { return 4.0 * -std::expm1(-*r.time_s / (session_s / 500.0)); };
  for (const Truth& truth : {Truth(creep), Truth(at_once), Truth(nothing)})
    for (const std::optional<double> start : {std::optional<double>(), std::optional(1.0), std::optional(1e7)}) {
      const double tau_s = searched_value(warm_up, measured({}, kNoise_um, truth), start);
      CHECK(tau_s >= session_s / 50.0 * (1.0 - 1e-9));
      CHECK(tau_s <= session_s * (1.0 + 1e-9));
    }
}

TEST_CASE("a decay length lies between a third of the shortest travel since reversal and half of the longest") {
  const auto lost_at_once = [](const Reading& r) { return 2.0 * d(r); };
  const auto set = with_travel_since_reversal(measured({}, kNoise_um, lost_at_once));
  double shortest = 1e9, longest = 0.0;
  for (const Reading& r : set.readings) {
    shortest = std::min(shortest, *r.travel_since_reversal_mm);
    longest = std::max(longest, *r.travel_since_reversal_mm);
  }
  for (const Truth& truth : {Truth(lost_at_once), Truth(nothing)})
    for (const std::optional<double> start : {std::optional<double>(), std::optional(1e-4), std::optional(9900.0)}) {
      const double u0_mm =
          searched_value(reversal_spike, with_travel_since_reversal(measured({}, kNoise_um, truth)), start);
      CHECK(u0_mm >= shortest / 3.0 * (1.0 - 1e-9));
      CHECK(u0_mm <= 0.5 * longest * (1.0 + 1e-9));
    }
}

TEST_CASE("of periods that even targets cannot tell apart a fit keeps the one that it has") {
  auto set = measured({}, kNoise_um, nothing);
  for (Reading& r : set.readings) {  // every 25 mm: 8 and 200 mm are the same there
    r.position_mm[0] = 25.0 * std::round(p(r) / 25.0);
    r.error += 2.0 * std::sin(2.0 * std::numbers::pi * p(r) / 8.0);
  }
  CHECK(searched_value(cyclic, set, 8.0) == Approx(8.0).epsilon(0.001));
  CHECK(searched_value(cyclic, set, 200.0) == Approx(200.0).epsilon(0.01));
}

TEST_CASE("a fit moves no wave to twice its period because a harmonic more fits the noise better") {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const auto set = measured(
        {.step_mm = 50.0, .targets = 21}, kNoise_um,
        [](const Reading& r) {
          return 2.0 * std::sin(2.0 * std::numbers::pi * p(r) / 67.7) + std::sin(2.0 * std::numbers::pi * p(r) / 10.0);
        },
        seed);
    Model model = straight();
    for (const double period_mm : {67.7, 10.0}) {
      model.effects.push_back(effect(cyclic, Axis::X, Sense::EX));
      model.effects.back().fitted["period_mm"] = period_mm;
    }
    const auto found = must(fit(model, observations_of(set, model, mill())));
    CHECK(found.effects[2].effect.fitted.at("period_mm") == Approx(67.7).epsilon(0.01));
    CHECK(found.effects[3].effect.fitted.at("period_mm") == Approx(10.0).epsilon(0.01));
  }
}

TEST_CASE("terms that cancel each other keep sizes that the readings determine") {
  Model model = straight();
  model.effects.push_back(effect(sag, Axis::X, Sense::EX));
  model.effects.back().parameters["k3"] = 0.0;
  const auto set = measured({.from_mm = 2000.0, .step_mm = 15.0}, 0.05, [](const Reading& r) {
    const double p_m = p(r) / 1000.0;
    return 10.0 * p_m * p_m - 46.0 * p_m + 53.0;  // a bow of about 1 um of terms of 27 um
  });
  const auto found = must(fit(model, observations_of(set, model, mill())));
  const ParameterEstimate& square = found.effects.back().parameters.front();
  REQUIRE(square.sigma);
  CHECK(std::abs(square.value - 10.0) < 3.0 * *square.sigma);
  CHECK(found.rms_um < 0.06);
}
