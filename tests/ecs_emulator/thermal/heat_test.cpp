// Heat against closed forms: first-order lags, the steady screw, waves of the day.
#include "ecs_emulator/thermal/heat.hpp"

#include <functional>
#include <numbers>

#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::emulator;

namespace {

constexpr PerAxis<std::array<double, 2>> kTravel{{{-1000.0, 0.0}, {-400.0, 0.0}, {-300.0, 0.0}}};
constexpr double kHour_s = 3600.0;

SensorSettings sensor_of(SensorSettings::Of of, double lag_s = 0.0) {
  return {.name = "one", .of = of, .lag_s = lag_s, .resolution_degC = 0.0};
}

double shown_degC(const Heat& heat, double time_s) { return heat.readings(time_s).front().second; }

/// Largest and smallest value over a day, and the hour of the largest.
struct Swing {
  double high = -1e9, low = 1e9, at_h = 0.0;
};
Swing swing_of(const std::function<double(double)>& degC, double start_h) {
  Swing swing;
  for (double t = 0.0; t < 24.0 * kHour_s; t += 60.0) {
    const double value = degC(t);
    swing.low = std::min(swing.low, value);
    if (value <= swing.high) continue;
    swing.high = value;
    swing.at_h = std::fmod(start_h + t / kHour_s, 24.0);
  }
  return swing;
}

ScrewSettings screw() { return {.friction_N = 100.0, .heat_capacity_J_per_m_degC = 4000.0, .loss_s = 1500.0}; }

/// To and fro between two places for so long, in periods of 10 ms.
void shuttle(Heat& heat, double from_mm, double to_mm, double m_min, double seconds, double& time_s) {
  constexpr double kHeatPeriod_s = 0.01;
  const double step_mm = m_min / 60.0 * 1000.0 * kHeatPeriod_s;
  double at_mm = from_mm;
  double way = to_mm > from_mm ? 1.0 : -1.0;
  const double end_s = time_s + seconds - 0.5 * kHeatPeriod_s;
  while (time_s < end_s) {
    double next_mm = at_mm + way * step_mm;
    if ((next_mm - to_mm) * (to_mm - from_mm) >= 0.0 || (next_mm - from_mm) * (to_mm - from_mm) <= 0.0) way = -way;
    heat.moved({at_mm, 0.0, 0.0}, {next_mm, 0.0, 0.0}, kHeatPeriod_s);
    at_mm = next_mm;
    time_s += kHeatPeriod_s;
    heat.advance(time_s);
  }
}

}  // namespace

TEST_CASE("without tables air and material stay at 20 degC") {
  Heat heat;
  heat.advance(1e5);
  CHECK(heat.air(1e5).temperature_degC == 20.0);
  CHECK(heat.air(1e5).pressure_hPa == 1013.25);
  CHECK(heat.material_degC(1e5) == 20.0);
  CHECK_FALSE(heat.has_air());
}

TEST_CASE("the air is warmest at its hour and swings by what is stated") {
  DaySettings day{.mean_degC = 21.0, .swing_degC = 3.0, .warmest_h = 15.0, .start_h = 8.0};
  const Day air(day, 1);
  const Swing swing = swing_of([&](double t) { return air.air_degC(t); }, 8.0);
  CHECK(swing.high == Approx(24.0));
  CHECK(swing.low == Approx(18.0));
  CHECK(swing.at_h == Approx(15.0).epsilon(0.002));
}

TEST_CASE("a body of first order follows the day smaller by 1/sqrt(1+(wt)^2) and later by atan(wt)/w") {
  DaySettings day;
  day.swing_degC = 4.0;
  const Day air(day, 1);
  const double lag_s = 4.0 * kHour_s;
  const double turn =
      2.0 * std::numbers::pi * 4.0 / 24.0;  // w·tau = pi/3: 1/sqrt(1 + 1.0966) = 0.69063, 3.0877 h later
  const Swing swing = swing_of([&](double t) { return air.following_degC(t, lag_s); }, 8.0);
  CHECK(swing.high - 20.0 == Approx(4.0 / std::sqrt(1.0 + turn * turn)).epsilon(1e-4));
  CHECK(swing.high - 20.0 == Approx(4.0 * 0.69063).epsilon(1e-4));
  CHECK(swing.at_h == Approx(15.0 + 3.0877).epsilon(0.002));
}

TEST_CASE("what follows the air obeys its differential equation, wander included") {
  DaySettings day{.swing_degC = 3.0, .wander_degC = 0.8};
  const Day air(day, 7);
  for (const double lag_s : {600.0, 7200.0})
    for (double t = 0.0; t < 1e5; t += 3333.0) {
      const double slope = (air.following_degC(t + 1.0, lag_s) - air.following_degC(t - 1.0, lag_s)) / 2.0;
      CHECK(slope * lag_s == Approx(air.air_degC(t) - air.following_degC(t, lag_s)).epsilon(1e-4));
    }
}

TEST_CASE("slow changes have the stated deviation and differ with the seed") {
  DaySettings day{.wander_degC = 0.5, .pressure_wander_hPa = 4.0};
  double square = 0.0, pressure = 0.0;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const Day air(day, seed);
    for (double t = 0.0; t < 1e5; t += 10'000.0, ++count) {
      square += std::pow(air.air_degC(t) - 20.0, 2.0);
      pressure += std::pow(air.air(t).pressure_hPa - 1013.25, 2.0);
    }
  }
  CHECK(std::sqrt(square / count) == Approx(0.5).epsilon(0.05));
  CHECK(std::sqrt(pressure / count) == Approx(4.0).epsilon(0.05));
  CHECK(Day(day, 1).air_degC(1000.0) == Day(day, 1).air_degC(1000.0));
  CHECK(Day(day, 1).air_degC(1000.0) != Day(day, 2).air_degC(1000.0));
}

TEST_CASE("a workpiece from the yard takes its time constant to come to the air") {
  HeatSettings settings;
  settings.air = DaySettings{};
  settings.air->mean_degC = 22.0;
  settings.material = {1800.0, 10.0};
  Heat heat(settings, kTravel, 1);
  CHECK(heat.material_degC(0.0) == Approx(10.0));
  heat.advance(1800.0);
  CHECK(heat.material_degC(1800.0) == Approx(22.0 - 12.0 * std::exp(-1.0)));
}

TEST_CASE("the spindle warms to what its speed asks for, with its time constant, and makes the tool longer") {
  HeatSettings settings;
  settings.spindle = SpindleSettings{};
  settings.spindle->lag_s = 1200.0;
  settings.spindle->degC_per_1000_rpm = 4.0;
  settings.spindle->growth_um_per_degC = -2.5;
  settings.spindle->tilt = Sense::EA;
  settings.spindle->tilt_um_per_m_degC = 0.8;
  settings.spindle->steps = {{600.0, 3000.0}, {4200.0, 0.0}};
  settings.sensors = {sensor_of(SensorSettings::Of::spindle)};
  Heat heat(settings, kTravel, 1);
  heat.advance(600.0);
  CHECK(shown_degC(heat, 600.0) == Approx(20.0));
  heat.advance(1800.0);
  const double rise = 12.0 * (1.0 - std::exp(-1.0));
  CHECK(shown_degC(heat, 1800.0) == Approx(20.0 + rise));
  ComponentValues values{};
  heat.add_errors({}, 1800.0, values);
  CHECK(values[index_of(Component::EZZ)] == Approx(-2.5 * rise));
  CHECK(values[index_of(Component::EAZ)] == Approx(0.8 * rise));
  heat.advance(4200.0);
  const double warmest = 12.0 * (1.0 - std::exp(-3.0));
  heat.advance(5400.0);
  CHECK(shown_degC(heat, 5400.0) == Approx(20.0 + warmest * std::exp(-1.0)));
  // A command ends the list: 1000 rpm for long gives 4 degC.
  heat.spindle(1000.0);
  heat.advance(50'000.0);
  CHECK(shown_degC(heat, 50'000.0) == Approx(24.0));
}

TEST_CASE("a sensor shows its body late, off by its offset, in steps of its resolution") {
  HeatSettings settings;
  settings.material = {1e-3, 30.0};  // at 30 in the first moment, at 20 in the next
  settings.sensors = {sensor_of(SensorSettings::Of::material, 100.0)};
  Heat heat(settings, kTravel, 1);
  CHECK(shown_degC(heat, 0.0) == Approx(30.0));
  heat.advance(100.0);
  CHECK(shown_degC(heat, 100.0) == Approx(20.0 + 10.0 * std::exp(-1.0)));
  settings.sensors[0].offset_degC = 0.3;
  settings.sensors[0].resolution_degC = 0.25;
  Heat coarse(settings, kTravel, 1);
  coarse.advance(100.0);
  CHECK(shown_degC(coarse, 100.0) == 24.0);  // 23.98
}

TEST_CASE("a sensor of the air lags like a body of first order") {
  HeatSettings settings;
  settings.air = DaySettings{};
  settings.air->swing_degC = 3.0;
  settings.sensors = {sensor_of(SensorSettings::Of::air, 4.0 * kHour_s)};
  const Heat heat(settings, kTravel, 1);
  const Swing swing = swing_of([&](double t) { return shown_degC(heat, t); }, 8.0);
  CHECK(swing.high - 20.0 == Approx(3.0 * 0.69063).epsilon(1e-4));
  CHECK(swing.at_h == Approx(15.0 + 3.0877).epsilon(0.002));
}

TEST_CASE("noise of a sensor has its deviation and depends on nothing but the time of the reading") {
  HeatSettings settings;
  settings.sensors = {sensor_of(SensorSettings::Of::air)};
  settings.sensors[0].noise_degC = 0.05;
  const Heat heat(settings, kTravel, 1);
  double sum = 0.0, square = 0.0;
  for (int i = 0; i < 2000; ++i) {
    const double off = shown_degC(heat, 0.5 * i) - 20.0;
    sum += off;
    square += off * off;
  }
  CHECK(std::sqrt(square / 2000) == Approx(0.05).epsilon(0.06));
  CHECK(std::abs(sum / 2000) < 0.004);
  CHECK(shown_degC(heat, 12.0) == shown_degC(heat, 12.0));
}

TEST_CASE("a screw in steady work rises by power times time constant over heat capacity") {
  HeatSettings settings;
  settings.screws = {screw()};
  settings.screws[0].diffusivity_mm2_s = 0.0;
  double time_s = 0.0;
  // 6 m/min over 500 mm: 100 N * 0.1 m/s = 10 W into half a metre of 4000 J/m/degC: 10*1500/2000 = 7.5 degC at the end.
  SensorSettings sensor = sensor_of(SensorSettings::Of::screw);
  sensor.at_mm = -250.0;
  settings.sensors = {sensor};
  Heat watched(settings, kTravel, 1);
  shuttle(watched, -500.0, 0.0, 6.0, 1500.0, time_s);
  CHECK(shown_degC(watched, time_s) - 20.0 == Approx(7.5 * (1.0 - std::exp(-1.0))).epsilon(0.01));
  shuttle(watched, -500.0, 0.0, 6.0, 10'500.0, time_s);
  CHECK(shown_degC(watched, time_s) - 20.0 == Approx(7.5).epsilon(0.01));
  // 11.5 um/m/degC over 0.5 m of 7.5 degC: 43.1 um at the far end, and no more beyond it.
  ComponentValues values{};
  watched.add_errors({-500.0, 0.0, 0.0}, time_s, values);
  CHECK(values[index_of(Component::EXX)] == Approx(-43.125).epsilon(0.01));
  values = {};
  watched.add_errors({-1000.0, 0.0, 0.0}, time_s, values);
  CHECK(values[index_of(Component::EXX)] == Approx(-43.125).epsilon(0.01));
  // Left alone it cools with its time constant.
  watched.advance(time_s + 1500.0);
  CHECK(shown_degC(watched, time_s + 1500.0) - 20.0 == Approx(7.5 * std::exp(-1.0)).epsilon(0.01));
}

TEST_CASE("motion at one end heats there alone, and conduction spreads it without losing any") {
  HeatSettings settings;
  settings.screws = {screw()};
  settings.screws[0].loss_s = 1e12;
  ScrewHeat near_end(settings.screws[0], kTravel[0]);
  for (int i = 0; i < 1000; ++i) {
    near_end.moved(-100.0, -80.0, 0.1);
    near_end.step();
  }
  CHECK(near_end.rise_degC(-90.0) > 10.0 * near_end.rise_degC(-300.0));
  CHECK(near_end.rise_degC(-900.0) < 1e-6);
  // 1000 * 0.02 m * 100 N = 2000 J in 4000 J/m/degC: 0.5 m degC in all; over the fixed bearing at 0 towards -1000 mm.
  CHECK(near_end.growth_um(-1000.0, 20.0) == Approx(-11.5 * 0.5).epsilon(1e-6));
}

TEST_CASE("conduction spreads a warm place as diffusion does: its variance grows by 2at") {
  ScrewSettings settings = screw();
  settings.loss_s = 1e12;
  settings.cell_mm = 10.0;
  ScrewHeat one(settings, kTravel[0]);
  one.moved(-505.0, -504.0, 1.0);
  const auto variance = [&] {
    double sum = 0.0, square = 0.0;
    for (double x = -995.0; x < 0.0; x += 10.0) {
      sum += one.rise_degC(x);
      square += one.rise_degC(x) * std::pow(x + 505.0, 2.0);
    }
    return square / sum;
  };
  one.step();
  const double before = variance();
  for (int i = 0; i < 600; ++i) one.step();
  CHECK(variance() - before == Approx(2.0 * 12.0 * 600.0).epsilon(1e-3));
}

TEST_CASE("the whole screw follows the air and grows from its fixed bearing") {
  HeatSettings settings;
  settings.air = DaySettings{};
  settings.air->mean_degC = 25.0;
  settings.screws = {screw()};
  settings.screws[0].fixed_bearing_mm = -1050.0;
  const Heat heat(settings, kTravel, 1);
  ComponentValues values{};
  heat.add_errors({-50.0, 0.0, 0.0}, 0.0, values);
  CHECK(values[index_of(Component::EXX)] == Approx(11.5 * 5.0 * 1.0));  // 1 m of screw
  settings.screws[0].positions = false;                                 // a scale beside it
  values = {};
  Heat(settings, kTravel, 1).add_errors({-50.0, 0.0, 0.0}, 0.0, values);
  CHECK(values[index_of(Component::EXX)] == 0.0);
}

TEST_CASE("heat from motion does not depend on the cell size, and grows with speed where configured") {
  const auto rise = [](double cell_mm, double viscous, double m_min) {
    ScrewSettings settings = screw();
    settings.cell_mm = cell_mm;
    settings.diffusivity_mm2_s = 0.0;
    settings.friction_N_per_m_min = viscous;
    ScrewHeat one(settings, kTravel[0]);
    const double step_mm = 1.0;
    for (int pass = 0; pass < 4; ++pass)
      for (double x = -1000.0; x < 0.0; x += step_mm) one.moved(x, x + step_mm, step_mm * 1e-3 / (m_min / 60.0));
    one.step();
    return one.rise_degC(-505.0);
  };
  CHECK(rise(10.0, 0.0, 6.0) == Approx(4 * 100.0 / 4000.0).epsilon(1e-3));
  CHECK(rise(40.0, 0.0, 6.0) == Approx(rise(10.0, 0.0, 6.0)).epsilon(1e-2));
  CHECK(rise(10.0, 5.0, 20.0) == Approx(2.0 * rise(10.0, 0.0, 20.0)));
}

TEST_CASE("an hour in one go is an hour in pieces, to the last bit") {
  HeatSettings settings;
  settings.air = DaySettings{};
  settings.air->swing_degC = 3.0;
  settings.screws = {screw()};
  settings.spindle = SpindleSettings{};
  settings.spindle->degC_per_1000_rpm = 3.0;
  settings.spindle->steps = {{100.0, 2500.0}};
  settings.material.start_degC = 15.0;
  settings.sensors = {sensor_of(SensorSettings::Of::spindle, 90.0)};
  Heat one(settings, kTravel, 3);
  Heat many(settings, kTravel, 3);
  for (Heat* heat : {&one, &many}) heat->moved({-100.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, 1.0);
  one.advance(3600.0);
  for (double t = 0.0; t < 3600.0; t += 0.7) many.advance(t);
  many.advance(3600.0);
  CHECK(shown_degC(one, 3600.0) == shown_degC(many, 3600.0));
  CHECK(one.material_degC(3600.0) == many.material_degC(3600.0));
  ComponentValues a{}, b{};
  one.add_errors({-700.0, 0.0, 0.0}, 3600.0, a);
  many.add_errors({-700.0, 0.0, 0.0}, 3600.0, b);
  CHECK(a == b);
}
