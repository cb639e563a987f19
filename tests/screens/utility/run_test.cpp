// RUN USER SOFTWARE on the emulated unit.
#include "app/screens/utility/screens.hpp"
#include "commissioning/utility/run_controller.hpp"
#include "tests/screens/support/utility_bench.hpp"

using namespace ecs;
using namespace ecs::app;
using namespace ecs::app::screen_test;

namespace {

// addq.l #5,d0; rts
const std::vector<std::uint8_t> kAddFive{0x5A, 0x80, 0x4E, 0x75};
// bra to itself
const std::vector<std::uint8_t> kForever{0x60, 0xFE};

void write(const UnitBench& bench, Address address, const std::vector<std::uint8_t>& code) {
  REQUIRE(bench.with_link([&](UnitLink& link) { return link.client().write_memory(address, code); }));
}

/// Loads the program that never ends and starts it.
void run_forever(const UnitBench& bench, Screen& screen) {
  write(bench, 0x041000, kForever);
  (void)press(screen, Key::Name::enter);
  REQUIRE(shows(screen, "It begins with 60FE"));
  (void)letter(screen, 'y');
  REQUIRE(shows(screen, "running 0x041000"));
}

}  // namespace

TEST_CASE("every field that is wrong is named at once") {
  CHECK(program_in("0x041000", "7", "60")->argument == 7);
  const auto wrong = program_in("0x040FFE", "seven", "-1");
  REQUIRE_FALSE(wrong);
  const std::string text = to_text(wrong.error());
  CHECK(contains(text, "start address"));
  CHECK(contains(text, "argument"));
  CHECK(contains(text, "time limit"));
  CHECK_FALSE(program_in("0x041001", "0", "60"));
}

TEST_CASE("a program is run with its argument, and says what it returned") {
  const UnitBench bench;
  bench.wait_for_unit();
  write(bench, 0x041000, kAddFive);
  const auto screen_made = run_screen(bench.controller);
  Screen& screen = *screen_made;
  REQUIRE(shows(screen, "MCM-0107, integration"));
  (void)press(screen, Key::Name::down);
  (void)press(screen, Key::Name::backspace);
  type(screen, "37");
  CHECK(contains(picture(screen), "argument      37"));
  (void)press(screen, Key::Name::enter);
  REQUIRE(shows(screen, "Run the program at 0x041000?"));
  const std::string asked = picture(screen);
  CHECK(contains(asked, "It begins with 5A80 4E75"));
  (void)letter(screen, 'y');
  REQUIRE(shows(screen, "0x041000 returned 42 (0x0000002A, signed 42)"));
  CHECK(contains(picture(screen), "D0 0000002A"));
}

TEST_CASE("empty memory is called empty before it is run; its end is reported with a message") {
  const UnitBench bench;
  bench.wait_for_unit();
  const auto screen_made = run_screen(bench.controller);
  Screen& screen = *screen_made;
  (void)press(screen, Key::Name::enter);
  REQUIRE(shows(screen, "NO PROGRAM lies there"));
  (void)letter(screen, 'n');
  CHECK_FALSE(contains(picture(screen), "NO PROGRAM"));
}

TEST_CASE("a program that never ends is stopped by Esc") {
  const UnitBench bench;
  bench.wait_for_unit();
  const auto screen_made = run_screen(bench.controller);
  Screen& screen = *screen_made;
  run_forever(bench, screen);
  CHECK(press(screen, Key::Name::escape).kind == Step::Kind::stay);
  REQUIRE(shows(screen, "Given up."));
  CHECK_FALSE(contains(picture(screen), "running 0x"));
}

TEST_CASE("a region gives its address, to the program or to the argument") {
  const StateFolder folder;
  const auto screen_made = run_screen(std::make_shared<UnitConnection>("rtu:/dev/no-such-port:9600"));
  Screen& screen = *screen_made;
  for (int k = 0; k < 6; ++k) (void)press(screen, Key::Name::down);
  (void)press(screen, Key::Name::enter);
  CHECK(contains(picture(screen), "argument      0x0E0000"));
}

TEST_CASE("kill -9 of the emulator under a running program: it is said, and the screen goes on when it is back") {
  const UnitBench bench;
  bench.wait_for_unit();
  const auto screen_made = run_screen(bench.controller);
  Screen& screen = *screen_made;
  run_forever(bench, screen);
  CHECK(kill_emulators() == 1);
  REQUIRE(shows(screen, "A program ends with RTS"));
  REQUIRE(shows(screen, "MCM-0107, integration"));
  write(bench, 0x041000, kAddFive);
  (void)press(screen, Key::Name::enter);
  REQUIRE(shows(screen, "It begins with 5A80"));
  (void)letter(screen, 'y');
  REQUIRE(shows(screen, "returned 5 ("));
}
