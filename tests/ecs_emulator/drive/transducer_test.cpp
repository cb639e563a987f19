#include "base/units.hpp"
#include "ecs_emulator/drive/servo_drive.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::emulator;

namespace {

PositionTransducer encoder(const TransducerSettings& settings, double start_mm = 0.0) {
  return {settings, Transducer::encoder, 1.0, start_mm, 1};
}

/// Amplitude of the n-th harmonic of the error over one period [mm].
double harmonic(const TransducerSettings& settings, int n) {
  const PositionTransducer transducer = encoder(settings);
  constexpr int kPoints = 360;
  double sine = 0.0, cosine = 0.0;
  for (int k = 0; k < kPoints; ++k) {
    const double p_mm = settings.period_mm * k / kPoints;
    const double error_mm = transducer.shown_mm(p_mm) - p_mm;
    sine += error_mm * std::sin(kTurn * n * k / kPoints) * 2.0 / kPoints;
    cosine += error_mm * std::cos(kTurn * n * k / kPoints) * 2.0 / kPoints;
  }
  return std::hypot(sine, cosine);
}

/// Moves evenly in steps of 0.1 ms.
void move(PositionTransducer& transducer, double from_mm, double to_mm, double seconds) {
  const int steps = static_cast<int>(std::lround(seconds / 1e-4));
  for (int k = 1; k <= steps; ++k) transducer.follow(from_mm + (to_mm - from_mm) * k / steps, 1e-4);
}

}  // namespace

TEST_CASE("a count is the nearest multiple of the resolution") {
  PositionTransducer transducer = encoder({});
  for (const auto& [place_mm, counts] : {std::pair{0.0014, 1}, {0.0016, 2}, {-0.0014, -1}, {-4100.0, -4'100'000}}) {
    transducer.follow(place_mm, 1e-3);
    CHECK(transducer.counts() == counts);
  }
}

TEST_CASE(
    "an offset of the sine errs once a period, imbalance and quadrature twice, by the part of a period they should") {
  // First order: offset o: o·P/2π, once a period; imbalance m: m/2·P/2π and quadrature q: q/2·P/2π, twice
  // (Heydemann, Applied Optics 20 (1981) 3382).
  const double unit_mm = 2.0 / kTurn;
  CHECK(harmonic({.period_mm = 2.0, .offset = 0.01}, 1) == Approx(0.01 * unit_mm).epsilon(0.001));
  CHECK(harmonic({.period_mm = 2.0, .offset = 0.01}, 2) < 0.01 * 0.01 * unit_mm);
  CHECK(harmonic({.period_mm = 2.0, .imbalance = 0.02}, 2) == Approx(0.01 * unit_mm).epsilon(0.001));
  CHECK(harmonic({.period_mm = 2.0, .imbalance = 0.02}, 1) < 1e-9);
  CHECK(harmonic({.period_mm = 2.0, .quadrature_mrad = 20.0}, 2) == Approx(0.01 * unit_mm).epsilon(0.001));
}

TEST_CASE("the error of the subdivision never adds up over periods") {
  const PositionTransducer transducer = encoder({.period_mm = 2.0, .offset = 0.3, .imbalance = 0.3});
  for (const double p_mm : {-4000.3, -1.0, 0.7, 1999.9}) CHECK(std::abs(transducer.shown_mm(p_mm) - p_mm) < 0.5);
}

TEST_CASE(
    "a stator-excited resolver shows where it was at the last period of its carrier, a rotor-excited one where it is") {
  const TransducerSettings stator{.excitation = Excitation::stator, .carrier_Hz = 500.0};
  PositionTransducer slow(stator, Transducer::resolver, 1.0, 0.0, 1);
  PositionTransducer fast({}, Transducer::resolver, 1.0, 0.0, 1);
  for (int k = 1; k <= 99; ++k) {  // 100 mm/s, read 0.1 ms before the carrier's period of 2 ms ends
    slow.follow(0.01 * k, 1e-4);
    fast.follow(0.01 * k, 1e-4);
  }
  CHECK(fast.counts() == 990);
  CHECK(slow.counts() == 800);
}

TEST_CASE("noise has the standard deviation that is asked for, and moves counts only") {
  PositionTransducer transducer = encoder({.noise_um = 5.0});
  double sum = 0.0, squares = 0.0;
  constexpr int kReadings = 4000;
  for (int k = 0; k < kReadings; ++k) {
    transducer.follow(1.0, 1e-4);
    const double off = static_cast<double>(transducer.counts()) - 1000.0;
    sum += off;
    squares += off * off;
  }
  CHECK(std::abs(sum / kReadings) < 0.25);                              // three times 5/√4000
  CHECK(std::sqrt(squares / kReadings) == Approx(5.0).epsilon(0.034));  // three times 1/√8000
}

TEST_CASE("above its fastest speed the transducer loses what is too fast, until the machine is referenced again") {
  PositionTransducer transducer = encoder({.fastest_mm_min = 6000.0});
  move(transducer, 0.0, 10.0, 0.1);  // just 6000 mm/min
  CHECK(transducer.counts() == 10'000);
  move(transducer, 10.0, 22.0, 0.1);  // a sixth too fast
  CHECK(transducer.counts() == Approx(20'000).epsilon(1e-4));
  CHECK(transducer.lost() == Approx(2000).epsilon(1e-3));
  transducer.referenced();
  transducer.follow(22.0, 1e-4);
  CHECK(transducer.counts() == 22'000);
}

TEST_CASE("a dirty place costs counts whenever it is passed, and nothing elsewhere") {
  PositionTransducer transducer = encoder({.dirt_mm = 5.0, .dirt_counts = 8});
  move(transducer, 0.0, 4.9, 0.1);
  CHECK(transducer.lost() == 0);
  std::int64_t most = 0;
  for (int pass = 0; pass < 40; ++pass) {
    const std::int64_t before = transducer.lost();
    const bool onward = pass % 2 == 0;
    move(transducer, onward ? 4.9 : 5.1, onward ? 5.1 : 4.9, 0.01);
    const std::int64_t cost = (transducer.lost() - before) * (onward ? 1 : -1);
    CHECK(cost >= 0);
    CHECK(cost <= 8);
    most = std::max(most, cost);
  }
  CHECK(most > 0);
}
