// The model of one turn of a rotary axis: offset, reversal and waves of known size are found, noise gives none.
#include "laser/analysis/turn.hpp"

#include <functional>
#include <numbers>

#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::laser;

namespace {

double wave(double deg, int order, double phase_deg) {
  return std::cos((order * deg - phase_deg) * std::numbers::pi / 180.0);
}

/// Two runs there and back over equal steps, with a little noise that repeats its pattern nowhere.
MeasurementSet turned(double from_deg, double to_deg, int targets, const std::function<double(double)>& error,
                      double reversal = 0.0) {
  MeasurementSet set;
  unsigned seed = 7;
  for (int run = 1; run <= 2; ++run)
    for (const Approach approach : {Approach::forward, Approach::reverse})
      for (int k = 0; k < targets; ++k) {
        seed = seed * 1664525U + 1013904223U;
        Reading r{.axis = Axis::Z, .rotary = true, .sense = Sense::EC, .approach = approach, .run = run};
        const double deg = from_deg + (to_deg - from_deg) * k / (targets - 1);
        r.angle_deg[2] = deg;
        r.error = error(deg) + (approach == Approach::forward ? 0.5 : -0.5) * reversal +
                  0.2 * (static_cast<double>(seed >> 8) / 16777216.0 - 0.5);
        set.readings.push_back(r);
      }
  return set;
}

std::optional<TurnModel> turn_of_only(const MeasurementSet& set) { return turn_of(set, groups_of(set).front()); }

}  // namespace

TEST_CASE("offset, reversal and the waves of a turn are found with their sizes and phases") {
  const auto turn = must(turn_of_only(turned(
      0, 350, 36, [](double deg) { return 3.0 + 5.0 * wave(deg, 1, 40) + 1.0 * wave(deg, 6, 200); }, 2.0)));
  CHECK(turn.offset == Approx(3.0).epsilon(0.02));
  CHECK(*turn.reversal == Approx(2.0).epsilon(0.05));
  REQUIRE(turn.waves.size() == 2);
  CHECK(turn.waves[0].order == 1);
  CHECK(turn.waves[0].amplitude == Approx(5.0).epsilon(0.01));
  CHECK(turn.waves[0].phase_deg == Approx(40.0).epsilon(0.01));
  CHECK(turn.waves[1].order == 6);
  CHECK(turn.waves[1].amplitude == Approx(1.0).epsilon(0.05));
  CHECK(turn.waves[1].amplitude_sigma < 0.02);
  CHECK(turn.explained > 0.99);
  CHECK(turn.rms_left == Approx(0.2 / std::sqrt(12.0)).epsilon(0.2));
}

TEST_CASE("the second turn is the same place: 370 degrees is 10 degrees") {
  const auto once = must(turn_of_only(turned(0, 350, 36, [](double deg) { return wave(deg, 2, 90); })));
  const auto twice = must(turn_of_only(turned(0, 710, 72, [](double deg) { return wave(deg, 2, 90); })));
  CHECK(twice.waves.front().order == 2);
  CHECK(twice.waves.front().amplitude == Approx(once.waves.front().amplitude).epsilon(0.05));
}

TEST_CASE("noise alone has no waves, and part of a turn none that are longer than the part") {
  CHECK(must(turn_of_only(turned(0, 350, 36, [](double) { return 0.0; }))).waves.empty());
  const auto part = must(turn_of_only(turned(-55, 55, 23, [](double deg) { return wave(deg, 4, 0); })));
  CHECK(part.least_waves == 4);  // 115 deg with the step hold a wave of 90 deg
  CHECK(only(part.waves).order == 4);
}

TEST_CASE("linear axes and few angles have no model of a turn") {
  CHECK_FALSE(turn_of_only(turned(0, 300, 6, [](double) { return 0.0; })));
  MeasurementSet set = turned(0, 350, 36, [](double) { return 0.0; });
  for (Reading& r : set.readings) r.rotary = false;
  CHECK_FALSE(turn_of_only(set));
}
