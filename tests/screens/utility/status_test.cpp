// DISPLAY ECS STATUS on the emulated unit, and from files without one.
#include <sstream>

#include "app/screens/utility/screens.hpp"
#include "app/verbs/registry.hpp"
#include "base/file.hpp"
#include "commissioning/memory/decode.hpp"
#include "commissioning/unit/transfer.hpp"
#include "tests/screens/support/utility_bench.hpp"

using namespace ecs;
using namespace ecs::app;
using namespace ecs::app::screen_test;

TEST_CASE("the state is read by itself, the memory is tested, the pages turn") {
  const UnitBench bench;
  bench.wait_for_unit();
  const auto screen_made = status_screen(bench.controller);
  Screen& screen = *screen_made;
  REQUIRE(shows(screen, "unit MCM-0107"));
  const std::string seen = picture(screen);
  CHECK(contains(seen, "integration: every relay is open"));
  CHECK(contains(seen, "never tripped"));
  CHECK(contains(seen, "live"));
  (void)letter(screen, 't');
  REQUIRE(shows(screen, "Every location of the axis memory holds"));
  REQUIRE(shows(screen, "RAM test     passed"));
  (void)press(screen, Key::Name::tab);
  CHECK(contains(picture(screen), "address pointers: none in use"));
  (void)press(screen, Key::Name::tab);
  CHECK(contains(picture(screen), "axis  referenced  datum stage"));
}

TEST_CASE("compensation mode without a map: the fault in plain words, cleared on request") {
  const UnitBench bench;
  bench.wait_for_unit();
  const auto screen_made = status_screen(bench.controller);
  Screen& screen = *screen_made;
  REQUIRE(shows(screen, "unit MCM-0107"));
  (void)letter(screen, 'm');
  CHECK(contains(picture(screen), "THE MACHINE IS MOVED"));
  (void)letter(screen, 'y');
  REQUIRE(shows(screen, "What to do: send parameters and map"));
  REQUIRE(shows(screen, "fault 3 (no_map)"));
  (void)picture(screen);
  (void)letter(screen, 'c');
  CHECK(contains(picture(screen), "Let the unit forget its fault?"));
  (void)letter(screen, 'y');
  REQUIRE(shows(screen, "The fault is cleared."));
  REQUIRE(shows(screen, "fault        none"));
}

TEST_CASE("with a map: datuming with its stages, g references, the unit compensates; back says what moves") {
  const UnitBench bench;
  bench.wait_for_unit();
  const std::string params = bench.folder / "p.toml", map = bench.folder / "map.csv";
  REQUIRE(write_file(params,
                     "[compensation]\nscope = \"linear\"\n[axis.Y.datum]\napproach_direction = \"reverse\"\n"
                     "[axis.X]\ntransducer = \"encoder\"\n[axis.Z]\ntransducer = \"encoder\"\n# end of parameters\n"));
  REQUIRE(write_file(map,
                     "# machine: moving column mill\n# configuration: "
                     "TXYZ\naxis,sense,approach,p_mm,value_um\nX,EX,0,-4100,1\nX,EX,0,0,5\nY,EY,0,-1400,1\nY,EY,0,0,2\n"
                     "Z,EZ,0,-1000,1\nZ,EZ,0,0,3\n"));
  {
    const auto lent = bench.controller->lend();
    std::ostringstream out, messages;
    REQUIRE(run_program({"map", "send", map, "--params", params}, out, messages) == 0);
  }
  const auto screen_made = status_screen(bench.controller);
  Screen& screen = *screen_made;
  REQUIRE(shows(screen, "unit MCM-0107"));
  (void)letter(screen, 'm');
  (void)letter(screen, 'y');
  REQUIRE(shows(screen, "X: waiting"));
  REQUIRE(shows(screen, "g lets the emulated machine do it"));
  (void)letter(screen, 'g');
  REQUIRE(shows(screen, "compensating: relays closed"));
  REQUIRE(shows(screen, "The emulated machine was driven onto its references"));
  (void)press(screen, Key::Name::tab);
  const std::string pointers = picture(screen);
  CHECK(contains(pointers, "EXX"));
  CHECK(contains(pointers, "5.00 um"));
  const auto adds = [&] {  // the controller looks at the unit once a second
    const auto sample = bench.controller->newest();
    return sample && sample->axes[0].compensation_um > 4.9;
  };
  for (int k = 0; k < 1000 && !adds(); ++k) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  (void)letter(screen, 'm');
  CHECK(contains(picture(screen), "about X -5.0 um, Y -2.0 um, Z -3.0 um."));
  (void)letter(screen, 'y');
  REQUIRE(shows(screen, "Integration mode: every relay is open."));
}

TEST_CASE("a state that was saved opens again without a unit; so does a memory dump") {
  const UnitBench bench;
  bench.wait_for_unit();
  const std::string file = bench.folder / "status.json", dump_file = bench.folder / "unit.ecsdump";
  {
    const auto screen_made = status_screen(bench.controller);
    Screen& screen = *screen_made;
    REQUIRE(shows(screen, "unit MCM-0107"));
    (void)letter(screen, 's');
    for (int k = 0; k < 60; ++k) (void)press(screen, Key::Name::backspace);
    type(screen, file);
    (void)press(screen, Key::Name::enter);
    REQUIRE(shows(screen, "written: "));
    (void)letter(screen, 's');
    for (int k = 0; k < 60; ++k) (void)press(screen, Key::Name::backspace);
    type(screen, file);
    (void)press(screen, Key::Name::enter);
    CHECK(contains(picture(screen), "Overwrite"));
    (void)letter(screen, 'n');
  }
  const auto dump = bench.with_link([](UnitLink& link) { return take_dump(link.client(), "", DumpScope::active); });
  REQUIRE(dump);
  REQUIRE(write_file(dump_file, to_bytes(*dump)));
  const auto screen_made = status_screen(std::make_shared<UnitConnection>("rtu:/dev/no-such-port:9600"));
  Screen& screen = *screen_made;
  REQUIRE(shows(screen, "NO ANSWER"));
  CHECK(contains(picture(screen), "o opens a status file"));
  (void)letter(screen, 'o');
  type(screen, file);
  (void)press(screen, Key::Name::enter);
  REQUIRE(shows(screen, "FILE status.json: unit MCM-0107"));
  (void)letter(screen, 't');
  CHECK(contains(picture(screen), "A file is shown"));
  (void)letter(screen, 'o');
  type(screen, dump_file);
  (void)press(screen, Key::Name::enter);
  REQUIRE(shows(screen, "FILE unit.ecsdump"));
  (void)letter(screen, '4');
  const std::string memory = picture(screen);
  CHECK(contains(memory, "commit records"));
  CHECK(contains(memory, "taken 20"));
  CHECK(press(screen, Key::Name::escape).kind == Step::Kind::stay);
  CHECK(contains(picture(screen), "NO ANSWER"));
  CHECK(press(screen, Key::Name::escape).kind == Step::Kind::back);
}

TEST_CASE("a file that is neither says so") {
  const StateFolder folder;
  REQUIRE(write_file(folder / "x.json", "{\"a\": 1}\n"));
  CHECK_FALSE(read_status_file(folder / "x.json"));
  CHECK_FALSE(read_status_file(folder / "absent"));
}

TEST_CASE("kill -9 of the emulator: the age of the values is shown, and they are live again when it is back") {
  const UnitBench bench;
  bench.wait_for_unit();
  const auto screen_made = status_screen(bench.controller);
  Screen& screen = *screen_made;
  REQUIRE(shows(screen, "unit MCM-0107"));
  CHECK(kill_emulators() == 1);
  REQUIRE(shows(screen, "NO ANSWER, what is shown is"));
  (void)picture(screen);
  REQUIRE(shows(screen, "live"));
}
