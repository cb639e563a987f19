// DISPLAY ECS STATUS on the emulated unit, and from files without one.

#include "app/screens/utility/screens.hpp"
#include "base/file.hpp"
#include "commissioning/memory/decode.hpp"
#include "commissioning/unit/transfer.hpp"
#include "tests/screens/support/unit_screen.hpp"
#include "tests/screens/support/utility_bench.hpp"

using namespace ecs;
using namespace ecs::app;
using namespace ecs::app::screen_test;

constexpr auto opened_status = [](std::shared_ptr<UnitConnection> unit) { return status_screen(std::move(unit)); };

TEST_CASE("the state is read on its own, the memory is tested, the pages turn") {
  const BenchOf bench(opened_status);
  Screen& screen = *bench.screen;
  REQUIRE(shows(screen, "unit MCM-0107"));
  const std::string seen = picture(screen);
  check_holds(seen, {"integration: every relay is open", "never tripped", "live"});
  REQUIRE(shows_after(screen, "t", "Every location of the axis memory stores"));
  REQUIRE(shows(screen, "RAM test     passed"));
  CHECK(contains(after(screen, "\t"), "no value of the map is applied at present"));
  CHECK(contains(after(screen, "\t"), "axis  referenced  datum stage"));
}

TEST_CASE("in integration mode g references the machine, and the screen says that the unit does not follow") {
  const BenchOf bench(opened_status);
  Screen& screen = *bench.screen;
  REQUIRE(shows(screen, "integration: every relay is open"));
  REQUIRE(shows_after(screen, "g", "The emulated machine was referenced."));
  CHECK(reads(picture(screen),
              "The unit follows this only in compensation mode, so its axes on page 3 have not changed."));
  const std::string axes = after(screen, "3");
  CHECK(contains(axes, "waiting"));
  CHECK_FALSE(contains(axes, "yes"));
}

TEST_CASE("compensation mode without a map: the fault in plain words, cleared on request") {
  const BenchOf bench(opened_status);
  Screen& screen = *bench.screen;
  REQUIRE(shows(screen, "unit MCM-0107"));
  CHECK(reads(after(screen, "m"), "THE MACHINE IS MOVED"));
  REQUIRE(shows_after(screen, "y", "What to do: send parameters and map"));
  REQUIRE(shows(screen, "fault 3 (no_map)"));
  (void)picture(screen);
  CHECK(contains(after(screen, "c"), "Clear the fault of the unit?"));
  REQUIRE(shows_after(screen, "y", "The fault is cleared."));
  REQUIRE(shows(screen, "fault        none"));
}

TEST_CASE("with a map: datuming with its stages, g references, the unit compensates; back says what moves") {
  const UnitBench bench;
  bench.wait_for_unit();
  give_map(*bench.controller, bench.folder);
  const auto screen_made = status_screen(bench.controller);
  Screen& screen = *screen_made;
  REQUIRE(shows(screen, "unit MCM-0107"));
  REQUIRE(shows_after(screen, "my", "X: waiting"));
  REQUIRE(shows(screen, "press g to reference the emulated machine"));
  REQUIRE(shows_after(screen, "g", "compensating: relays closed"));
  REQUIRE(shows(screen, "The emulated machine was referenced"));
  CHECK(reads(after(screen, "t"),
              "The memory can be tested in integration mode only; the unit is compensating. Press m to switch."));
  CHECK(reads(after(screen, "c"), "There is no fault to clear."));
  const std::string pointers = after(screen, "\t");
  check_holds(pointers, {"EXX", "5.00 um"});
  const auto adds = [&] {  // the controller looks at the unit once a second
    const auto sample = bench.controller->newest();
    return sample && sample->axes[0].compensation_um > 4.9;
  };
  for (int k = 0; k < 1000 && !adds(); ++k) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  CHECK(contains(after(screen, "m"), "about X -5.0 um, Y -2.0 um, Z -3.0 um."));
  REQUIRE(shows_after(screen, "y", "Integration mode: every relay is open."));
}

TEST_CASE("a state that was saved opens again without a unit; so does a memory dump") {
  const UnitBench bench;
  bench.wait_for_unit();
  const std::string file = bench.folder / "status.json", dump_file = bench.folder / "unit.ecsdump";
  {
    const auto screen_made = status_screen(bench.controller);
    Screen& screen = *screen_made;
    REQUIRE(shows(screen, "unit MCM-0107"));
    type(screen, "s");
    replace_line(screen, file);
    REQUIRE(shows(screen, "written: "));
    type(screen, "s");
    replace_line(screen, file);
    CHECK(contains(picture(screen), "Overwrite"));
    (void)letter(screen, 'n');
  }
  const auto dump =
      must(bench.with_link([](UnitLink& link) { return take_dump(link.client(), "", DumpScope::active); }));
  REQUIRE(write_file(dump_file, to_bytes(dump)));
  const auto screen_made = status_screen(std::make_shared<UnitConnection>("rtu:/dev/no-such-port:9600"));
  Screen& screen = *screen_made;
  REQUIRE(shows(screen, "NO ANSWER"));
  CHECK(contains(picture(screen), "press o to open a status file"));
  REQUIRE(shows_after(screen, "o" + file + "\n", "FILE status.json: unit MCM-0107"));
  CHECK(contains(after(screen, "t"), "A file is shown"));
  REQUIRE(shows_after(screen, "o" + dump_file + "\n", "FILE unit.ecsdump"));
  const std::string memory = after(screen, "4");
  check_holds(memory, {"commit records", "taken 20"});
  CHECK(press(screen, Key::Name::escape).kind == Step::Kind::stay);
  CHECK(contains(picture(screen), "NO ANSWER"));
  CHECK(press(screen, Key::Name::escape).kind == Step::Kind::back);
}

TEST_CASE("a file that is neither says so") {
  const StateFolder folder;
  REQUIRE(write_file(folder / "x.json", "{\"a\": 1}\n"));
  CHECK_FALSE(read_status_file(folder / "x.json"));
  CHECK_FALSE(read_status_file(folder / "absent"));
  const auto screen_made = status_screen(no_link());
  type(*screen_made, "o");
  replace_line(*screen_made, folder / "x.json");
  CHECK(reads(picture(*screen_made), "x.json is neither a saved status nor a memory dump."));
  CHECK(screen_made->typing());
}

TEST_CASE("kill -9 of the emulator: the age of the values is shown, and they are live again when it is back") {
  const BenchOf bench(opened_status);
  Screen& screen = *bench.screen;
  REQUIRE(shows(screen, "unit MCM-0107"));
  CHECK(kill_emulators() == 1);
  REQUIRE(shows(screen, "NO ANSWER, the data are"));
  (void)picture(screen);
  REQUIRE(shows(screen, "live"));
}
