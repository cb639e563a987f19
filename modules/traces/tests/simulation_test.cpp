#include <numbers>

#include "modules/traces/tests/true_drive.hpp"
#include "modules/traces/trace.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;
using enum ecs::model::DriveConstant;

namespace {

StepShape dac_shape(const DriveParameters& drive, const DriveMove& move = {}, double seconds = 1.0) {
  const DriveResponse response = simulated(drive, move, seconds);
  std::vector<double> time_s;
  for (std::size_t n = 0; n < response.signal[0].size(); ++n) time_s.push_back(static_cast<double>(n) * 1e-4);
  return shape_of(time_s, response.signal[0], 0.0);
}

double worst_change_on_halving(const DriveParameters& drive, const DriveMove& move, double seconds) {
  const DriveResponse coarse = simulated(drive, move, seconds, 1e-4), fine = simulated(drive, move, seconds, 5e-5);
  double worst = 0.0;
  for (std::size_t s = 0; s < kDriveSignals; ++s)
    for (std::size_t n = 0; n < coarse.signal[s].size(); ++n)
      worst = std::max(worst, std::abs(coarse.signal[s][n] - fine.signal[s][2 * n]));
  return worst;
}

}  // namespace

TEST_CASE("the rig's D/A output has the published level, end of plateau and rise") {
  const StepShape shape = dac_shape(true_drive());
  CHECK(*shape.steady == Approx(2.98).epsilon(0.002));         // 3 V in figures 3.3 and 3.4
  CHECK(*shape.decay_start_s == Approx(0.50).epsilon(0.005));  // 0.5 s
  CHECK(*shape.rise_s == Approx(0.067).epsilon(0.02));         // 74 ms; 67 ms with the printed constants
  CHECK(*shape.fall_s == Approx(*shape.rise_s).epsilon(0.02));
}

TEST_CASE("with the printed tacho gain the D/A converter saturates") {
  const DriveResponse response = simulated(DriveParameters{}, DriveMove{}, 1.0);
  CHECK(*std::max_element(response.signal[0].begin(), response.signal[0].end()) == 10.0);
}

TEST_CASE("the steady D/A voltage is the tacho voltage of the demanded speed over K") {
  for (const double feed : {300.0, 1200.0, 2500.0}) {
    const DriveMove move{feed, 0.01 * feed};
    const double speed_rad_s = feed / 60.0 / 8.0 * 2.0 * std::numbers::pi;
    const DriveResponse response = simulated(true_drive(), move, 0.59);
    CHECK(response.at(DriveSignal::dac, 0.58) == Approx(3.0 * 0.0632298 * speed_rad_s).epsilon(1e-6));
    CHECK(response.at(DriveSignal::tacho, 0.58) == Approx(0.0632298 * speed_rad_s).epsilon(1e-6));
    CHECK(response.at(DriveSignal::speed, 0.58) == Approx(speed_rad_s).epsilon(1e-6));
    // only friction is left to be overcome: T1/Kt
    CHECK(response.at(DriveSignal::current, 0.58) == Approx(0.02538878 / 0.5).epsilon(1e-4));
  }
}

TEST_CASE("the slide ends where it was sent, by the screw's own constant") {
  DriveParameters drive = true_drive();
  drive[Ks] = 8.0 / (2.0 * std::numbers::pi);
  const DriveResponse response = simulated(drive, {1200.0, 10.0}, 2.0);
  CHECK(response.at(DriveSignal::slide, 1.9) == Approx(10.0).epsilon(1e-5));
}

TEST_CASE("a slow velocity loop is a damped oscillator of known frequency") {
  // Without friction, integral action and current lag: J ω' = Kt Ka (K u − Kw ω), so that the position loop has
  // ω0² = Kt Ka K Kd Ke / J and 2 ζ ω0 = Kt Ka Kw / J.
  DriveParameters drive = true_drive();
  drive[Ka] = 0.1;
  drive[Ti] = 1e6;
  drive[Tc] = 1e-6;
  drive[T1] = 1e-9;
  drive[J1] = 0.02;
  drive[dac_limit] = 1000.0;
  const double inertia = drive[Jm] + drive[J1], gain = drive[Kt] * drive[Ka] / inertia;
  const double natural = std::sqrt(gain * drive[K] * drive[Kd] * drive[Ke]), damping = gain * drive[Kw] / 2.0;
  const double ringing = std::sqrt(natural * natural - damping * damping);
  const double speed = 1200.0 / 60.0 / 8.0 * 2.0 * std::numbers::pi;
  const DriveResponse response = simulated(drive, {1200.0, 40.0}, 1.9, 1e-5);
  for (const double t : {0.05, 0.2, 0.5, 1.0, 1.5}) {
    const double decay = std::exp(-damping * t);
    const double expected = speed * (1.0 - decay * (std::cos(ringing * t) + damping / ringing * std::sin(ringing * t)));
    CHECK(response.at(DriveSignal::speed, t) == Approx(expected).epsilon(2e-3));
  }
}

TEST_CASE("half the step changes nothing that can be seen, whatever the events") {
  CHECK(worst_change_on_halving(true_drive(), {1200.0, 10.0}, 1.0) < 1e-8);
  CHECK(worst_change_on_halving(DriveParameters{}, {1200.0, 10.0}, 3.0) < 1e-8);
  DriveParameters rough = true_drive();
  rough[T1] = 0.5;  // stands, breaks away and stands again
  CHECK(worst_change_on_halving(rough, {60.0, 0.5}, 1.5) < 1e-6);
}

TEST_CASE("a move backwards is a move forwards in the mirror") {
  const DriveResponse there = simulated(true_drive(), {1200.0, 10.0}, 1.0);
  const DriveResponse back = simulated(true_drive(), {1200.0, -10.0}, 1.0);
  for (const double t : {0.01, 0.1, 0.5, 0.52, 0.9})
    for (const DriveSignal s : {DriveSignal::dac, DriveSignal::tacho, DriveSignal::current, DriveSignal::slide})
      CHECK(back.at(s, t) == Approx(-there.at(s, t)).epsilon(1e-9));
}

TEST_CASE("the simulation of an unstable loop ends at a limit") {
  DriveParameters drive = true_drive();
  drive[Tc] = 1.0;
  drive[Ti] = 1e-5;
  const DriveResponse response = simulated(drive, {1200.0, 10.0}, 5.0);
  CHECK_FALSE(response.bounded);
  for (const double v : response.signal[0]) CHECK(std::isfinite(v));
}
