// The screen LOGBOOK: entries, one of them whole, verification.
#include "app/screens/unit/screens.hpp"
#include "modules/logbook/tests/logbook_folder.hpp"
#include "tests/screens/support/unit_screen.hpp"
#include "tests/support/screen_driver.hpp"
#include "tests/support/short_lathe.hpp"
#include "tests/support/verb_run.hpp"

namespace ecs::app {

std::unique_ptr<Screen> logbook_screen();

namespace {

using namespace screen_test;

TEST_CASE("without a logbook the screen says how one begins") {
  const LogbookFolder folder;
  const auto screen = logbook_screen();
  CHECK(reads(picture(*screen), "No logbook yet. Verbs and screens begin one when they work on a machine."));
}

TEST_CASE("entries are listed, opened, checked, and new ones come by themselves") {
  const LogbookFolder folder;
  const std::string params = folder.with("p.toml", short_lathe("MCM-0107"));
  const std::string data = folder.with("exx.csv", lathe_readings("# machine: short lathe\n"));
  REQUIRE(ran({"map", "build", data, "--params", params, "-o", folder / "map.csv"}).code == 0);
  const auto screen = logbook_screen();
  CHECK(contains(picture(*screen), "short lathe, serial number MCM-0107: 2 entries"));
  CHECK(contains(picture(*screen), "map build: map.csv"));
  (void)press(*screen, Key::Name::enter);
  CHECK(contains(picture(*screen), "ecs map build"));
  CHECK(contains(picture(*screen), "Jo Fitter"));
  (void)press(*screen, Key::Name::escape);
  (void)letter(*screen, 'v');
  CHECK(until(*screen, [&] { return contains(picture(*screen), "2 entries, each fits its hash"); }));
  REQUIRE(ran({"params", "set", params, "axis.X.deadband_um=3", "-o", folder / "new.toml"}).code == 0);
  CHECK(until(*screen, [&] { return contains(picture(*screen), "params set: new.toml"); }));
  (void)letter(*screen, 'r');
  CHECK(until(*screen, [&] { return reads(picture(*screen), "no map was made active"); }));
  CHECK(press(*screen, Key::Name::escape).kind == Step::Kind::back);
}

}  // namespace
}  // namespace ecs::app
