// Circles measured in halves, each with a zero of the instrument of its own.
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include <fmt/ranges.h>

#include "laser/standards/circle.hpp"
#include "laser/writers/writers.hpp"
#include "modules/standards/circle_diagnosis.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::laser;

namespace {

/// Radial deviation [um] over the angle [rad] and the sense +1 counter-clockwise.
using Shape = std::function<double(double, double)>;

struct Halves {
  int beyond_deg = 0;     ///< by which each half is longer at both ends; −1: the last reading is missing
  double zero_um = 20.0;  ///< of the second half less that of the first
  int cw_parts_from = 1;  ///< number of the first half when contoured clockwise
  double noise_um = 0.0;
};

CircleTest in_halves(const Shape& shape, const Halves& how) {
  CircleTest test;
  test.radius_mm = 100.0;
  std::mt19937 draw(7);
  std::normal_distribution<double> noise(0.0, std::max(how.noise_um, 1e-12));
  for (const int run : {1, 2})
    for (const bool clockwise : {false, true})
      for (const int half : {0, 1})
        for (int angle = 180 * half - std::max(how.beyond_deg, 0); angle <= 180 * (half + 1) + how.beyond_deg; ++angle)
          test.readings.push_back(
              {0, folded_deg(angle),
               shape(angle * std::numbers::pi / 180.0, clockwise ? -1.0 : 1.0) + how.zero_um * half + noise(draw),
               clockwise, run, half + (clockwise ? how.cw_parts_from : 1)});
  return test;
}

/// 30 um off along the second axis, with a bow of ±2 um.
double eccentric_bow(double t, double) { return 30.0 * std::sin(t) + 2.0 * std::sin(3.0 * t); }

}  // namespace

TEST_CASE("halves that meet at 0 and 180 degrees are joined there: zero 20 um, centre 30 um, G 4 um of the bow") {
  const CircleValues values = circle_values_of(in_halves(eccentric_bow, {}));
  const CirclePass& pass = values.passes.front();
  CHECK(pass.common == 2);
  REQUIRE(pass.parts.size() == 2);
  CHECK(pass.parts[1].zero_um == Approx(20.0));
  CHECK(pass.centre_um[1] == Approx(30.0).epsilon(1e-3));
  CHECK(pass.G_um == Approx(4.0).epsilon(1e-3));
}

TEST_CASE("halves 10 degrees longer at both ends have 42 readings in common, and noise of 0.3 um gives u of the zero") {
  const CircleValues values = circle_values_of(in_halves(eccentric_bow, {.beyond_deg = 10, .noise_um = 0.3}));
  const CirclePass& pass = values.passes.front();
  CHECK(pass.common == 42);
  // each difference 0.3·√2, over 42 of them
  CHECK(must(pass.parts[1].sigma_um) == Approx(0.3 * std::sqrt(2.0 / 42.0)).epsilon(0.3));
  CHECK(std::abs(pass.parts[1].zero_um - 20.0) < 4.0 * *pass.parts[1].sigma_um);
}

TEST_CASE("halves without a common angle are joined as a circle: right for an eccentric circle") {
  const CircleValues values =
      circle_values_of(in_halves([](double t, double) { return 30.0 * std::sin(t); }, {.beyond_deg = -1}));
  CHECK(values.passes.front().common == 0);
  CHECK(values.passes.front().parts[1].zero_um == Approx(20.0));
  CHECK(values.passes.front().centre_um[1] == Approx(30.0));
}

TEST_CASE("halves without a common angle hide an error that is 3 um in one half; with common angles it shows") {
  const Shape step = [](double t, double) { return t > 1e-9 && t < std::numbers::pi - 1e-9 ? 3.0 : 0.0; };
  const CircleValues apart = circle_values_of(in_halves(step, {.beyond_deg = -1}));
  CHECK(apart.passes.front().parts[1].zero_um < 17.1);  // 20 − 3, but for the readings at the ends
  const CircleValues joined = circle_values_of(in_halves(step, {}));
  CHECK(joined.passes.front().parts[1].zero_um == Approx(20.0));
  CHECK(joined.passes.front().G_um > 2.0);
}

TEST_CASE("both directions with the same zeros make pairs, with numbers of their own none") {
  const Shape servo = [](double t, double s) { return 2.0 * s * std::sin(2.0 * t); };
  CHECK(circle_values_of(in_halves(servo, {})).pairs.front().H_um == Approx(4.0).epsilon(1e-3));
  const CircleValues apart = circle_values_of(in_halves(servo, {.cw_parts_from = 3}));
  CHECK(apart.pairs.empty());
  CHECK(apart.with_other_zeros);
}

TEST_CASE(
    "lost motion of X is found in halves that end where X reverses, whatever the zeros, and the note names what they "
    "hide") {
  // b/2 · sign of motion · cos t with b = 6 um: counter-clockwise X falls in the upper half
  const Shape backlash = [](double t, double s) { return -3.0 * s * (std::sin(t) > 0.0 ? 1.0 : -1.0) * std::cos(t); };
  const auto diagnosis = must(model::diagnose_circle(in_halves(backlash, {.noise_um = 0.3}), {}));
  CHECK(only(diagnosis.faults).name == "backlash:X");
  CHECK(std::abs(diagnosis.faults[0].value - 6.0) < 4.0 * diagnosis.faults[0].sigma);
  check_holds(fmt::format("{}", fmt::join(diagnosis.notes, "\n")),
              {"separate zeros of the parts", "straightness of X (bow)"});
}

TEST_CASE("a circle in parts is read as it was written") {
  const CircleTest test = in_halves(eccentric_bow, {});
  const CircleTest again = must(parse_circle_test(to_csv(test), "halves.csv"));
  REQUIRE(again.readings.size() == test.readings.size());
  CHECK(again.readings.back().part == 2);
  CHECK(again.readings.front().part == 1);
}

TEST_CASE("a part that is no whole number is refused at its place") {
  const std::string head = "# plane: XY\n# radius_mm: 100\nangle_deg,deviation_um,direction,part\n";
  check_holds(to_text(must_fail(parse_circle_test(head + "0,1,cw,half\n", "h.csv"))), {"h.csv:4:8: part", "half"});
}
