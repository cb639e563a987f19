// Sigma of a decay length and its size by profile likelihood.
#include <numbers>
#include <random>

#include <Eigen/Dense>

#include "model/diagnosis/ladder.hpp"
#include "model/fit/compare.hpp"
#include "model/fit/compiled_model.hpp"
#include "model/fit/noise.hpp"
#include "model/planning/next_measurement.hpp"
#include "tests/model/support/measured_lines.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;
using namespace ecs::model::test::effects;

namespace {

const ParameterEstimate& parameter(const Fit& fit, std::size_t effect, const std::string& name) {
  for (const ParameterEstimate& each : fit.effects[effect].parameters)
    if (each.name == name) return each;
  throw std::runtime_error("no parameter " + name);
}

}  // namespace

TEST_CASE("a fit finds the values that the readings were made of, within three of its sigmas") {
  Model model = straight();
  model.effects.push_back(effect(backlash, Axis::X, Sense::EX));
  const auto set = measured({}, 0.3, [](const Reading& r) { return 2.0 + 14.0 * p(r) / 1000.0 + 1.5 * d(r); });
  const auto found = must(fit(model, observations_of(set, model, mill())));
  const auto near = [&](std::size_t i, const char* name, double truth) {
    const ParameterEstimate& estimate = parameter(found, i, name);
    REQUIRE(estimate.sigma);
    CHECK(std::abs(estimate.value - truth) < 3.0 * *estimate.sigma);
  };
  near(0, "um", 2.0);
  near(1, "um_per_m", 14.0);
  near(2, "um", 3.0);
  CHECK(found.rms_um == Approx(0.3).epsilon(0.15));
  CHECK(found.noise.noise_um == Approx(0.3).epsilon(0.15));
  CHECK(found.noise.from_repeats);
  CHECK(found.fitted_parameters == 3);
}

namespace {

/// Of runs 1 and 2, and of runs 3 and 4: noise, and what the file states of it.
laser::MeasurementSet of_two_qualities(double fine_um, double coarse_um, double stated_share, unsigned seed) {
  std::mt19937_64 random(seed);
  NormalDraws normal;
  auto set = measured({.runs = 4}, 0.0, [](const Reading& r) { return 2.0 + 14.0 * p(r) / 1000.0; });
  for (Reading& r : set.readings) {
    const double noise_um = r.run > 2 ? coarse_um : fine_um;
    r.error += noise_um * normal(random);
    if (stated_share > 0.0) r.extras["u_um"] = stated_share * noise_um;
  }
  return set;
}

double slope_error(double stated_share, unsigned seed) {
  const Model model = straight();
  const auto set = of_two_qualities(0.2, 2.0, stated_share, seed);
  return parameter(must(fit(model, observations_of(set, model, mill()))), 1, "um_per_m").value - 14.0;
}

}  // namespace

TEST_CASE("readings with a standard uncertainty each are fitted as a weighted least squares of one's own does it") {
  const auto set = of_two_qualities(0.3, 0.6, 1.0, 3);
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (const Reading& r : set.readings) {
    const double weight = 1.0 / std::pow(r.extras.at("u_um"), 2);
    const Eigen::Vector2d row(1.0, p(r) / 1000.0);
    normal += weight * row * row.transpose();
    right += weight * r.error * row;
  }
  const Eigen::Vector2d expected = normal.inverse() * right;
  const Model model = straight();
  const auto found = must(fit(model, observations_of(set, model, mill())));
  REQUIRE(found.noise_by_sense.front().correlated_um == 0.0);
  CHECK(parameter(found, 0, "um").value == Approx(expected(0)).epsilon(1e-9));
  CHECK(parameter(found, 1, "um_per_m").value == Approx(expected(1)).epsilon(1e-9));
  const Eigen::Matrix2d covariance = normal.inverse();  // the readings are as uncertain as the file states
  CHECK(*parameter(found, 1, "um_per_m").sigma == Approx(std::sqrt(covariance(1, 1))).epsilon(0.15));
}

TEST_CASE("where two runs scatter ten times as much as the others, stated uncertainties make the errors smaller") {
  double with = 0.0, without = 0.0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    with += std::pow(slope_error(1.0, seed), 2);
    without += std::pow(slope_error(0.0, seed), 2);
  }
  CHECK(std::sqrt(with) < std::sqrt(without) / 3.0);  // (0.04 + 4) / 4 against 1 / (1 / 0.04 + 1 / 4), a factor of 5
}

TEST_CASE(
    "only the ratios of stated uncertainties count: their size comes from the readings, and the fit says the factor") {
  const Model model = straight();
  const auto fitted_with = [&](double share) {
    return must(fit(model, observations_of(of_two_qualities(0.2, 2.0, share, 5), model, mill())));
  };
  const Fit right = fitted_with(1.0), small = fitted_with(1.0 / 3.0);
  CHECK(parameter(small, 1, "um_per_m").value == Approx(parameter(right, 1, "um_per_m").value).epsilon(1e-9));
  CHECK(*parameter(small, 1, "um_per_m").sigma == Approx(*parameter(right, 1, "um_per_m").sigma).epsilon(1e-9));
  const auto factor_of = [&](double share, const Fit& fit) {
    const Observations data = observations_of(of_two_qualities(0.2, 2.0, share, 5), model, mill());
    return must(stated_uncertainty(data, fit.residual, fit.noise.noise_um));
  };
  CHECK(factor_of(1.0, right).of_residual == Approx(1.0).epsilon(0.1));
  CHECK(factor_of(1.0, right).of_noise == Approx(1.0).epsilon(0.1));
  CHECK(factor_of(1.0 / 3.0, small).of_residual == Approx(3.0).epsilon(0.1));
  CHECK_MESSAGE(contains(small.notes.back(), "the residual is 2.9 times the stated uncertainties"), small.notes.back());
}

TEST_CASE("a period that is not given is found and has a sigma") {
  Model model = straight();
  model.effects.push_back(effect(cyclic, Axis::X, Sense::EX));
  const Plan plan{.step_mm = 3.0};
  const auto set =
      measured(plan, 0.2, [](const Reading& r) { return 3.0 * std::sin(2.0 * std::numbers::pi * p(r) / 12.7 + 0.4); });
  const auto found = must(fit(model, observations_of(set, model, mill())));
  CHECK(parameter(found, 2, "period_mm").value == Approx(12.7).epsilon(0.001));
  CHECK(std::abs(parameter(found, 2, "amplitude_um").value - 3.0) < 3.0 * *parameter(found, 2, "amplitude_um").sigma);
  CHECK(std::abs(parameter(found, 2, "phase_rad").value - 0.4) < 3.0 * *parameter(found, 2, "phase_rad").sigma);
}

TEST_CASE("a period far shorter than the distance of targets is found where it leaves nothing but noise") {
  Model model = straight();
  model.effects.push_back(effect(cyclic, Axis::X, Sense::EX));
  Plan plan;
  plan.step_mm = 60.0;  // 4.5 mm: 13 turns from one target to the next
  const Truth wave = [](const Reading& r) { return 3.0 * std::sin(2.0 * std::numbers::pi * p(r) / 4.5 + 0.4); };
  const auto found = must(fit(model, observations_of(measured(plan, 0.2, wave), model, mill())));
  CHECK(parameter(found, 2, "period_mm").value == Approx(4.5).epsilon(0.001));
  CHECK(found.rms_um < 0.25);
}

TEST_CASE("a step of the model is found at a negative position as well") {
  Model model = straight();
  model.effects.push_back(effect(effects::step, Axis::X, Sense::EX));
  const Truth step = [](const Reading& r) { return p(r) > -300.0 ? 3.0 : 0.0; };
  const auto found = must(fit(model, observations_of(measured({.from_mm = -1000.0}, 0.2, step), model, mill())));
  CHECK(parameter(found, 2, "position_mm").value == Approx(-300.0).epsilon(0.1));
  CHECK(parameter(found, 2, "height_um").value == Approx(3.0).epsilon(0.1));
}

TEST_CASE("a wave of the model does not take a step for a period far shorter than the distance of targets") {
  Model model = straight();
  model.effects.push_back(effect(cyclic, Axis::X, Sense::EX));
  const Truth both = [](const Reading& r) {
    return std::sin(2.0 * std::numbers::pi * p(r) / 200.0) + (p(r) > 1100.0 ? 6.0 : 0.0);
  };
  const auto found = must(fit(model, observations_of(measured({.step_mm = 60.0}, 0.2, both), model, mill())));
  CHECK(parameter(found, 2, "period_mm").value > 12.0);  // a fifth of the step of 60 mm
}

TEST_CASE("parameters that the file gives are held") {
  Model model = straight();
  model.effects[1].parameters["um_per_m"] = 10.0;
  const auto set = measured({}, 0.1, [](const Reading& r) { return 14.0 * p(r) / 1000.0; });
  const auto found = must(fit(model, observations_of(set, model, mill())));
  CHECK(parameter(found, 1, "um_per_m").value == 10.0);
  CHECK(parameter(found, 1, "um_per_m").held);
  CHECK(found.rms_um > 1.0);
}

TEST_CASE("gross errors are listed with their rows, weigh nothing, and stay in the rms") {
  auto set = measured({}, 0.2, [](const Reading& r) { return 5.0 * p(r) / 1000.0; });
  set.readings[17].error += 40.0;
  set.readings[120].error -= 25.0;
  const Model model = straight();
  const Observations data = observations_of(set, model, mill());
  const auto robust = must(fit(model, data));
  const auto plain = must(fit(model, data, {true}));
  CHECK(robust.outliers == std::vector<int>{18, 121});
  CHECK(plain.outliers.empty());
  CHECK(parameter(robust, 1, "um_per_m").value == Approx(5.0).epsilon(0.02));
  CHECK(robust.rms_um > 2.0);
}

TEST_CASE("terms that the data cannot tell apart are named, and nothing breaks") {
  Model model = straight();
  model.effects.push_back(effect(cosine, Axis::X, Sense::EX));
  const auto set = measured({}, 0.2, [](const Reading& r) { return -5.0 * p(r) / 1000.0; });
  const auto found = must(fit(model, observations_of(set, model, mill())));
  REQUIRE_FALSE(found.undetermined.empty());
  CHECK(contains(found.undetermined.front(), "cannot be distinguished from"));
  CHECK(found.rms_um == Approx(0.2).epsilon(0.2));
}

TEST_CASE("a user's formulas share their parameters across senses, linear or not") {
  Model model;
  EffectInstance user = effect(effects::user, Axis::X, Sense::EX);
  user.name = "tilt";
  user.formulas = {{Sense::EX, "a*sin(x_mm/b)"}, {Sense::EY, "2*a*cos(x_mm/b) + c"}};
  user.user = {{"a", "um", {}, {}, {}, {}}, {"b", "mm", {}, 130.0, 50.0, 500.0}, {"c", "um", {}, {}, {}, {}}};
  model.effects.push_back(user);
  laser::MeasurementSet set;
  Plan plan;
  measure(
      set, plan, 0.1, [](const Reading& r) { return 4.0 * std::sin(p(r) / 150.0); }, 1);
  plan.sense = Sense::EY;
  measure(
      set, plan, 0.1, [](const Reading& r) { return 8.0 * std::cos(p(r) / 150.0) - 3.0; }, 2);
  const auto found = must(fit(model, observations_of(set, model, mill())));
  CHECK(parameter(found, 0, "a").value == Approx(4.0).epsilon(0.01));
  CHECK(parameter(found, 0, "b").value == Approx(150.0).epsilon(0.002));
  CHECK(parameter(found, 0, "c").value == Approx(-3.0).epsilon(0.02));
}

namespace {

/// The formula of X positions with unknown parameters that have neither a start nor a range.
EffectInstance of_formula(const std::string& formula, const std::vector<std::string>& parameters) {
  EffectInstance user = effect(effects::user, Axis::X, Sense::EX);
  user.name = "mine";
  user.formulas = {{Sense::EX, formula}};
  for (const std::string& name : parameters) user.user.push_back({name, "", {}, {}, {}, {}});
  return user;
}

/// Sizes of its parameters, fitted beside offset and slope to readings with 0.2 um of noise.
std::vector<double> sizes_of(const EffectInstance& user, const Plan& plan, const Truth& truth) {
  Model model = straight();
  model.effects.push_back(user);
  const auto found = must(fit(model, observations_of(measured(plan, 0.2, truth), model, mill())));
  CHECK(found.rms_um < 0.24);
  std::vector<double> sizes;
  for (const UserParameter& each : user.user) sizes.push_back(parameter(found, 2, each.name).value);
  return sizes;
}

}  // namespace

TEST_CASE("parameters of a formula are found without starting values, over what the formula reads") {
  SUBCASE("a bump has its place and width") {
    const auto sizes = sizes_of(of_formula("k * exp(-((x_mm - c) / w)^2)", {"k", "c", "w"}), {},
                                [](const Reading& r) { return -9.0 * std::exp(-std::pow((p(r) - 672.0) / 45.0, 2)); });
    CHECK(sizes[0] == Approx(-9.0).epsilon(0.05));
    CHECK(sizes[1] == Approx(672.0).epsilon(0.01));
    CHECK(std::abs(sizes[2]) == Approx(45.0).epsilon(0.05));
  }
  SUBCASE("a threshold has its place") {
    const auto sizes = sizes_of(of_formula("x_mm > c ? k * (x_mm - c) : 0", {"k", "c"}), {.step_mm = 30.0},
                                [](const Reading& r) { return std::max(0.0, 0.02 * (p(r) - 700.0)); });
    CHECK(sizes[0] == Approx(0.02).epsilon(0.05));
    CHECK(sizes[1] == Approx(700.0).epsilon(0.05));
  }
  SUBCASE("a term that is constant from the first starting values on is not linear in them") {
    const auto sizes = sizes_of(of_formula("k * tanh((x_mm - c) / w)", {"k", "c", "w"}), {.step_mm = 30.0},
                                [](const Reading& r) { return 7.0 * std::tanh((p(r) - 500.0) / 120.0); });
    CHECK(std::abs(sizes[0]) == Approx(7.0).epsilon(0.1));
    CHECK(sizes[1] == Approx(500.0).epsilon(0.05));
  }
}

TEST_CASE("a stated range of a parameter does not hinder its fit") {
  EffectInstance bump = of_formula("k * exp(-((x_mm - c) / w)^2)", {"k", "c", "w"});
  bump.user[1] = {"c", "mm", {}, 300.0, 0.0, 1200.0};
  bump.user[2].start = 30.0;
  const auto sizes =
      sizes_of(bump, {}, [](const Reading& r) { return 9.0 * std::exp(-std::pow((p(r) - 672.0) / 45.0, 2)); });
  CHECK(sizes[1] == Approx(672.0).epsilon(0.01));
}

TEST_CASE("a formula with an unknown name is refused with the columns there are") {
  Model model;
  EffectInstance user = effect(effects::user, Axis::X, Sense::EX);
  user.name = "tilt";
  user.formulas = {{Sense::EX, "a*t_oil_degC"}};
  user.user = {{"a", "um", {}, {}, {}, {}}};
  model.effects.push_back(user);
  const auto set = measured({}, 0.1, nothing);
  CHECK(contains(to_text(must_fail(fit(model, observations_of(set, model, mill())))), "t_material_degC"));
}

TEST_CASE("a formula that assigns, or has no finite value at a reading, is refused with its words") {
  const auto refusal = [](const std::string& formula) {
    Model model;
    EffectInstance user = effect(effects::user, Axis::X, Sense::EX);
    user.name = "tilt";
    user.formulas = {{Sense::EX, formula}};
    user.user = {{"a", "um", {}, {}, {}, {}}};
    model.effects.push_back(user);
    const auto set = measured({}, 0.1, nothing);
    const auto found = fit(model, observations_of(set, model, mill()));
    return found ? std::string() : to_text(found.error());
  };
  for (const char* assigning : {"a=5", "a*p_mm + (a=5)", "sin(x_mm = 3)", "a += 1", "a *= p_mm", "a, x_mm = 2"})
    CHECK_MESSAGE(contains(refusal(assigning), "assignment"), assigning);
  CHECK(refusal("a*(p_mm <= -10 ? 1 : 0) + a*(p_mm == 0 ? 1 : p_mm != 3)").empty());
  for (const char* endless : {"a/0", "a*log(-1 - p_mm*p_mm)", "a*sqrt(-1)", "a*1e308*1e308*p_mm"})
    CHECK_MESSAGE(contains(refusal(endless), "expected a finite value at every reading"), endless);
  CHECK(contains(refusal("a/p_mm"), "reading"));
}

TEST_CASE("the comparison says in which direction and where the model fails") {
  const Model model = straight();
  const auto set = measured({}, 0.2, [](const Reading& r) { return 2.0 * d(r); });
  const Observations data = observations_of(set, model, mill());
  const auto found = must(fit(model, data));
  const Comparison where = compare(found, data);
  REQUIRE(where.directions.size() == 2);
  CHECK(where.directions[0].approach == 1);
  CHECK(where.directions[0].bias_um == Approx(2.0).epsilon(0.1));
  CHECK(where.directions[1].bias_um == Approx(-2.0).epsilon(0.1));
  CHECK(where.directions[0].readings == 123);
  for (const ResidualView& view : where.views)
    if (view.variable == "approach") CHECK(view.share > 0.95);
}

TEST_CASE("adding an effect lets the error fall, is remembered, and can be undone") {
  const Model model = straight();
  const auto set = measured({}, 0.2, [](const Reading& r) {
    return 3.0 * std::sin(2.0 * std::numbers::pi * p(r) / 160.0) + 6.0 * p(r) / 1000.0;
  });
  const Observations data = observations_of(set, model, mill());
  const auto added = must(add_effect(model, data, *parse_add_request("cyclic:X"), "x.csv"));
  CHECK(added.rms_before_um > 1.8);
  CHECK(added.rms_after_um == Approx(0.2).epsilon(0.15));
  CHECK(added.model.effects.back().fitted.at("period_mm") == Approx(160.0).epsilon(0.002));
  CHECK(*only(added.model.history).held_out_rms_um < 0.3);
  const auto back = must(undo(added.model));
  CHECK(back.effects.size() == 2);
  CHECK(back.history.empty());
  CHECK_FALSE(undo(back));
}

TEST_CASE("a fitted model predicts what it was fitted to, and compiles into its compensation") {
  Model model = straight();
  model.effects.push_back(effect(backlash, Axis::X, Sense::EX));
  model.effects.push_back(effect(time_drift, Axis::X, Sense::EX));
  const auto set = measured({}, 0.05, [](const Reading& r) { return 1.0 + 8.0 * p(r) / 1000.0 + 2.0 * d(r); });
  const Observations data = observations_of(set, model, mill());
  const auto found = must(fit(model, data));
  const Model with = with_values(model, found);
  const auto values = must(predicted(with, data));
  for (std::size_t k = 0; k < data.size(); ++k) CHECK(values[k] == Approx(found.predicted[k]).epsilon(1e-6));
  const auto map = must(compiled(with, mill(), 100.0));
  REQUIRE(map.map.tables.size() == 2);
  const laser::MapTable* forward = laser::table_of(map.map, Component::EXX, Approach::forward);
  REQUIRE(forward != nullptr);
  CHECK(laser::compensation_at(*forward, 500.0) == Approx(-7.0).epsilon(0.02));
  CHECK(contains(only(map.not_carried), "time_drift"));
}

TEST_CASE("whether a plan can determine a model is known before measuring") {
  Model model = straight();
  model.effects.push_back(effect(servo_lag, Axis::X, Sense::EX));
  model.effects.push_back(effect(backlash, Axis::X, Sense::EX));
  auto set = measured({}, 0.0, nothing);
  for (auto& r : set.readings) r.feed_mm_min = 2000.0;
  CHECK_FALSE(must(check_plan(model, observations_of(set, model, mill()), 0.5)).determines);
  for (auto& r : set.readings) r.feed_mm_min = r.run == 1 ? 500.0 : 4000.0;
  CHECK(must(check_plan(model, observations_of(set, model, mill()), 0.5)).determines);
}

TEST_CASE("the length of a spike that all readings see at one distance is not determined, at two distances it is") {
  Model model = straight();
  model.effects.push_back(effect(reversal_spike, Axis::X, Sense::EX));
  for (const bool two_distances : {false, true}) {
    CAPTURE(two_distances);
    auto set = measured({}, 0.1, nothing);
    std::size_t k = 0;
    for (Reading& r : set.readings) {
      const double u_mm = k % 3 == 0 ? 5.0 : two_distances && k % 3 == 1 ? 12.0 : 300.0;
      ++k;
      r.travel_since_reversal_mm = u_mm;
      r.error += 6.0 * static_cast<int>(r.approach) * std::exp(-u_mm / 8.0);
    }
    const auto found = must(fit(model, observations_of(set, model, mill())));
    const auto& length = parameter(found, 2, "u0_mm");
    const auto& size = parameter(found, 2, "c_um");
    CHECK(length.undetermined == !two_distances);
    CHECK(size.undetermined == !two_distances);
    CHECK(length.sigma.has_value() == two_distances);
    if (two_distances) CHECK(std::abs(length.value - 8.0) < 4.0 * *length.sigma);
    CHECK(found.rms_um == Approx(0.1).epsilon(0.2));
  }
}

TEST_CASE("a fit from values refines them; without that it searches the whole range again") {
  Model model = straight();
  model.effects.push_back(effect(cyclic, Axis::X, Sense::EX));
  const auto set = measured({}, 0.05, [](const Reading& r) {
    return 6.0 * std::sin(2.0 * std::numbers::pi * p(r) / 90.0) + 2.0 * std::sin(2.0 * std::numbers::pi * p(r) / 337.0);
  });
  model.effects.back().fitted["period_mm"] = 330.0;
  const Observations data = observations_of(set, model, mill());
  const auto anew = must(fit(model, data));
  const auto refined = must(fit(model, data, {.plain = false, .from_values = true}));
  CHECK(parameter(refined, 2, "period_mm").value == Approx(337.0).epsilon(0.05));
  CHECK(parameter(anew, 2, "period_mm").value < 200.0);  // 90 mm, or 180 with it as the second harmonic
  CHECK(anew.rms_um < 0.6 * refined.rms_um);
}

TEST_CASE("size and length of a reversal spike lie within three sigma of the truth, far from a straight law too") {
  Model model = straight();
  model.effects.push_back(effect(effects::reversal_spike, Axis::X, Sense::EX));
  int inside = 0, counted = 0;
  constexpr double kSize_um = 1.2, kLength_mm = 45.0;
  for (unsigned seed = 1; seed <= 150; ++seed) {
    laser::MeasurementSet set = measured({.targets = 21, .runs = 2}, 0.3, nothing, seed);
    for (Reading& r : set.readings) {
      r.travel_since_reversal_mm = r.approach == Approach::forward ? 30.0 + p(r) : 530.0 - p(r);
      r.error += kSize_um * d(r) * std::exp(-*r.travel_since_reversal_mm / kLength_mm);
    }
    const auto found = must(fit(model, observations_of(set, model, mill())));
    for (const ParameterEstimate& one : found.effects.back().parameters) {
      ++counted;
      const double truth = one.name == "c_um" ? kSize_um : kLength_mm;
      if (!one.sigma || std::abs(one.value - truth) <= 3.0 * *one.sigma) ++inside;
    }
  }
  CHECK(counted == 300);
  CHECK(inside >= 294);
}
