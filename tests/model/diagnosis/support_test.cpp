// How far readings support predictions at other places: against textbook formulas and against the scatter of the
// predictions of repeated measurements.
#include "model/diagnosis/support.hpp"

#include <numbers>

#include "tests/model/support/measured_lines.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;
using namespace ecs::model::test::effects;

namespace {

/// One reading at each position, both approaches.
Observations places(const Model& model, const std::vector<double>& x_mm, Sense sense = Sense::EX) {
  laser::MeasurementSet set;
  for (const double x : x_mm)
    for (const int d : {1, -1})
      set.readings.push_back({.row = static_cast<int>(set.readings.size()) + 1,
                              .axis = Axis::X,
                              .position_mm = {x, 0.0, 0.0},
                              .sense = sense,
                              .approach = static_cast<Approach>(d)});
  return all_observations_of(set, model, mill());
}

Model fitted_to(const Model& model, const Observations& data) { return with_values(model, must(fit(model, data))); }

double slope_of_ten(const Reading& r) { return 2.0 + 10.0 * p(r) / 1000.0; }

}  // namespace

TEST_CASE("the prediction of a straight line is as uncertain as the textbook says, and extrapolated beyond its ends") {
  const auto set = measured({}, 0.3, slope_of_ten);
  const Observations data = observations_of(set, straight(), mill());
  const Model model = fitted_to(straight(), data);
  double mean = 0.0, squares = 0.0, least = 1e9, greatest = -1e9;
  const auto n = static_cast<double>(data.size());
  for (const Vector3& at : data.position_mm) mean += at[0] / n;
  for (const Vector3& at : data.position_mm) squares += (at[0] - mean) * (at[0] - mean);
  for (const Vector3& at : data.position_mm) least = std::min(least, at[0]), greatest = std::max(greatest, at[0]);
  const Observations at = places(model, {-300.0, least, 250.0, mean, greatest, 1400.0});
  const auto support = must(support_of(model, data, at)).places;
  REQUIRE(support.size() == 12);
  for (std::size_t k = 0; k < at.size(); ++k) {
    const double x = at.position_mm[k][0];
    const double sigma = 0.3 * std::sqrt(1.0 / n + (x - mean) * (x - mean) / squares);
    CHECK(support[k].sigma == Approx(sigma).epsilon(0.15));  // the noise is estimated
    CHECK(support[k].extrapolated == (x < least || x > greatest));
  }
}

TEST_CASE("predictions of repeated measurements scatter by the stated uncertainty, with a free period too") {
  Model model = straight();
  model.effects.push_back(effect(cyclic, Axis::X, Sense::EX));
  const auto truth = [](const Reading& r) {
    return slope_of_ten(r) + 2.0 * std::sin(2.0 * std::numbers::pi * p(r) / 310.0);
  };
  constexpr unsigned kSets = 200;
  const std::vector<double> x_mm{100.0, 555.0, 980.0, 1600.0};
  std::vector<double> sum(2 * x_mm.size(), 0.0), squares(sum), sigma(sum), extrapolated(sum);
  for (unsigned seed = 1; seed <= kSets; ++seed) {
    const Observations data = observations_of(measured({}, 0.3, truth, seed), model, mill());
    const Model with = fitted_to(model, data);
    const Observations at = places(with, x_mm);
    const auto values = must(predicted(with, at));
    const auto support = must(support_of(with, data, at)).places;
    for (std::size_t k = 0; k < values.size(); ++k) {
      sum[k] += values[k];
      squares[k] += values[k] * values[k];
      sigma[k] += support[k].sigma / kSets;
      extrapolated[k] += support[k].extrapolated ? 1.0 : 0.0;
    }
  }
  for (std::size_t k = 0; k < sum.size(); ++k) {
    const double scatter = std::sqrt((squares[k] - sum[k] * sum[k] / kSets) / (kSets - 1));
    CHECK(sigma[k] == Approx(scatter).epsilon(0.2));  // of 200 sets the scatter is known to 5 %
  }
  const Observations at = places(model, x_mm);
  for (std::size_t k = 0; k < at.size(); ++k) CHECK(extrapolated[k] == (at.position_mm[k][0] > 1000.0 ? kSets : 0.0));
}

TEST_CASE("conditions that the readings did not see together are extrapolated, though each is inside its range") {
  Model model = straight();
  model.effects.push_back(effect(load, Axis::X, Sense::EX));
  const auto heavier_with_travel = [](Reading& r) { r.load_kg = 0.5 * r.position_mm[0] + 40.0 * (r.run % 2); };
  const auto truth = [](const Reading& r) { return slope_of_ten(r) + 0.01 * *r.load_kg; };
  const Observations data = observations_of(session({}, truth, heavier_with_travel), model, mill());
  const Model with = fitted_to(model, data);
  const auto set = session({.targets = 2}, nothing, [](Reading& r) {
    r.load_kg = r.position_mm[0] > 0.0 ? 20.0 : 500.0;
    r.position_mm[0] = r.position_mm[0] > 0.0 ? 20.0 : 10.0;
  });
  const Observations at = all_observations_of(set, with, mill());
  const auto support = must(support_of(with, data, at)).places;
  for (std::size_t k = 0; k < at.size(); ++k) CHECK(support[k].extrapolated == (at.load_kg[k] > 100.0));
}

TEST_CASE("a sense that was not measured is extrapolated") {
  const Observations data = observations_of(measured({}, 0.3, slope_of_ten), straight(), mill());
  const Model model = fitted_to(straight(), data);
  for (const Support& one : must(support_of(model, data, places(model, {500.0}, Sense::EY))).places)
    CHECK(one.extrapolated);
}

TEST_CASE("beyond its ends a curve is extrapolated, though its prediction stays the same") {
  Model model = straight();
  model.effects.push_back(effect(progressive, Axis::X, Sense::EX));
  const auto truth = [](const Reading& r) { return 20.0 * std::sin(p(r) / 400.0); };
  const Observations data = observations_of(measured({}, 0.3, truth), model, mill());
  const Model with = fitted_to(model, data);
  const Observations at = places(with, {-100.0, 500.0, 1200.0});
  const auto support = must(support_of(with, data, at)).places;
  for (std::size_t k = 0; k < at.size(); ++k) CHECK(support[k].extrapolated == (at.position_mm[k][0] != 500.0));
}

TEST_CASE("other readings than those of the fit are noticed, those of the fit are not") {
  const Observations data = observations_of(measured({}, 0.3, slope_of_ten, 1), straight(), mill());
  const Observations steeper =
      observations_of(measured({}, 0.3, [](const Reading& r) { return 2.0 * slope_of_ten(r); }), straight(), mill());
  const Model model = fitted_to(straight(), data);
  CHECK_FALSE(must(support_of(model, data, data)).is_other_fit);
  CHECK(must(support_of(model, steeper, data)).is_other_fit);
}

TEST_CASE("an effect whose sensor is missing at the places is said to be left out of their predictions") {
  Model model = straight();
  model.effects.push_back(effect(thermal_drift, Axis::X, Sense::EX));
  model.effects.back().sensor = "t_material_degC";
  const Observations data = observations_of(measured({}, 0.3, slope_of_ten), model, mill());
  const Model with = fitted_to(model, data);
  CHECK(must(notes_of_lacking(with, data)).empty());
  CHECK(
      contains(only(must(notes_of_lacking(with, places(with, {500.0})))), "thermal_drift:X:EX is left out of 2 of 2"));
}

namespace {

/// Of the places: with the first approach, in a run.
Supports supported(const laser::MeasurementSet& set, const std::vector<double>& x_mm, int run) {
  const Observations data = observations_of(set, straight(), mill());
  const Model model = fitted_to(straight(), data);
  Observations at = places(model, x_mm);
  for (int& of : at.run) of = run;
  return must(support_of(model, data, at));
}

/// Errors without any order, always the same at one number.
double without_order(double number) { return 5.0 * std::sin(1e4 * (number + 1.0)); }

}  // namespace

TEST_CASE(
    "between targets that all have an error of their own a prediction is as uncertain as these errors are large") {
  const auto truth = [](const Reading& r) { return slope_of_ten(r) + without_order(p(r)); };
  const auto set = measured({.step_mm = 50.0, .targets = 21}, 0.3, truth);
  const double target_mm = p(set.readings[8]);
  for (const Support& one : supported(set, {target_mm}, 1).places) CHECK_FALSE(one.extrapolated);
  const Supports between = supported(set, {target_mm + 20.0}, 1);
  CHECK(contains(only(between.notes), "EX along X at a value of x_mm without a reading: 2. The model lacks"));
  for (const Support& one : between.places) {
    CHECK(one.extrapolated);
    CHECK(one.sigma == Approx(5.0 / std::sqrt(2.0)).epsilon(0.35));  // 19 of them
  }
}

TEST_CASE("the zero of a further run is as uncertain as those of the runs differ") {
  const auto truth = [](const Reading& r) { return slope_of_ten(r) + without_order(r.run); };
  const auto set = measured({.runs = 12}, 0.3, truth);
  for (const Support& one : supported(set, {p(set.readings[20])}, 3).places) CHECK_FALSE(one.extrapolated);
  const Supports further = supported(set, {p(set.readings[20])}, 13);
  CHECK(contains(only(further.notes), "Each pass has a zero of its own"));
  for (const Support& one : further.places) {
    CHECK(one.extrapolated);
    CHECK(one.sigma == Approx(5.0 / std::sqrt(2.0)).epsilon(0.5));  // 12 of them
  }
}

TEST_CASE("an error that no effect of the model describes makes predictions of a further run uncertain") {
  const auto truth = [](const Reading& r) { return slope_of_ten(r) + without_order(r.run) * (p(r) / 1000.0 - 0.5); };
  const auto set = measured({.runs = 12}, 0.3, truth);
  for (const Support& one : supported(set, {p(set.readings[20])}, 3).places) CHECK_FALSE(one.extrapolated);
  const Supports further = supported(set, {p(set.readings[20])}, 13);
  CHECK(contains(only(further.notes), "EX along X in a run without a reading: 2. The model lacks an effect"));
  for (const Support& one : further.places) {
    CHECK(one.extrapolated);
    CHECK(one.sigma == Approx(5.0 / std::sqrt(24.0)).epsilon(0.5));  // rms of the slopes times that of the places
  }
}

TEST_CASE("predictions of a further run, and between targets, are not extrapolated if the model is right") {
  for (unsigned seed = 1; seed <= 100; ++seed) {
    const auto set = measured({.step_mm = 50.0, .targets = 11, .runs = 4}, 0.3, slope_of_ten, seed);
    for (const Support& one : supported(set, {p(set.readings[4]) + 20.0}, 5).places) {
      CHECK_FALSE(one.extrapolated);
      CHECK(one.sigma < 0.15);
    }
  }
}

TEST_CASE("zeros of the runs make no gap between targets in a measured run uncertain") {
  for (unsigned seed = 1; seed <= 60; ++seed) {
    const auto truth = [&](const Reading& r) { return slope_of_ten(r) + 0.2 * without_order(7.0 * seed + r.run); };
    const auto set = measured({.step_mm = 50.0, .targets = 11, .runs = 5}, 0.3, truth, seed);
    CHECK(supported(set, {p(set.readings[4]) + 20.0}, 3).notes.empty());
  }
}
