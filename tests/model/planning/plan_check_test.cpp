#include <numbers>

#include "model/planning/next_measurement.hpp"
#include "tests/model/support/measured_lines.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;
using namespace ecs::model::test::effects;

namespace {

bool says(const PlanCheck& check, const char* text) {
  return std::any_of(check.undetermined.begin(), check.undetermined.end(),
                     [&](const std::string& each) { return contains(each, text); });
}

}  // namespace

TEST_CASE("before measuring: the sigma of each parameter from textbook formulas") {
  const auto set = measured({.targets = 11, .runs = 2}, 0.0, nothing);
  Model model = straight();
  model.effects.push_back(effect(backlash, Axis::X, Sense::EX));
  const auto check = must(check_plan(model, observations_of(set, model, mill()), 0.5));
  CHECK(check.determines);
  CHECK(check.undetermined.empty());
  double sum = 0.0, square = 0.0;
  const double n = static_cast<double>(set.readings.size());
  for (const auto& r : set.readings) {
    sum += p(r) / 1000.0;
    square += std::pow(p(r) / 1000.0, 2);
  }
  const double spread = square - sum * sum / n;
  CHECK(*check.effects[1].parameters[0].sigma == Approx(0.5 / std::sqrt(spread)).epsilon(1e-9));
  CHECK(*check.effects[0].parameters[0].sigma == Approx(0.5 * std::sqrt(square / n / spread)).epsilon(1e-9));
  CHECK(*check.effects[2].parameters[0].sigma == Approx(2.0 * 0.5 / std::sqrt(n)).epsilon(1e-9));
}

TEST_CASE("before measuring: what a plan cannot determine is named with what it collides with") {
  auto set = measured({}, 0.0, nothing);
  for (auto& r : set.readings) {
    r.sensors_degC["t_material_degC"] = 22.0;
    r.feed_mm_min = 2000.0;
  }
  Model model = straight();
  model.effects.push_back(effect(thermal_scale, Axis::X, Sense::EX));
  model.effects.push_back(effect(load, Axis::X, Sense::EX));
  model.effects.push_back(effect(offset, Axis::Y, Sense::EY));
  const auto check = must(check_plan(model, observations_of(set, model, mill()), 0.5));
  CHECK_FALSE(check.determines);
  CHECK(says(check, "thermal_scale:X:EX cannot be distinguished from scale:X:EX"));
  CHECK(says(check, "load:X:EX: the plan lacks load_kg"));
  CHECK(says(check, "offset:Y:EY: the plan does not show it"));
  CHECK_FALSE(says(check, "offset:X:EX"));
  CHECK(check.effects[0].parameters[0].sigma);
  CHECK_FALSE(check.effects[1].parameters[0].sigma);
}

TEST_CASE("before measuring: nonlinear parameters and curves, as accurate as a fit then finds them") {
  Plan plan{.step_mm = 25.0};
  Model model = straight();
  model.effects.push_back(effect(cyclic, Axis::X, Sense::EX));
  model.effects[2].fitted = {
      {"period_mm", 90.0}, {"amplitude_um", 2.0}, {"phase_rad", 0.4}, {"amplitude2_um", 0.0}, {"phase2_rad", 0.0}};
  model.effects[2].parameters = {{"amplitude2_um", 0.0}};
  const auto empty = measured(plan, 0.0, nothing);
  const auto check = must(check_plan(model, observations_of(empty, model, mill()), kNoise_um));
  CHECK(check.determines);
  const auto of = [](const std::vector<ParameterEstimate>& list, const char* name) {
    return *std::find_if(list.begin(), list.end(), [&](const auto& e) { return e.name == name; });
  };
  const auto& expected = check.effects[2].parameters;
  REQUIRE(of(expected, "period_mm").sigma);
  // what simulated measurements scatter by
  double sum = 0.0, square = 0.0;
  constexpr int kTrials = 40;
  for (unsigned seed = 1; seed <= kTrials; ++seed) {
    const auto set = measured(
        plan, kNoise_um, [](const Reading& r) { return 2.0 * std::sin(2.0 * std::numbers::pi * p(r) / 90.0 + 0.4); },
        seed);
    const auto result = must(fit(model, observations_of(set, model, mill())));
    const double period = of(result.effects[2].parameters, "period_mm").value;
    sum += period;
    square += period * period;
  }
  const double scatter = std::sqrt((square - sum * sum / kTrials) / (kTrials - 1));
  CHECK(*of(expected, "period_mm").sigma == Approx(scatter).epsilon(0.35));

  Model curve = straight();
  curve.effects.push_back(effect(progressive, Axis::X, Sense::EX));
  const auto of_curve = must(check_plan(curve, observations_of(empty, curve, mill()), kNoise_um));
  CHECK(of_curve.determines);
  const auto& rms = of_curve.effects[2].parameters.front();
  REQUIRE(rms.sigma);
  // 14 functions on 246 readings: the mean variance of a fitted value is 14/246 of the noise's
  CHECK(*rms.sigma == Approx(kNoise_um * std::sqrt(14.0 / 246.0)).epsilon(0.1));
}

TEST_CASE("before measuring: a model without values is judged at values that are reported") {
  const auto set = measured({}, 0.0, nothing);
  Model model = straight();
  model.effects.push_back(effect(warm_up, Axis::X, Sense::EX));
  const auto check = must(check_plan(model, observations_of(set, model, mill()), 0.5));
  CHECK(check.assumed.size() == 2);
  CHECK(contains(check.assumed.front(), "tau_s"));
  CHECK(check.effects[2].parameters.front().sigma);
  CHECK_FALSE(check_plan(model, observations_of(set, model, mill()), 0.0));
}

TEST_CASE("before measuring: an angle through its lever, alone and beside an offset on one line") {
  Plan plan{.sense = Sense::EY, .parked_mm = {0.0, 0.0, 400.0}};
  auto set = measured(plan, 0.0, nothing);
  Model model;
  EffectInstance roll{.id = angular, .axis = Axis::X, .code = Component::EAX};
  model.effects = {roll};
  const auto alone = must(check_plan(model, observations_of(set, model, mill()), kNoise_um));
  CHECK(alone.determines);
  REQUIRE(alone.effects[0].parameters.front().sigma);
  // mean, slope and 14 functions on 246 readings, seen through 0.4 m
  CHECK(*alone.effects[0].parameters.front().sigma == Approx(kNoise_um * std::sqrt(16.0 / 246.0) / 0.4).epsilon(0.1));

  model.effects.push_back(effect(offset, Axis::X, Sense::EY));
  const auto beside = must(check_plan(model, observations_of(set, model, mill()), kNoise_um));
  CHECK_FALSE(beside.determines);
  CHECK((says(beside, "offset:X:EY cannot be distinguished from angular:X:EAX") ||
         says(beside, "angular:X:EAX cannot be distinguished from offset:X:EY")));

  plan.parked_mm[2] = 900.0;  // a second line tells the two apart
  measure(set, plan, 0.0, nothing);
  CHECK(must(check_plan(model, observations_of(set, model, mill()), kNoise_um)).determines);
}

TEST_CASE("before measuring: a cyclic error on targets that lie at its own period is not determined") {
  Plan plan;
  auto set = measured(plan, 0.0, nothing);
  for (auto& r : set.readings) r.position_mm[0] = 10.0 * std::round(p(r) / 10.0);
  Model model = straight();
  model.effects.push_back(effect(cyclic, Axis::X, Sense::EX));
  model.effects[2].parameters = {{"period_mm", 10.0}, {"amplitude2_um", 0.0}};
  const auto blind = must(check_plan(model, observations_of(set, model, mill()), kNoise_um));
  CHECK_FALSE(blind.determines);
  CHECK(says(blind, "cyclic:X:EX"));
  model.effects[2].parameters["period_mm"] = 37.0;
  const auto seeing = must(check_plan(model, observations_of(set, model, mill()), kNoise_um));
  CHECK(seeing.determines);
  // amplitude over n readings: σ·sqrt(2/n)
  for (const auto& parameter : seeing.effects[2].parameters)
    if (parameter.name == "amplitude_um")
      CHECK(*parameter.sigma == Approx(kNoise_um * std::sqrt(2.0 / 246.0)).epsilon(0.15));
}

TEST_CASE("before measuring: a formula of the user, with a parameter that is not a factor") {
  Model model = straight();
  EffectInstance own{.id = user,
                     .axis = Axis::X,
                     .sense = Sense::EX,
                     .name = "decay",
                     .formulas = {{Sense::EX, "a*exp(-p_mm/l)"}},
                     .user = {{"a", "um", {}, 4.0, {}, {}}, {"l", "mm", {}, 200.0, 10.0, 2000.0}}};
  model.effects.push_back(own);
  const auto set = measured({}, 0.0, nothing);
  const auto check = must(check_plan(model, observations_of(set, model, mill()), kNoise_um));
  CHECK(check.determines);
  for (const auto& parameter : check.effects[2].parameters) {
    REQUIRE(parameter.sigma);
    CHECK(*parameter.sigma > 0.0);
  }
  Model twice = model;  // the same formula under another name collides
  twice.effects.push_back(own);
  twice.effects[3].name = "again";
  CHECK_FALSE(must(check_plan(twice, observations_of(set, twice, mill()), kNoise_um)).determines);
}

TEST_CASE("before measuring: the readings of the plan do not count") {
  Model model = straight();
  model.effects.push_back(effect(backlash, Axis::X, Sense::EX));
  const auto none = must(check_plan(model, observations_of(measured({}, 0.0, nothing), model, mill()), kNoise_um));
  const auto wild = must(
      check_plan(model, observations_of(measured({}, 50.0, [](const Reading& r) { return 9.0 * d(r); }), model, mill()),
                 kNoise_um));
  for (std::size_t i = 0; i < 3; ++i)
    CHECK(*none.effects[i].parameters[0].sigma == Approx(*wild.effects[i].parameters[0].sigma));
  CHECK_FALSE(check_plan(model, Observations{}, kNoise_um));
}
