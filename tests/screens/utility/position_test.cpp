// SET AXIS POSITION on the emulated unit.
#include "app/screens/utility/screens.hpp"
#include "commissioning/utility/axis.hpp"
#include "tests/screens/support/utility_bench.hpp"

using namespace ecs;
using namespace ecs::app;
using namespace ecs::app::screen_test;

TEST_CASE("a position that is not a number, or too far away, is refused before the unit is asked") {
  CHECK(PositionController::position_in("-100.5").value() == -100.5);
  CHECK_FALSE(PositionController::position_in("12,5"));
  CHECK_FALSE(PositionController::position_in("1000001"));
  CHECK(PositionController::position_in("-1000000"));
}

TEST_CASE("a position is typed, confirmed, set, shown live and undone") {
  const UnitBench bench;
  bench.wait_for_unit();
  const auto screen_made = position_screen(bench.controller);
  Screen& screen = *screen_made;
  REQUIRE(shows(screen, "unit MCM-0107, integration"));
  (void)letter(screen, 'y');
  (void)press(screen, Key::Name::enter);
  CHECK(screen.typing());
  type(screen, "-123.5");
  CHECK(contains(picture(screen), "New position of Y, mm: -123.5"));
  (void)press(screen, Key::Name::enter);
  const std::string asked = picture(screen);
  CHECK(contains(asked, "Let the unit show -123.5000 mm for axis Y?"));
  CHECK(contains(asked, "Nothing moves"));
  (void)letter(screen, 'y');
  REQUIRE(shows(screen, "Axis Y now shows -123.5000 mm; it showed 0.0000 mm."));
  CHECK(shows(screen, "Y        -123.5000"));
  (void)picture(screen);
  (void)letter(screen, 'u');
  REQUIRE(shows(screen, "Axis Y is back at 0.0000 mm"));
  CHECK(shows(screen, "Y           0.0000"));
}

TEST_CASE("answering no sets nothing") {
  const UnitBench bench;
  bench.wait_for_unit();
  const auto screen_made = position_screen(bench.controller);
  Screen& screen = *screen_made;
  (void)press(screen, Key::Name::enter);
  type(screen, "5");
  (void)press(screen, Key::Name::enter);
  (void)letter(screen, 'n');
  CHECK_FALSE(contains(picture(screen), "Let the unit show"));
  CHECK(bench.controller->newest()->axes[0].position_mm == doctest::Approx(0.0));
}

TEST_CASE("kill -9 of the emulator while positions are set: it is said, and the next one works again") {
  const UnitBench bench;
  bench.wait_for_unit();
  const auto screen_made = position_screen(bench.controller);
  Screen& screen = *screen_made;
  const auto set = [&](const std::string& mm) {
    (void)press(screen, Key::Name::enter);
    type(screen, mm);
    (void)press(screen, Key::Name::enter);
    (void)letter(screen, 'y');
  };
  set("77");
  REQUIRE(shows(screen, "now shows 77.0000"));
  CHECK(kill_emulators() == 1);
  REQUIRE(shows(screen, "The unit was restarted"));
  CHECK_FALSE(contains(picture(screen), "Set here"));
  REQUIRE(shows(screen, "MCM-0107, integration"));
  set("88");
  REQUIRE(shows(screen, "now shows 88.0000"));
}
