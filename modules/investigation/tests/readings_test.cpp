#include "modules/investigation/readings.hpp"

#include <doctest/doctest.h>

#include "model/fit/fit.hpp"
#include "modules/investigation/tests/made_workshop.hpp"

namespace ecs::commissioning {
namespace {

model::MeasurementProposal a_run() {
  model::MeasurementProposal run;
  run.targets_mm = {10.0, 200.0, 410.0, 600.0, 790.0, 990.0};
  return run;
}
double slope_only(double x_mm, int) { return 0.01 * x_mm; }

TEST_CASE("a second run of a line has a zero of its own, which is no part of the model that is kept") {
  InvestigationReadings readings(usual_model());
  readings.add(made_readings(a_run(), slope_only, 0.01, 1, 0.0), 0.0);
  CHECK(readings.model_with_zeros().effects.size() == 3);
  laser::MeasurementSet shifted = made_readings(a_run(), slope_only, 0.01, 2, 0.0);
  for (laser::Reading& reading : shifted.readings) reading.error += 7.0;
  readings.add(shifted, 5.0);
  const model::Model with = readings.model_with_zeros();
  REQUIRE(with.effects.size() == 4);
  CHECK(is_zero_of_run(to_text(with.effects.back())));
  const auto fit = model::fit(with, readings.observations(one_axis_machine()));
  REQUIRE(fit.has_value());
  CHECK(fit->rms_um < 0.05);
  CHECK(without_zeros(with).effects == usual_model().effects);
}

TEST_CASE("a straight edge has a slope of its own in each run, a square only a zero") {
  model::MeasurementProposal run = a_run();
  run.sense = Sense::EY;
  const auto zero_of_second = [&](bool against_square) {
    InvestigationReadings readings(model::Model{});
    for (const unsigned seed : {1U, 2U}) {
      readings.add(made_readings(run, slope_only, 0.01, seed, 0.0), 5.0, against_square);
    }
    return readings.model_with_zeros().effects.back().user.size();
  };
  CHECK(zero_of_second(false) == 2);
  CHECK(zero_of_second(true) == 1);
}

TEST_CASE("rows, runs and times of a later run are numbered on") {
  InvestigationReadings readings(usual_model());
  readings.add(made_readings(a_run(), slope_only, 0.0, 1, 0.0), 0.0);
  const double end_s = *readings.all().readings.back().time_s;
  readings.add(made_readings(a_run(), slope_only, 0.0, 2, 0.0), 5.0);
  const laser::Reading& last = readings.all().readings.back();
  CHECK(last.row == 24);
  CHECK(last.run == 2);
  CHECK(*last.time_s == doctest::Approx(2.0 * end_s + 300.0 - *readings.all().readings.front().time_s));
}

TEST_CASE("a run of another line begins with run 1") {
  InvestigationReadings readings(usual_model());
  readings.add(made_readings(a_run(), slope_only, 0.0, 1, 0.0), 0.0);
  model::MeasurementProposal other = a_run();
  other.parked_mm[1] = 300.0;
  readings.add(made_readings(other, slope_only, 0.0, 2, 1000.0), 5.0);
  CHECK(readings.all().readings.back().run == 1);
}

}  // namespace
}  // namespace ecs::commissioning
