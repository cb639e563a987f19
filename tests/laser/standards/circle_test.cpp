// Quantities of ISO 230-4 against circles whose deviations a hand can compute, and what a circle file must hold.
#include "laser/standards/circle.hpp"

#include <functional>
#include <numbers>

#include <fmt/format.h>

#include "laser/writers/writers.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::laser;

namespace {

/// Radial deviation [um] over the angle [rad] and the sense +1 counter-clockwise.
using Deviation = std::function<double(double, double)>;

CircleTest circle_of(const Deviation& deviation, int step_deg = 2) {
  CircleTest test;
  test.radius_mm = 100.0;
  for (const bool clockwise : {false, true})
    for (int angle = 0; angle < 360; angle += step_deg)
      test.readings.push_back({0, static_cast<double>(angle),
                               deviation(angle * std::numbers::pi / 180.0, clockwise ? -1.0 : 1.0), clockwise, 1});
  return test;
}

std::string circle_refusal(const std::string& text) {
  return to_text(must_fail(parse_circle_test(text, "circle.csv")));
}

const std::string kHead = "# plane: XY\n# radius_mm: 100\nangle_deg,deviation_um,direction\n";

std::string rows(int from, int to, const std::string& direction) {
  std::string text;
  for (int angle = from; angle < to; angle += 10) text += fmt::format("{},0.5,{}\n", angle, direction);
  return text;
}

}  // namespace

TEST_CASE("an ellipse of +-3 um has G 6 um, F +-3 um, and no centring error") {
  const auto values = circle_values_of(circle_of([](double t, double) { return 3.0 * std::cos(2.0 * t); }));
  REQUIRE(values.passes.size() == 2);
  CHECK(values.passes[0].G_um == Approx(6.0).epsilon(1e-4));
  CHECK(values.passes[0].F_max_um == Approx(3.0).epsilon(1e-4));
  CHECK(values.passes[0].F_min_um == Approx(-3.0).epsilon(1e-4));
  CHECK(std::abs(values.passes[0].centre_um[0]) < 1e-9);
  CHECK(only(values.pairs).G_um == Approx(6.0).epsilon(1e-4));
  CHECK(values.pairs[0].H_um < 1e-9);
}

TEST_CASE("a bar set up 7 um aside and 4 um long is no circular deviation: centre (7, 0), D 4 um") {
  const auto values = circle_values_of(circle_of([](double t, double) { return 4.0 + 7.0 * std::cos(t); }));
  CHECK(values.passes[0].G_um < 1e-6);
  CHECK(values.passes[0].centre_um[0] == Approx(7.0));
  CHECK(values.passes[0].mean_um == Approx(4.0));
  CHECK(values.pairs[0].D_um == Approx(4.0));
}

TEST_CASE("servo mismatch turns with the direction: G 4 um each, G(b) 4 um, hysteresis 4 um at 45 degrees") {
  const auto values = circle_values_of(circle_of([](double t, double s) { return 2.0 * s * std::sin(2.0 * t); }, 1));
  CHECK(values.passes[1].G_um == Approx(4.0).epsilon(1e-4));
  CHECK(values.pairs[0].G_um == Approx(4.0).epsilon(1e-4));
  CHECK(values.pairs[0].H_um == Approx(4.0).epsilon(1e-4));
  CHECK(std::fmod(values.pairs[0].H_at_deg, 90.0) == Approx(45.0));
}

TEST_CASE("centres that lie 10 um apart by the direction are hysteresis: G 0, G(b) 10, H 10 um at 0 or 180 degrees") {
  // r = +-5 cos t: each path is a circle; the radial difference is 10 cos t, and the circle of both lies in the middle.
  const auto values = circle_values_of(circle_of([](double t, double s) { return 5.0 * s * std::cos(t); }));
  REQUIRE(values.pairs.size() == 1);
  CHECK(values.passes[0].G_um < 1e-6);
  CHECK(values.passes[1].G_um < 1e-6);
  CHECK(values.pairs[0].G_um == Approx(10.0).epsilon(1e-4));
  CHECK(values.pairs[0].H_um == Approx(10.0).epsilon(1e-4));
  CHECK(std::fmod(values.pairs[0].H_at_deg, 180.0) == Approx(0.0));
  CHECK(std::abs(values.pairs[0].centre_um[0]) < 1e-9);
}

TEST_CASE("a set-up 100 um aside is no hysteresis, whatever the angles of the readings of each direction") {
  CircleTest test;
  test.radius_mm = 100.0;
  for (const bool clockwise : {false, true})
    for (int angle = clockwise ? 5 : 0; angle < 360; angle += 10) {
      const double t = angle * std::numbers::pi / 180.0;
      test.readings.push_back({0, static_cast<double>(angle), 100.0 * std::cos(t) - 40.0 * std::sin(t), clockwise, 1});
    }
  const auto values = circle_values_of(test);
  CHECK(values.pairs[0].centre_um[0] == Approx(100.0));
  CHECK(values.pairs[0].centre_um[1] == Approx(-40.0));
  CHECK(values.pairs[0].H_um < 1e-9);
}

TEST_CASE("the minimum zone is narrower than the zone about the least squares centre where a spike pulls that aside") {
  const auto values =
      circle_values_of(circle_of([](double t, double) { return t < 0.2 ? 5.0 : 0.8 * std::cos(3.0 * t); }));
  CHECK(values.passes[0].G_um < values.passes[0].F_max_um - values.passes[0].F_min_um);
}

TEST_CASE("a circle that was written is read as it was") {
  CircleTest test = circle_of([](double t, double) { return std::sin(t); });
  test.plane = {Axis::Z, Axis::X};
  test.feed_mm_min = 500.0;
  test.centre_mm = {-500.0, -2000.0};
  const auto back = must(parse_circle_test(to_csv(test), "back.csv"));
  CHECK(back.plane == test.plane);
  CHECK(back.radius_mm == 100.0);
  CHECK(back.feed_mm_min == 500.0);
  CHECK(back.centre_mm == test.centre_mm);
  CHECK(back.readings.size() == test.readings.size());
  CHECK(back.readings[45].deviation_um == Approx(test.readings[45].deviation_um).epsilon(1e-3));
}

TEST_CASE("a run written with decimals is the whole number that it is") {
  std::string text = "# plane: XY\n# radius_mm: 100\nangle_deg,deviation_um,direction,run\n";
  for (int angle = 0; angle < 360; angle += 10) text += fmt::format("{},1,ccw,2.0\n", angle);
  CHECK(must(parse_circle_test(text, "a.csv")).readings.front().run == 2);
  CHECK(contains(must_fail(parse_circle_test(text + "5,1,ccw,1.5\n", "a.csv")).message, "a whole number"));
}

TEST_CASE("what a circle lacks is said in words") {
  CHECK(contains(circle_refusal(kHead + rows(0, 360, "ccw") + rows(0, 300, "cw")),
                 "cw, run 1: the circle is open: no reading between 290 and 0 degrees, a gap of 70 degrees"));
  CHECK(contains(circle_refusal(kHead + rows(0, 360, "ccw") + rows(0, 1, "cw")),
                 "cw, run 1: the circle has one reading"));
  CHECK(contains(circle_refusal("# radius_mm: 100\nangle_deg,deviation_um,direction\n" + rows(0, 360, "ccw")),
                 "expected `# plane: ` with two of the axes X, Y and Z, such as XY, found nothing"));
  CHECK(contains(circle_refusal("# plane: XX\nangle_deg,deviation_um,direction\n" + rows(0, 360, "ccw")),
                 "expected `# radius_mm: ` with the nominal radius, found none"));
  CHECK(contains(circle_refusal("# plane: XY\n# radius_mm: 100\nangle_deg,deviation_um\n0,1\n"),
                 "header: expected a column direction, found none"));
  CHECK(contains(circle_refusal(kHead + rows(0, 360, "")),
                 "circle.csv:4:7: direction: expected cw or ccw, found nothing"));
  CHECK(contains(circle_refusal(kHead + "0,1000,ccw\n"), "expected less than a millimetre, found 1000"));
  CHECK(contains(circle_refusal(kHead + "0,x,ccw\n"), "circle.csv:4:3: deviation_um: expected a number, found \"x\""));
}
