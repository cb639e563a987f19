// RECORD DATUM SEQUENCE and TEST DATUM ROUTINE on the emulated unit; its machine is referenced as g does it.
#include "app/screens/utility/screens.hpp"
#include "commissioning/unit/transfer.hpp"
#include "tests/screens/support/utility_bench.hpp"

using namespace ecs;
using namespace ecs::app;
using namespace ecs::app::screen_test;

namespace {

/// The parameters of the sample mill in the unit.
void send_mill(const UnitBench& bench) {
  const auto file = params::read_parameters("samples/mill/parameters.toml");
  REQUIRE(file);
  REQUIRE(bench.with_link([&](UnitLink& link) { return send_parameters(link.client(), file->parameters, {}); }));
}

}  // namespace

TEST_CASE("ten seconds are recorded while the emulated machine references the axis, and the graph opens") {
  const UnitBench bench;
  bench.wait_for_unit();
  const auto screen_made = datum_record_screen(bench.controller);
  Screen& screen = *screen_made;
  REQUIRE(shows(screen, "MCM-0107, integration"));
  (void)picture(screen);
  (void)press(screen, Key::Name::enter);
  CHECK(contains(picture(screen), "Record axis X for 10 seconds?"));
  (void)letter(screen, 'y');
  REQUIRE(shows(screen, "REFERENCE AXIS X NOW: g lets"));
  (void)picture(screen);
  (void)letter(screen, 'g');
  std::unique_ptr<Screen> graph;
  for (int k = 0; k < 3000 && !graph; ++k) {
    (void)screen.advance();
    graph = screen.opens_by_itself();
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  REQUIRE(graph);
  const std::string seen = picture(*graph);
  CHECK(contains(seen, "Axis X, just recorded, unit MCM-0107"));
  (void)press(*graph, Key::Name::tab);
  const std::string events = picture(*graph);
  CHECK(contains(events, "switch closes"));
  CHECK(contains(events, "direction: forward"));
  CHECK(contains(events, "contact was open at the last marker"));
  CHECK(contains(events, "Datum type fanuc"));
}

TEST_CASE("a record is cancelled by Esc, and the next one works") {
  const UnitBench bench;
  bench.wait_for_unit();
  const auto screen_made = datum_record_screen(bench.controller);
  Screen& screen = *screen_made;
  (void)letter(screen, 'z');
  (void)press(screen, Key::Name::enter);
  (void)letter(screen, 'y');
  REQUIRE(shows(screen, "REFERENCE AXIS Z NOW"));
  CHECK(press(screen, Key::Name::escape).kind == Step::Kind::stay);
  REQUIRE(shows(screen, "Given up."));
  (void)press(screen, Key::Name::enter);
  (void)letter(screen, 'y');
  REQUIRE(shows(screen, "REFERENCE AXIS Z NOW"));
}

TEST_CASE("kill -9 of the emulator while it records: it is said, and recording works when it is back") {
  const UnitBench bench;
  bench.wait_for_unit();
  const auto screen_made = datum_record_screen(bench.controller);
  Screen& screen = *screen_made;
  (void)press(screen, Key::Name::enter);
  (void)letter(screen, 'y');
  REQUIRE(shows(screen, "REFERENCE AXIS X NOW"));
  CHECK(kill_emulators() == 1);
  REQUIRE(shows(screen, "Enter records axis X."));
  (void)picture(screen);
  REQUIRE(shows(screen, "MCM-0107, integration"));
  (void)press(screen, Key::Name::enter);
  (void)letter(screen, 'y');
  REQUIRE(shows(screen, "REFERENCE AXIS X NOW"));
}

TEST_CASE("every axis finds its datum with the parameters of the mill, stage by stage") {
  const UnitBench bench;
  bench.wait_for_unit();
  send_mill(bench);
  const auto screen_made = datum_test_screen(bench.controller);
  Screen& screen = *screen_made;
  REQUIRE(shows(screen, "MCM-0107, integration"));
  (void)picture(screen);
  (void)press(screen, Key::Name::enter);
  CHECK(contains(picture(screen), "Test the datum routine of X, Y, Z?"));
  (void)letter(screen, 'y');
  REQUIRE(shows(screen, "REFERENCE AXIS X NOW"));
  REQUIRE(shows(screen, "waiting ..."));
  (void)letter(screen, 'g');
  REQUIRE(shows(screen, "Every axis that was tested found its datum."));
  CHECK(contains(picture(screen), "[x] Z      DATUM FOUND"));
}

TEST_CASE("an axis that fails says what to do, the others go on") {
  const UnitBench bench;  // without parameters Y is looked for in the wrong direction
  bench.wait_for_unit();
  const auto screen_made = datum_test_screen(bench.controller);
  Screen& screen = *screen_made;
  REQUIRE(shows(screen, "MCM-0107, integration"));
  (void)letter(screen, 'x');
  (void)press(screen, Key::Name::enter);
  CHECK(contains(picture(screen), "Test the datum routine of Y, Z?"));
  (void)letter(screen, 'y');
  REQUIRE(shows(screen, "REFERENCE AXIS Y NOW"));
  (void)letter(screen, 'g');
  REQUIRE(shows(screen, "One axis failed"));
  const std::string seen = picture(screen);
  CHECK(contains(seen, "[ ] X      not tested"));
  CHECK(contains(seen, "[x] Y      FAILED"));
  CHECK(contains(seen, "Y: wrong direction. What to do: change the approach direction"));
}

TEST_CASE("kill -9 of the emulator under a datum test: it is said, and the test works when it is back") {
  const UnitBench bench;
  bench.wait_for_unit();
  send_mill(bench);
  const auto screen_made = datum_test_screen(bench.controller);
  Screen& screen = *screen_made;
  REQUIRE(shows(screen, "MCM-0107, integration"));
  (void)press(screen, Key::Name::enter);
  (void)letter(screen, 'y');
  REQUIRE(shows(screen, "waiting ..."));
  CHECK(kill_emulators() == 1);
  REQUIRE(shows(screen, "given up"));
  (void)picture(screen);
  REQUIRE(shows(screen, "MCM-0107, integration"));
  (void)press(screen, Key::Name::enter);
  (void)letter(screen, 'y');
  REQUIRE(shows(screen, "REFERENCE AXIS X NOW"));
  (void)letter(screen, 'g');
  REQUIRE(shows(screen, "Every axis that was tested found its datum."));
}
