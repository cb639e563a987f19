// The closed loop of one axis in the machine: what it does to commands, to compensation and to the slide.
#include "ecs_emulator/machine/machine_tool.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::emulator;

namespace {

constexpr double kPeriod_s = 1e-3;

struct OneAxis {
  explicit OneAxis(const AxisSettings& settings = {}) : axis(params::MachineAxis{}, settings, 0.0, 1) {}

  template <class Each>
  void feed_to(double to_mm, double feed_mm_min, const Each& each) {
    const double step_mm = feed_mm_min / 60.0 * kPeriod_s;
    while (command_mm != to_mm) {
      command_mm =
          std::abs(to_mm - command_mm) <= step_mm ? to_mm : command_mm + std::copysign(step_mm, to_mm - command_mm);
      axis.step(command_mm, unit, kPeriod_s);
      each();
    }
  }
  void feed_to(double to_mm, double feed_mm_min) {
    feed_to(to_mm, feed_mm_min, [] {});
  }
  double settle(double seconds = 2.0) {
    for (int k = 0; k < static_cast<int>(seconds / kPeriod_s); ++k) axis.step(command_mm, unit, kPeriod_s);
    return axis.position_mm();
  }
  /// Where it stands at `at_mm`, approached from either side [um]: forward, reverse.
  std::array<double, 2> stand_at(double at_mm) {
    std::array<double, 2> error_um{};
    for (const int side : {0, 1}) {
      feed_to(at_mm + (side == 0 ? -20.0 : 20.0), 6000.0);
      settle();
      feed_to(at_mm, 1000.0);
      error_um[static_cast<std::size_t>(side)] = (settle() - at_mm) * 1e3;
    }
    return error_um;
  }

  AxisOfMachine axis;
  AxisDrive unit{};
  double command_mm = 0.0;
};

/// A heavy slide: friction that the drive feels.
AxisSettings heavy() { return {.friction_Nm = 2.0, .breakaway_Nm = 4.0, .slip_mm_s = 2.0}; }

}  // namespace

TEST_CASE("the axis lags behind its command by feed over gain") {
  for (const double kv_per_s : {15.0, 30.0, 60.0}) {
    AxisSettings settings;
    settings.kv_per_s = kv_per_s;
    OneAxis one(settings);
    for (const double feed_mm_min : {500.0, 2000.0, 6000.0}) {
      double lag_mm = 0.0;
      one.feed_to(one.command_mm + feed_mm_min / 60.0, feed_mm_min,
                  [&] { lag_mm = std::max(lag_mm, one.command_mm - one.axis.position_mm()); });
      CHECK(lag_mm == Approx(feed_mm_min / 60.0 / kv_per_s).epsilon(0.01));
      one.settle();
    }
  }
}

TEST_CASE("the axis settles within a pulse of its command, from either side, and stays there") {
  OneAxis one;
  for (const double at_mm : {0.0, 12.3456, -77.7}) {
    const auto [forward_um, reverse_um] = one.stand_at(at_mm);
    CHECK(std::abs(forward_um) <= 1.5);
    CHECK(std::abs(reverse_um) <= 1.5);
    CHECK(one.axis.settled(at_mm));
    const double stood_mm = one.axis.position_mm();
    CHECK(one.settle(10.0) == stood_mm);
  }
}

TEST_CASE("the unit's voltage moves the axis by its value, to a pulse, with either sign of the wiring") {
  for (const double um_per_count : {0.1, -0.1, 0.13}) {
    AxisSettings settings;
    settings.dac_um_per_count = um_per_count;
    OneAxis one(settings);
    const double before_mm = one.settle();
    for (const int counts : {30, 305, -500}) {
      one.unit = {counts, true};
      CHECK(std::abs((one.settle() - before_mm) * 1e3 - counts * um_per_count) <= 1.5);
    }
    one.unit = {500, false};  // relay open
    CHECK(std::abs(one.settle() - before_mm) <= 0.0011);
  }
}

TEST_CASE("play shows at the slide where the motor is fed back, and not where the slide is") {
  AxisSettings settings;
  settings.slide.lost_motion_um = 20.0;
  settings.feedback = Feedback::motor;
  const auto open = OneAxis(settings).stand_at(10.0);
  CHECK(std::abs(open[1] - open[0] - 20.0) <= 2.1);
  settings.feedback = Feedback::scale;
  const auto closed = OneAxis(settings).stand_at(10.0);
  CHECK(std::abs(closed[1] - closed[0]) <= 2.0);
}

TEST_CASE("wind-up reverses exponentially over its length") {
  // after a long way forward: c·(1 − 2·e^(−u/u₀)) behind, measured from the turn
  constexpr double kSize_um = 15.0, kLength_mm = 0.8;
  Slide slide({.wind_up_um = kSize_um, .wind_up_length_mm = kLength_mm}, 0.0);
  double nut_mm = 0.0;
  for (int k = 0; k < 200'000; ++k) slide.follow(nut_mm += 1e-4);
  CHECK((nut_mm - slide.position_mm()) * 1e3 == Approx(kSize_um).epsilon(1e-6));
  const double turn_mm = nut_mm;
  for (const double u_mm : {0.2, 0.8, 2.0}) {
    while (nut_mm > turn_mm - u_mm + 5e-5) slide.follow(nut_mm -= 1e-4);
    const double expected_um = -kSize_um * (1.0 - 2.0 * std::exp(-u_mm / kLength_mm));
    CHECK((nut_mm - slide.position_mm()) * 1e3 == Approx(expected_um).epsilon(0.001));
  }
}

TEST_CASE("a heavy slide sticks and slips at creep speed, a light one runs evenly") {
  const auto standing_part = [](const AxisSettings& settings) {
    OneAxis one(settings);
    one.feed_to(1.0, 6.0);
    int still = 0, all = 0;
    double before_mm = one.axis.position_mm();
    one.feed_to(1.5, 6.0, [&] {  // 0.1 mm/s
      still += std::abs(one.axis.position_mm() - before_mm) < 1e-6;
      before_mm = one.axis.position_mm();
      ++all;
    });
    return static_cast<double>(still) / all;
  };
  CHECK(standing_part({}) < 0.5);
  CHECK(standing_part(heavy()) > 0.8);
}

TEST_CASE("after a reversal a heavy slide lags briefly: the pips of figure 7.22") {
  // a sine, as one axis of a circle of 125 mm radius at 1000 mm/min; deviation from the same motion of a light axis
  const auto track = [](const AxisSettings& settings) {
    OneAxis one(settings);
    std::vector<double> place_mm;
    const double omega_per_s = 1000.0 / 60.0 / 125.0;
    const auto periods = static_cast<int>(1.5 * 6.283185307 / omega_per_s / kPeriod_s);
    for (int k = 0; k < periods; ++k) {
      one.axis.step(125.0 * std::sin(omega_per_s * k * kPeriod_s), {}, kPeriod_s);
      place_mm.push_back(one.axis.position_mm());
    }
    return place_mm;
  };
  const auto light = track({});
  const auto slow = track(heavy());
  double pip_um = 0.0, elsewhere_um = 0.0;
  const double quarter = static_cast<double>(light.size()) / 6.0;
  for (std::size_t k = light.size() / 12; k < light.size(); ++k) {
    const double place = static_cast<double>(k) / quarter;  // the axis turns at 1, 3, 5
    const double after = std::fmod(place + 1.0, 2.0);
    const double off_um = std::abs(slow[k] - light[k]) * 1e3;
    (after < 0.15 ? pip_um : elsewhere_um) = std::max(after < 0.15 ? pip_um : elsewhere_um, off_um);
  }
  CHECK(pip_um > 4.0);
  CHECK(elsewhere_um < 0.5 * pip_um);
}

TEST_CASE("an uneven subdivision of the transducer moves the axis: the loop believes it") {
  AxisSettings settings;
  settings.transducer = {.period_mm = 2.0, .offset = 0.02};  // 0.02·2/2π = 6.4 um, once a period
  OneAxis one(settings);
  one.feed_to(0.5, 1000.0);
  const double quarter_um = (one.settle() - 0.5) * 1e3;
  one.feed_to(1.0, 1000.0);
  const double half_um = (one.settle() - 1.0) * 1e3;
  // the sine too high by o: the angle shown is wrong by o·cos φ: at half a period +o·P/2π in place
  CHECK(half_um == Approx(6.37).epsilon(0.25));
  CHECK(std::abs(quarter_um) < 1.6);
}

TEST_CASE("lost counts shift the machine itself, until its control references it again") {
  AxisSettings settings;
  settings.transducer = {.dirt_mm = 5.0, .dirt_counts = 400};
  OneAxis one(settings);
  one.feed_to(10.0, 1000.0);
  const double shifted_mm = one.settle();
  CHECK(shifted_mm - 10.0 > 0.002);  // counts too few: the loop goes on until it has them
  one.axis.referenced();
  one.axis.step(one.command_mm += 1e-3, {}, kPeriod_s);
  CHECK(std::abs(one.settle() - one.command_mm) < 0.0021);
}

TEST_CASE("an approach is that of the carriage: it turns a lag later than its command, not where it settles") {
  OneAxis one;
  one.feed_to(20.0, 2000.0);
  one.settle();
  CHECK(one.axis.approach() == Approach::forward);
  const std::uint64_t pass = one.axis.pass();
  one.feed_to(10.0, 2000.0);
  CHECK(one.axis.approach() == Approach::reverse);
  CHECK(one.axis.pass() == pass + 1);
  CHECK(one.axis.travel_since_reversal_mm() == Approx(20.0 - one.axis.servo_mm()).epsilon(0.01));
  one.unit = {300, true};
  one.settle();
  CHECK(one.axis.pass() == pass + 1);
}
