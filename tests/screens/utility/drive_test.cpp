// The emulated machine driven from the screens.
#include "app/screens/unit/screens.hpp"
#include "commissioning/utility/unit_view.hpp"
#include "tests/screens/support/unit_screen.hpp"
#include "tests/screens/support/utility_bench.hpp"

namespace ecs::app {
namespace {

using namespace screen_test;

TEST_CASE("what is typed to drive the emulated machine is a jog, a block or a program") {
  CHECK(drive_request("x-100 Y=50 f2000").value() == R"({"action":"jog","X":-100.0,"Y":50.0,"feed":2000.0})");
  CHECK(drive_request("G01 X-100 F2000").value() == R"({"action":"mdi","block":"G01 X-100 F2000"})");
  CHECK(contains(drive_request("samples/mill/appendix_b.nc").value(), R"("action":"run")"));
  for (const char* wrong : {"", "F2000", "fast", "X", "no-such.nc"}) CHECK_FALSE(drive_request(wrong));
}

TEST_CASE("j on the monitor drives the emulated machine, and what is no place is refused and stays") {
  const UnitBench bench;
  bench.wait_for_unit();
  const auto screen_made = monitor_screen(bench.controller);
  Screen& screen = *screen_made;
  REQUIRE(shows(screen, "no fault"));
  type(screen, "j");
  enter(screen, "over there");
  CHECK(contains(picture(screen), "expected axes with their machine coordinates"));
  replace_line(screen, "X-20 F3000");
  REQUIRE(shows(screen, "stands at X -"));
}

}  // namespace
}  // namespace ecs::app
