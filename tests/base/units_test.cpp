// Factors between units against values known by hand.
#include "base/units.hpp"

#include "tests/support/test.hpp"

using namespace ecs;

TEST_CASE("an inch is 25400 um, a milliradian 1000 um/m") {
  CHECK(kMmPerInch * kUmPerMm == 25'400.0);
  CHECK(1e-3 / kRadPerUmPerM == Approx(kUmPerMPerMrad));
}

TEST_CASE("an arc second is 4.848 um/m") { CHECK(kTurn / 360.0 / 3600.0 / kRadPerUmPerM == Approx(4.84813681)); }

TEST_CASE("a standard atmosphere is 101325 Pa, 101.325 kPa and 1013.25 hPa") {
  CHECK(1013.25 * kPaPerHPa == Approx(101'325.0));
  CHECK(101.325 * kHPaPerKPa == Approx(1013.25));
}
