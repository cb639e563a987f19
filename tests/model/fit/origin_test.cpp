// From where a fitted model counts time and temperatures on other readings.
#include "laser/import/import.hpp"
#include "tests/model/support/measured_lines.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;
using namespace ecs::model::test;
using namespace ecs::model::test::effects;

namespace {

/// A drift of 4 um/h and a growth of 2 um/degC, exactly; time begins at 10 s.
laser::MeasurementSet drifting() {
  return measured({}, 0.0, [](const Reading& r) {
    return 4.0 * (*r.time_s - 10.0) / 3600.0 + 2.0 * (r.sensors_degC.at("t_material_degC") - 21.0);
  });
}

Model drift_and_growth() {
  Model model = straight();
  model.effects.push_back(effect(time_drift, Axis::X, Sense::EX));
  model.effects.push_back(effect(thermal_drift, Axis::X, Sense::EX));
  model.effects.back().sensor = "t_material_degC";
  return model;
}

Model fitted_to(const Model& model, const laser::MeasurementSet& set) {
  return with_values(model, must(fit(model, observations_of(set, model, mill()))));
}

/// By row of the set.
std::vector<double> predictions(const Model& model, const laser::MeasurementSet& set) {
  const Observations at = all_observations_of(set, model, mill());
  const auto values = must(predicted(model, at));
  std::vector<double> by_row(set.readings.size());
  for (std::size_t k = 0; k < at.size(); ++k) by_row[at.file_order[k]] = values[k];
  return by_row;
}

laser::MeasurementSet last_half(laser::MeasurementSet set) {
  set.readings.erase(set.readings.begin(), set.readings.begin() + static_cast<std::ptrdiff_t>(set.readings.size() / 2));
  return set;
}

laser::MeasurementSet begun(laser::MeasurementSet set, const std::string& date) {
  set.metadata.push_back({"begun", date});
  return set;
}

double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest;
}

}  // namespace

TEST_CASE("a fitted model predicts the same rows alike, whatever rows are with them") {
  const laser::MeasurementSet all = drifting(), half = last_half(all);
  const Model model = fitted_to(drift_and_growth(), all);
  const std::vector<double> of_all = predictions(model, all), of_half = predictions(model, half);
  const std::vector<double> same(of_all.end() - static_cast<std::ptrdiff_t>(of_half.size()), of_all.end());
  CHECK(largest_difference(same, of_half) < 1e-9);
  Model without = model;
  without.origin.reset();
  CHECK(largest_difference(same, predictions(without, half)) > 1.0);  // counts from the first of the half, as it did
}

TEST_CASE("the set next_day is predicted alike from the whole file and from its second half") {
  const auto model = must(read_model("tests/data/made_up/next_day.toml"));
  const auto all = must(laser::read_any("tests/data/made_up/next_day.csv", {}));
  const auto half = must(laser::read_any("tests/data/made_up/next_day_half.csv", {}));
  const auto found = must(fit(model, observations_of(all.set, model, std::nullopt)));
  const Model fitted = with_values(model, found);
  REQUIRE(fitted.origin);
  CHECK(fitted.origin->time_s == 0.0);
  CHECK(fitted.origin->sensors_degC.at("t_bed_degC") == 20.0);
  const std::vector<double> of_all = predictions(fitted, all.set), of_half = predictions(fitted, half.set);
  const std::vector<double> same(of_all.end() - 100, of_all.end());
  CHECK(largest_difference(same, of_half) < 1e-9);
  CHECK(of_half.back() == Approx(half.set.readings.back().error).epsilon(0.01));
}

TEST_CASE("a model keeps its origin in its file, and through a fit to other readings") {
  const Model model = fitted_to(drift_and_growth(), drifting());
  const auto again = must(parse_model(to_toml(model), "m.toml", ""));
  CHECK(again.origin == model.origin);
  const Model of_half = fitted_to(again, last_half(drifting()));
  CHECK(of_half.origin == model.origin);
  for (const EffectInstance& one : of_half.effects)
    if (one.id == offset) CHECK(one.fitted.at("um") == Approx(again.effects.front().fitted.at("um")).epsilon(1e-6));
}

TEST_CASE("a model of which nothing counts from the origin takes that of its last readings") {
  const Model first = fitted_to(straight(), drifting()), second = fitted_to(first, last_half(drifting()));
  REQUIRE(second.origin);
  CHECK(*second.origin->time_s > *first.origin->time_s);
}

TEST_CASE("formulas of the user count time from the origin too") {
  Model model = straight();
  EffectInstance creep;
  creep.id = effect_named("user");
  creep.name = "creep";
  creep.formulas = {{Sense::EX, "k * time_s"}};
  creep.user = {{"k", "um/s", {}, {}, {}, {}}};
  model.effects.push_back(creep);
  const laser::MeasurementSet all = measured({}, 0.0, [](const Reading& r) { return 0.002 * *r.time_s; });
  const Model fitted = fitted_to(model, all);
  const std::vector<double> of_half = predictions(fitted, last_half(all));
  CHECK(of_half.back() == Approx(all.readings.back().error));
}

TEST_CASE("dates put readings of another day on the clock of the model") {
  const laser::MeasurementSet day = begun(drifting(), "2026-01-31 08:00:00");
  const Model model = fitted_to(drift_and_growth(), day);
  REQUIRE(model.origin);
  CHECK(model.origin->date == "2026-01-31 08:00:10.000");  // of the first reading, at 10 s
  const Observations next = observations_of(begun(drifting(), "2026-02-01 08:00:00"), model, mill());
  CHECK(next.first_since_s == Approx(86'400.0));
  CHECK(next.clock_note.empty());
  CHECK(next.time_s.front() == 0.0);
}

TEST_CASE("readings without a common clock say so") {
  const Model model = fitted_to(drift_and_growth(), drifting());
  const Observations half = observations_of(last_half(drifting()), model, mill());
  CHECK(half.clock_note.starts_with("no common clock: neither these readings nor those of the fit have a date"));
  CHECK(half.first_since_s > 1000.0);
  const Observations dated = observations_of(begun(drifting(), "2026-02-01 08:00:00"), model, mill());
  CHECK(dated.clock_note.starts_with("no common clock: the readings of the fit have no date"));
  CHECK(observations_of(drifting(), drift_and_growth(), mill()).clock_note.empty());  // nothing was fitted yet

  Model growth_alone = drift_and_growth();
  growth_alone.effects.erase(growth_alone.effects.end() - 2);
  const Model grown = fitted_to(growth_alone, drifting());
  const Observations later = observations_of(last_half(drifting()), grown, mill());
  CHECK(later.clock_note.empty());  // nothing counts time
  CHECK(later.origin.sensors_degC == grown.origin->sensors_degC);
}

TEST_CASE("faults of an origin are refused with file and line") {
  const auto refused = [](const std::string& origin) {
    return to_text(must_fail(parse_model("[origin]\n" + origin + "\n", "m.toml", "")));
  };
  CHECK(refused("seconds = 3").find("m.toml:2:") == 0);
  CHECK(refused("time_s = 3\ndate = \"yesterday\"").find("m.toml:3:8: date: expected a date and time such as") == 0);
  CHECK(refused("time_s = 3\ndate = \"08:00:00\"").find("m.toml:3:8: date: expected a date and time such as") == 0);
  CHECK(contains(refused("date = \"2026-01-31 08:00:00\""), "expected time_s with date"));
  CHECK(contains(refused("temperatures = { bed = 20.0 }"), "expected a column t_…_degC, got \"bed\""));
  CHECK(contains(refused("air = { t_air_degC = 20.0 }"), "air: expected pressure_hPa"));
}
