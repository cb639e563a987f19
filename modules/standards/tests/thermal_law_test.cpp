// Warm-ups whose law is known: a sensor with a delay, two of opposite signs, another zero in each run, a day that is
// warmer than the others; and the eighteen days of a real machine.
#include "modules/standards/thermal_law.hpp"

#include <cmath>

#include "base/random.hpp"
#include "laser/import/import.hpp"
#include "tests/laser/support/import_options.hpp"
#include "tests/support/real_data.hpp"

using namespace ecs;
using namespace ecs::laser;

namespace {

struct Law {
  double spindle_um_per_degC = 4.0, delay_s = 600.0;  ///< 0: none
  double bed_um_per_degC = -6.0;
  double zeros_um = 0.0;  ///< standard deviation of the zero of a run, from its second reading on
  double noise_um = 0.2;
};

/// Eight runs of two hours, a reading a minute; heat sources differ from run to run.
MeasurementSet days(const Law& law, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  NormalDraws normal;
  MeasurementSet set;
  set.source = "days.csv";
  for (int run = 1; run <= 8; ++run) {
    const double spindle = 12.0 + 2.0 * normal(random), bed = 3.0 + normal(random), from = 20.0 + 0.5 * run;
    const double stops_s = 4000.0 + 800.0 * normal(random), zero_um = law.zeros_um * normal(random);
    double delayed = 0.0;
    for (int minute = 0; minute <= 120; ++minute) {
      const double t_s = 60.0 * minute;
      const double warming = 1.0 - std::exp(-std::min(t_s, stops_s) / 900.0);
      const double spindle_degC = spindle * warming * std::exp(-std::max(t_s - stops_s, 0.0) / 1500.0);
      const double bed_degC = bed * (1.0 - std::exp(-t_s / 5000.0));
      if (minute > 0) delayed -= law.delay_s > 0.0 ? std::expm1(-60.0 / law.delay_s) * (spindle_degC - delayed) : 0.0;
      if (law.delay_s == 0.0) delayed = spindle_degC;
      Reading r{.row = static_cast<int>(set.readings.size()) + 1, .sense = Sense::EX};
      r.error = 40.0 + law.spindle_um_per_degC * delayed + law.bed_um_per_degC * bed_degC +
                (minute > 0 ? zero_um : 0.0) + law.noise_um * normal(random);
      r.run = run;
      r.time_s = t_s;
      r.sensors_degC = {{"t_spindle_degC", from + spindle_degC}, {"t_bed_degC", from + bed_degC}};
      set.readings.push_back(r);
    }
  }
  return set;
}

}  // namespace

TEST_CASE("a delayed sensor is chosen with its delay and its size, and runs left out are predicted to the noise") {
  const ThermalTest test = must(thermal_test_of(days({}, 1)));
  CHECK(test.lagged_shape.left_out_rms_um < 0.5 * test.plain_shape.left_out_rms_um);
  CHECK(test.lagged.left_out_rms_um < 0.5 * test.plain.left_out_rms_um);
  CHECK(test.lagged_shape.left_out_rms_um < 1.0);  // of 50 um; the delays tried are a factor of two apart
  double spindle = 0.0, bed = 0.0;                 // where everything has settled a law is the sum of its sensors
  for (const ThermalTerm& term : test.lagged_shape.terms)
    (term.sensor == "t_spindle_degC" ? spindle : bed) += term.um_per_degC;
  CHECK(spindle == Approx(4.0).epsilon(0.15));
  CHECK(bed == Approx(-6.0).epsilon(0.3));
}

TEST_CASE("without a delay the present temperatures predict as well as any delays") {
  const ThermalTest test = must(thermal_test_of(days({.delay_s = 0.0}, 2)));
  CHECK(test.plain_shape.left_out_rms_um == Approx(0.2).epsilon(0.1));
  CHECK(test.lagged_shape.left_out_rms_um > 0.9 * test.plain_shape.left_out_rms_um);
  REQUIRE(test.plain_shape.terms.size() == 2);
  CHECK(test.plain_shape.terms[0].um_per_degC == Approx(-6.0).epsilon(0.05));  // bed comes first by its name
  CHECK(test.plain_shape.terms[1].um_per_degC == Approx(4.0).epsilon(0.02));
}

TEST_CASE("another zero in each run spoils laws from the first reading only") {
  const ThermalTest test = must(thermal_test_of(days({.zeros_um = 5.0}, 3)));
  CHECK(test.lagged.left_out_rms_um > 3.0);
  CHECK(test.lagged_shape.left_out_rms_um < 1.2);
}

TEST_CASE("a run that leaves the temperatures of the others is said to extrapolate, with sensor and size") {
  MeasurementSet set = days({}, 4);
  for (Reading& r : set.readings)
    if (r.run == 5) r.sensors_degC["t_bed_degC"] -= 9.0;
  const ThermalTest test = must(thermal_test_of(set));
  REQUIRE(test.runs[4].beyond.size() == 1);
  CHECK(test.runs[4].beyond.front().starts_with("t_bed_degC -"));
  CHECK(test.runs[3].beyond.empty());
}

TEST_CASE("few runs, no temperatures or no times are refused with what is missing") {
  MeasurementSet set = days({}, 5);
  std::erase_if(set.readings, [](const Reading& r) { return r.run > 3; });
  CHECK(contains(to_text(must_fail(thermal_test_of(set))), "expected 4 runs or more"));
  set = days({}, 5);
  set.readings[7].time_s.reset();
  CHECK(contains(to_text(must_fail(thermal_test_of(set))), "time_s"));
  set = days({}, 5);
  for (Reading& r : set.readings) r.sensors_degC.clear();
  CHECK(contains(to_text(must_fail(thermal_test_of(set))), "expected a column t_..._degC"));
}

TEST_CASE(
    "nine days of a real machine: delays, or a zero of each run, predict a day left out better than six sensors as "
    "they are") {
  SKIP_UNLESS(!real_data("machine-thermal").empty(), kNoRealData);
  ImportOptions options = by_columns(
      "reading=9[um],run=1,time_s=2,t_ambient_degC=3[degC],t_bed_ref_degC=4[degC],t_spindle_rear_degC=5[degC],"
      "t_coolant_wall_degC=6[degC],t_transformer_bed_degC=7[degC],t_spindle_front_degC=8[degC]",
      1);
  options.axis = Axis::X;
  options.parked_stated[0] = true;
  const auto set = must(read_any(real_data("machine-thermal/ace_runs_1_to_9.csv"), options)).set;
  const ThermalTest test = must(thermal_test_of(set));
  // least squares in NumPy, outside the project
  CHECK(test.raw_rms_um == Approx(15.618).epsilon(1e-3));
  CHECK(test.plain.rms_um == Approx(6.268).epsilon(1e-3));
  CHECK(test.plain.left_out_rms_um == Approx(10.361).epsilon(1e-3));
  CHECK(test.plain_shape.rms_um == Approx(2.816).epsilon(1e-3));
  CHECK(test.plain_shape.left_out_rms_um == Approx(3.468).epsilon(1e-3));
  CHECK(test.lagged.left_out_rms_um < 0.70 * test.plain.left_out_rms_um);
  CHECK(test.plain_shape.left_out_rms_um < 0.40 * test.plain.left_out_rms_um);
  CHECK(test.lagged_shape.left_out_rms_um < 0.40 * test.plain.left_out_rms_um);
  REQUIRE(test.runs.size() == 9);
  CHECK(!test.runs[6].beyond.empty());  // the warmest day
}
