// The causes of circles whose faults are known.
#include "modules/standards/circle_diagnosis.hpp"

#include <functional>
#include <numbers>
#include <random>

#include "base/random.hpp"
#include "tests/support/test.hpp"

using namespace ecs;
using namespace ecs::model;

namespace {

constexpr double kRadius_mm = 100.0;

/// Errors of both axes [um] at (cos, sin) of the angle, moving with these signs.
struct CircleErrors {
  double u = 0.0, v = 0.0;
};
struct CirclePlace {
  double c = 0.0, s = 0.0;    ///< of the angle
  double du = 0.0, dv = 0.0;  ///< signs of motion
  double sense = 1.0;
};
using CircleMachine = std::function<CircleErrors(const CirclePlace&)>;

laser::CircleTest measured_circle(const CircleMachine& machine, double noise_um, int runs = 2, bool both_ways = true,
                                  unsigned seed = 1) {
  std::mt19937 random(seed);
  NormalDraws normal(0.0, 1.0);
  laser::CircleTest test;
  test.radius_mm = kRadius_mm;
  for (int run = 1; run <= runs; ++run)
    for (const double sense : {1.0, -1.0}) {
      if (sense < 0.0 && !both_ways) continue;
      for (int k = 0; k < 360; ++k) {
        const double angle = (k + 0.5) * std::numbers::pi / 180.0;
        CirclePlace at{std::cos(angle), std::sin(angle), 0.0, 0.0, sense};
        at.du = -at.s * sense < 0.0 ? -1.0 : 1.0;
        at.dv = at.c * sense < 0.0 ? -1.0 : 1.0;
        const CircleErrors e = machine(at);
        const double deviation = 2.0 + 5.0 * at.c + e.u * at.c + e.v * at.s + noise_um * normal(random);
        test.readings.push_back({0, k + 0.5, deviation, sense < 0.0, run});
      }
    }
  return test;
}

CircleDiagnosis causes_of(const laser::CircleTest& test, const std::array<std::vector<double>, 2>& pitches = {}) {
  return must(diagnose_circle(test, pitches));
}

}  // namespace

TEST_CASE("noise alone has no cause") {
  const auto diagnosis = causes_of(measured_circle([](const CirclePlace&) { return CircleErrors{}; }, 0.5));
  CHECK(diagnosis.faults.empty());
  CHECK(diagnosis.noise_um == Approx(0.5).epsilon(0.1));
  CHECK(diagnosis.noise_from_repeats);
}

TEST_CASE("a backlash of 4 um in X is named with its size and stands alone") {
  const auto diagnosis = causes_of(measured_circle(
      [](const CirclePlace& at) {
        return CircleErrors{2.0 * at.du, 0.0};
      },
      0.3));
  CHECK(only(diagnosis.faults).name == "backlash:X");
  CHECK(diagnosis.faults[0].value == Approx(4.0).epsilon(0.03));
  CHECK(std::abs(diagnosis.faults[0].value - 4.0) < 3.0 * diagnosis.faults[0].sigma);
  CHECK(diagnosis.faults[0].indistinguishable_from.empty());
  CHECK(diagnosis.faults[0].share > 0.9);
}

TEST_CASE("squareness of 40 um/m and servo mismatch are separated by contouring both ways, and are one group one way") {
  const CircleMachine crooked = [](const CirclePlace& at) { return CircleErrors{4.0 * at.s, 0.0}; };
  const auto both = causes_of(measured_circle(crooked, 0.2));
  CHECK(only(both.faults).name == "squareness:XY");
  CHECK(both.faults[0].value == Approx(-40.0).epsilon(0.02));  // E_X = −C0Y·Y
  CHECK(both.faults[0].unit == "um/m");
  CHECK(both.faults[0].indistinguishable_from.empty());
  const auto one = causes_of(measured_circle(crooked, 0.2, 2, false));
  REQUIRE(one.faults.size() == 1);
  const auto& fault = one.faults[0];
  CHECK((fault.name == "squareness:XY" || fault.name == "servo_mismatch:XY"));
  REQUIRE(fault.indistinguishable_from.size() == 1);
  CHECK(contains(one.notes.front(), "one direction only"));
}

TEST_CASE("a squareness has the name and the sign of the rigid-body model in every plane and order of its axes") {
  struct SquarenessCase {
    Axis first, second;
    double e_first,
        e_second;  ///< error of each [um] for 15 um/m, in the unit of the other's coordinate over the radius
    const char* component;
  };
  constexpr double kSize_um = 1.5;  // 15 um/m over 100 mm; E_X = −C0Y·Y + B0Z·Z, E_Y = −A0Z·Z
  const SquarenessCase cases[] = {{Axis::X, Axis::Y, -kSize_um, 0.0, "C0Y"}, {Axis::Y, Axis::X, 0.0, -kSize_um, "C0Y"},
                                  {Axis::X, Axis::Z, kSize_um, 0.0, "B0Z"},  {Axis::Z, Axis::X, 0.0, kSize_um, "B0Z"},
                                  {Axis::Y, Axis::Z, -kSize_um, 0.0, "A0Z"}, {Axis::Z, Axis::Y, 0.0, -kSize_um, "A0Z"}};
  for (const SquarenessCase& known : cases) {
    auto test = measured_circle(
        [&](const CirclePlace& at) {
          return CircleErrors{known.e_first * at.s, known.e_second * at.c};
        },
        0.1);
    test.plane = {known.first, known.second};
    const auto diagnosis = causes_of(test);
    CAPTURE(laser::plane_name(test.plane));
    CHECK(only(diagnosis.faults).component == known.component);
    CHECK(contains(diagnosis.faults[0].title, std::string("out of square (") + known.component + ")"));
    CHECK(diagnosis.faults[0].value == Approx(15.0).epsilon(0.04));
  }
}

TEST_CASE("a scale mismatch is the scale error of the first axis less that of the second") {
  const auto diagnosis = causes_of(measured_circle(
      [](const CirclePlace& at) {
        return CircleErrors{2.0 * at.c, -1.0 * at.s};  // +20 and −10 um/m
      },
      0.1));
  CHECK(only(diagnosis.faults).name == "scale_mismatch:XY");
  CHECK(diagnosis.faults[0].value == Approx(30.0).epsilon(0.02));
}

TEST_CASE(
    "the decay of a spike is fitted, whatever it is, and its uncertainty is in that of the size and of the scale") {
  double worst = 0.0, squares = 0.0;
  int count = 0;
  for (const double decay_mm : {0.6, 1.7, 2.0, 5.0})
    for (unsigned seed = 1; seed <= 5; ++seed) {
      const auto diagnosis = causes_of(measured_circle(
          [&](const CirclePlace& at) {
            const double travel_mm = kRadius_mm * (1.0 + at.dv * at.s);
            return CircleErrors{2.0 * at.c + 2.0 * at.du, -2.0 * at.s + 2.0 * at.dv * std::exp(-travel_mm / decay_mm)};
          },
          0.3, 2, true, seed));
      CAPTURE(decay_mm);
      CAPTURE(seed);
      REQUIRE(diagnosis.faults.size() == 3);
      for (const CircleFaultFound& fault : diagnosis.faults) {
        const double truth = fault.unit == "um/m" ? 40.0 : fault.name == "backlash:X" ? 4.0 : 2.0;
        const double off = (fault.value - truth) / fault.sigma;
        worst = std::max(worst, std::abs(off));
        squares += off * off;
        ++count;
        if (fault.name != "reversal_spike:Y") continue;
        REQUIRE(fault.nonlinear_sigma_mm);
        CHECK(std::abs(fault.nonlinear_mm - decay_mm) < 3.5 * *fault.nonlinear_sigma_mm);
        CHECK(*fault.nonlinear_sigma_mm < 0.25 * decay_mm);
      }
    }
  CHECK(worst < 3.5);
  CHECK(squares / count == Approx(1.0).epsilon(0.5));
}

TEST_CASE("a note says that no machine was given, or what its file lacks") {
  const auto test = measured_circle([](const CirclePlace&) { return CircleErrors{}; }, 0.5);
  const auto without = causes_of(test);
  CHECK(contains(without.notes.front(),
                 "the pitch of X is not known, so periodic errors of X were not looked for. Give --machine"));
  CHECK(only(must(diagnose_circle(test, {std::vector<double>{10.0}, std::vector<double>{}}, PitchSource::machine_file))
                 .notes) ==
        "the machine file has no pitch of Y, so its periodic errors were not looked for. Give screw_pitch_mm or "
        "scale_pitch_mm in "
        "[axis.Y]");
}

TEST_CASE("four causes at once come back in the order of their share; the shares add up to nearly one") {
  const auto diagnosis = causes_of(measured_circle(
      [](const CirclePlace& at) {
        const double spike = 3.0 * std::exp(-(1.0 + at.dv * at.s) / 0.003) * at.dv;
        return CircleErrors{3.0 * at.c + 1.0 * at.du, 1.5 * at.sense * at.c - 3.0 * at.s + spike};
      },
      0.1));
  REQUIRE(diagnosis.faults.size() == 4);
  CHECK(diagnosis.faults[0].name == "scale_mismatch:XY");
  CHECK(diagnosis.faults[0].value == Approx(60.0).epsilon(0.02));  // 6 um over 100 mm between the axes
  double shares = 0.0;
  for (const CircleFaultFound& fault : diagnosis.faults) shares += fault.share;
  CHECK(shares > 0.99);
  CHECK(shares < 1.0);
  CHECK(diagnosis.lack_of_fit_ln_p > std::log(kLackOfFit));
}

TEST_CASE("a wave is looked for at known pitches only, and has its amplitude") {
  const CircleMachine wavy = [](const CirclePlace& at) {
    return CircleErrors{0.0, 2.0 * std::sin(2.0 * std::numbers::pi * kRadius_mm * at.s / 20.0 + 0.7)};
  };
  const auto known = causes_of(measured_circle(wavy, 0.2), {std::vector<double>{}, std::vector<double>{20.0}});
  REQUIRE(!known.faults.empty());
  CHECK(known.faults[0].name == "cyclic:Y");
  CHECK(known.faults[0].value == Approx(2.0).epsilon(0.02));
  const auto unknown = causes_of(measured_circle(wavy, 0.2));
  CHECK(contains(unknown.notes.back(), "Cyclic errors were not tried on every axis"));
}

TEST_CASE("the bow of X and the progressive error of Y are one fault; without repeats the noise is from neighbours") {
  const auto diagnosis = causes_of(measured_circle(
      [](const CirclePlace& at) {
        return CircleErrors{0.0, 3.0 * (2.0 * at.c * at.c - 1.0)};
      },
      0.2, 1));
  CHECK(only(diagnosis.faults).name == "straightness:X");
  CHECK(!diagnosis.noise_from_repeats);
  CHECK(diagnosis.noise_um == Approx(0.2).epsilon(0.15));
}
