// What instruments make of light, air and their own set-up, against numbers worked out by hand. The index of air is
// taken from the NIST calculator's published outputs at 633 nm, 1013.25 hPa, 50 %: 20 °C 1.000271373, 26.7982
// °C 1.000264994.
#include "ecs_emulator/instruments/laser.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::emulator;

namespace {

constexpr Air kWarm{26.7982, 1013.25, 50.0};
constexpr double kWarmer = 1.000264994 - 1.000271373;  ///< Δn from 20 °C

/// Without noise, without steps of the display, straight-edge parallel.
LaserSettings perfect() {
  LaserSettings s;
  s.linear_noise_um = s.straightness_noise_um = s.angular_noise_um_per_m = s.level_noise_um_per_m = 0.0;
  s.linear_resolution_um = s.straightness_resolution_um = s.angular_resolution_um_per_m = 0.0;
  s.level_resolution_um_per_m = s.indicator_noise_um = s.indicator_resolution_um = 0.0;
  s.setup_slope_um_per_m = s.setup_offset_um = 0.0;
  s.wavelength_nm = 633.0;
  return s;
}

Sight at(double target_mm, Air air = {}) {
  Sight sight{.target_mm = target_mm, .air = air};
  return sight;
}

/// An instrument set up by somebody, zeroed at the first sight.
struct Setup {
  Setup(InstrumentKind kind, Sense sense, const LaserSettings& settings, const Sight& first = {})
      : random(1), instrument(set_up(kind, sense, Axis::X, settings, random)) {
    instrument->zero(first);
  }
  double reads(const Sight& sight) { return instrument->read(sight, random); }
  Random random;
  std::unique_ptr<Instrument> instrument;
};

double linear(const LaserSettings& settings, const Sight& then, const Sight& first = {}) {
  return Setup(InstrumentKind::linear, Sense::EX, settings, first).reads(then);
}

struct Statistics {
  double deviation = 0.0;
  double correlation = 0.0;  ///< between values `lag` apart
};

Statistics statistics_of(const std::vector<double>& values, std::size_t lag) {
  double mean = 0.0;
  for (const double v : values) mean += v / static_cast<double>(values.size());
  double square = 0.0;
  double product = 0.0;
  for (std::size_t i = lag; i < values.size(); ++i) {
    square += (values[i] - mean) * (values[i] - mean);
    product += (values[i] - mean) * (values[i - lag] - mean);
  }
  return {std::sqrt(square / static_cast<double>(values.size() - lag)), product / square};
}

}  // namespace

TEST_CASE("with the air compensation off a reading holds p times the change of the index, in either direction") {
  LaserSettings s = perfect();
  s.air_compensation = Compensation::off;
  CHECK(linear(s, at(4000.0, kWarm), at(0.0, kWarm)) == Approx(4e6 * kWarmer).epsilon(1e-3));
  CHECK(linear(s, at(-4000.0, kWarm), at(0.0, kWarm)) == Approx(-4e6 * kWarmer).epsilon(1e-3));
  CHECK(std::abs(linear(s, at(4000.0))) < 1e-6);
}

TEST_CASE("automatic air compensation is as good as its sensors") {
  LaserSettings s = perfect();
  CHECK(std::abs(linear(s, at(4000.0, kWarm), at(0.0, kWarm))) < 1e-6);
  s.air_sensor_error_degC = 1.0;  // taken for thinner than it is: 0.95 um/m too long
  CHECK(linear(s, at(1000.0)) == Approx(0.95).epsilon(0.01));
  s.air_sensor_error_degC = 0.0;
  s.pressure_sensor_error_hPa = 1.0;
  CHECK(linear(s, at(1000.0)) == Approx(-0.268).epsilon(0.01));
  s.pressure_sensor_error_hPa = 0.0;
  s.humidity_sensor_error_pct = 10.0;
  CHECK(linear(s, at(1000.0)) == Approx(0.085).epsilon(0.02));
}

TEST_CASE("manual air compensation is right on the day it was entered and keeps that day") {
  LaserSettings s = perfect();
  s.air_compensation = Compensation::manual;
  CHECK(std::abs(linear(s, at(2000.0, kWarm), at(0.0, kWarm))) < 1e-6);
  CHECK(linear(s, at(2000.0, kWarm), at(0.0)) == Approx(2e6 * kWarmer).epsilon(1e-3));
}

TEST_CASE("air that changes after the reset changes the dead path, unless its length was entered") {
  LaserSettings s = perfect();
  s.dead_path_m = 2.0;
  CHECK(linear(s, at(100.0, kWarm), at(0.0)) == Approx(2e6 * kWarmer).epsilon(1e-3));
  CHECK(linear(s, at(-100.0, kWarm), at(0.0)) == Approx(-2e6 * kWarmer).epsilon(1e-3));  // from the other side
  CHECK(std::abs(linear(s, at(100.0, kWarm), at(0.0, kWarm))) < 1e-6);
  s.dead_path_compensation = true;
  CHECK(std::abs(linear(s, at(100.0, kWarm), at(0.0))) < 1e-6);
}

TEST_CASE("a beam that is not parallel to the axis reads short by p times half the square of the angle") {
  LaserSettings s = perfect();
  s.misalignment_mrad = 2.0;
  CHECK(linear(s, at(3000.0)) == Approx(-6.0).epsilon(1e-4));
  CHECK(linear(s, at(-3000.0)) == Approx(6.0).epsilon(1e-4));
  s.misalignment_mrad = -2.0;
  CHECK(linear(s, at(3000.0)) == Approx(-6.0).epsilon(1e-4));
  Sight aside = at(1e-9);
  aside.pose.error_um[1] = 100.0;  // and sees 1/500 of what happens across
  CHECK(linear(s, aside) == Approx(-0.2).epsilon(1e-4));
}

TEST_CASE("material compensation removes the expansion it assumes") {
  LaserSettings s = perfect();
  Sight hot = at(1000.0);
  hot.material_degC = 25.0;
  hot.pose.error_um[0] = 58.5;  // 11.7 um/m/°C over 5 °C
  CHECK(linear(s, hot) == Approx(58.5).epsilon(1e-6));
  s.material_compensation = Compensation::automatic;
  CHECK(std::abs(linear(s, hot)) < 1e-6);
  s.material_sensor_error_degC = -1.0;
  CHECK(linear(s, hot) == Approx(11.7).epsilon(1e-3));
  s.material_compensation = Compensation::manual;
  s.material_degC = 22.0;
  CHECK(linear(s, hot) == Approx(58.5 - 23.4).epsilon(1e-3));
  s.material_degC = 25.0;
  s.expansion_um_per_m_degC = 10.0;
  CHECK(linear(s, hot) == Approx(8.5).epsilon(1e-3));
}

TEST_CASE("a head that creeps adds to every reading what has passed since the reset") {
  LaserSettings s = perfect();
  s.head_drift_um_per_h = -3.0;
  Sight later = at(500.0);
  later.time_s = 1900.0;
  Sight first;
  first.time_s = 100.0;
  CHECK(linear(s, later, first) == Approx(-1.5));
}

TEST_CASE("the counter counts parts of half a wavelength, mixed polarisations bend them") {
  LaserSettings s = perfect();
  s.fringe_parts = 10.0;  // 31.64 nm in air
  Sight moved = at(0.0);
  moved.pose.error_um[0] = 0.100;
  CHECK(linear(s, moved) == Approx(3.0 * 0.03165 / 1.000271).epsilon(1e-6));
  s.fringe_parts = 0.0;
  s.nonlinearity_nm = 5.0;
  moved.pose.error_um[0] = 0.6330 / 8.0 / 1.000271373;  // a quarter of a fringe
  CHECK(linear(s, moved) - moved.pose.error_um[0] == Approx(0.005).epsilon(1e-3));
  s.nonlinearity_cycles = 2.0;
  CHECK(std::abs(linear(s, moved) - moved.pose.error_um[0]) < 1e-6);
  moved.pose.error_um[0] *= 0.5;
  CHECK(linear(s, moved) - moved.pose.error_um[0] == Approx(0.005).epsilon(1e-3));
}

TEST_CASE("turbulence grows with the root of the path and is correlated over its correlation time") {
  LaserSettings s = perfect();
  s.turbulence_um_per_sqrt_m = 0.3;
  s.turbulence_time_s = 2.0;
  const auto over = [&](double path_mm) {
    Setup bench(InstrumentKind::linear, Sense::EX, s);
    std::vector<double> values;
    for (int i = 1; i <= 20'000; ++i) {  // 2500 independent ones: 1.4 % of the deviation, 0.02 of the correlation
      Sight sight = at(path_mm);
      sight.time_s = 0.5 * i;
      values.push_back(bench.reads(sight));
    }
    return statistics_of(values, 4);
  };
  const Statistics near = over(1000.0);
  CHECK(near.deviation == Approx(0.3).epsilon(0.04));
  CHECK(std::abs(near.correlation - std::exp(-1.0)) < 0.08);
  CHECK(over(4000.0).deviation == Approx(0.6).epsilon(0.04));
}

TEST_CASE("air that is warmer on one side bends a straightness by the square of the range") {
  LaserSettings s = perfect();
  s.air_gradient_degC_per_m = 1.0;
  Setup bench(InstrumentKind::straightness, Sense::EY, s);
  CHECK(bench.reads(at(-4000.0)) == Approx(-0.5 * 16.0 * 0.953).epsilon(0.01));
  CHECK(bench.reads(at(-2000.0)) == Approx(-0.5 * 4.0 * 0.953).epsilon(0.01));
  s.dead_path_m = 1.0;
  CHECK(Setup(InstrumentKind::straightness, Sense::EY, s).reads(at(1000.0)) ==
        Approx(-0.5 * 4.0 * 0.953).epsilon(0.01));
}

TEST_CASE("straightness optics get noisier with the range, white and correlated") {
  LaserSettings s = perfect();
  s.straightness_noise_um = 0.5;
  s.straightness_noise_um_per_m = 0.4;
  const auto at_3_m = [&] {
    Setup bench(InstrumentKind::straightness, Sense::EZ, s);
    std::vector<double> values;
    for (int i = 0; i < 10'000; ++i) {
      Sight sight = at(3000.0);
      sight.time_s = i;
      values.push_back(bench.reads(sight));
    }
    return statistics_of(values, 2);
  };
  CHECK(at_3_m().deviation == Approx(1.3).epsilon(0.03));  // √(0.5² + 1.2²)
  CHECK(std::abs(at_3_m().correlation) < 0.04);
  s.straightness_noise_um = s.straightness_noise_um_per_m = 0.0;
  s.straightness_turbulence_um_per_m = 0.2;
  CHECK(at_3_m().deviation == Approx(0.6).epsilon(0.06));
  CHECK(std::abs(at_3_m().correlation - std::exp(-1.0)) < 0.08);
}

TEST_CASE("angular optics show the sine, in the measure of their own spacing, and drift") {
  LaserSettings s = perfect();
  Sight turned = at(100.0);
  turned.pose.rotation_um_per_m[1] = 20'000.0;
  CHECK(Setup(InstrumentKind::angular, Sense::EB, s).reads(turned) == Approx(20'000.0 - 1.3333).epsilon(1e-8));
  s.angular_scale_error_pct = 0.2;
  turned.pose.rotation_um_per_m[1] = 100.0;
  CHECK(Setup(InstrumentKind::angular, Sense::EB, s).reads(turned) == Approx(100.2));
  s.angular_drift_um_per_m_h = 1.8;
  turned.time_s = 1800.0;
  CHECK(Setup(InstrumentKind::angular, Sense::EB, s).reads(turned) == Approx(101.1));
}

TEST_CASE("a level that is read too early still shows what was before") {
  LaserSettings s = perfect();
  s.level_settling_s = 3.0;
  const auto after = [&](double stood_s) {
    Sight tilted = at(100.0);
    tilted.pose.rotation_um_per_m[0] = 100.0;
    tilted.stood_s = stood_s;
    tilted.time_s = 100.0;
    return Setup(InstrumentKind::level, Sense::EA, s).reads(tilted);
  };
  CHECK(after(3.0) == Approx(63.212).epsilon(1e-4));
  CHECK(after(0.0) == Approx(0.0));
  CHECK(after(60.0) == Approx(100.0).epsilon(1e-6));
  Setup watched(InstrumentKind::level, Sense::EA, s);  // looked at every tenth of a second it settles no faster
  double shown = 0.0;
  for (int i = 1; i <= 30; ++i) {
    Sight tilted = at(100.0);
    tilted.pose.rotation_um_per_m[0] = 100.0;
    tilted.stood_s = tilted.time_s = 0.1 * i;
    shown = watched.reads(tilted);
  }
  CHECK(shown == Approx(63.212).epsilon(1e-4));
}

TEST_CASE("a level's pivot has play and its zero an offset") {
  LaserSettings s = perfect();
  s.level_hysteresis_um_per_m = 4.0;
  s.level_zero_um_per_m = 7.0;
  Setup bench(InstrumentKind::level, Sense::EA, s);
  const auto at_tilt = [&](double tilt) {
    Sight sight;
    sight.pose.rotation_um_per_m[0] = tilt;
    return bench.reads(sight);
  };
  CHECK(at_tilt(0.0) == Approx(7.0));
  CHECK(at_tilt(50.0) == Approx(7.0 + 48.0));
  CHECK(at_tilt(100.0) == Approx(7.0 + 98.0));
  CHECK(at_tilt(50.0) == Approx(7.0 + 52.0));
}

TEST_CASE("a square's own error is a slope, the indicator's plunger lags") {
  LaserSettings s = perfect();
  s.square_error_um_per_m = 10.0;
  s.indicator_hysteresis_um = 1.0;
  Setup bench(InstrumentKind::square, Sense::EY, s);
  CHECK(bench.reads(at(400.0)) == Approx(3.5));
  CHECK(bench.reads(at(800.0)) == Approx(7.5));
  CHECK(bench.reads(at(400.0)) == Approx(4.5));
}

TEST_CASE("the defaults show the error as it is, whatever the air") {
  Sight sight = at(-4100.0, kWarm);
  sight.pose.error_um[0] = 12.34;
  CHECK(linear(perfect(), sight, at(0.0, kWarm)) == Approx(12.34).epsilon(1e-9));
}
