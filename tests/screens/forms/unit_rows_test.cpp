// Rows of the table of forms that work on the unit: RUN USER SOFTWARE, ARM THE UNIT.
#include "app/screens/forms/rows.hpp"
#include "tests/screens/support/bad_line.hpp"
#include "tests/screens/support/utility_bench.hpp"

namespace ecs::app {
namespace {

using namespace screen_test;

const std::vector<std::uint8_t> kAddFive{0x5A, 0x80, 0x4E, 0x75};  // addq.l #5,d0; rts
const std::vector<std::uint8_t> kForever{0x60, 0xFE};              // bra to itself

void write(const UnitBench& bench, Address address, const std::vector<std::uint8_t>& code) {
  REQUIRE(bench.with_link([&](UnitLink& link) { return link.client().write_memory(address, code); }));
}

std::unique_ptr<Screen> run_screen(const UnitBench& bench, const FormValues& values = {}) {
  return form_titled("RUN USER SOFTWARE", bench.controller, values);
}

/// Loads the program that never ends and starts it.
std::unique_ptr<Screen> running_forever(const UnitBench& bench) {
  write(bench, 0x041000, kForever);
  auto screen = run_screen(bench);
  REQUIRE(shows_after(*screen, "\n", "It begins with 60FE"));
  REQUIRE(shows_after(*screen, "y", "running, "));
  return screen;
}

TEST_CASE("a program is run with its argument after a question, and says what it returned") {
  const UnitBench bench;
  bench.wait_for_unit();
  const auto screen = run_screen(bench, {{"--argument", "37"}});
  CHECK(contains(picture(*screen), "memory seen by a program"));
  REQUIRE(shows_after(*screen, "\n", "NO PROGRAM at this address"));
  CHECK_FALSE(contains(after(*screen, "n"), "NO PROGRAM"));
  write(bench, 0x041000, kAddFive);
  REQUIRE(shows_after(*screen, "\n", "Run the program at 0x041000?"));
  CHECK(contains(picture(*screen), "It begins with 5A80 4E75"));
  REQUIRE(shows_after(*screen, "y", "the program at 0x041000 returned 42 (0x0000002A)"));
  CHECK(contains(picture(*screen), "D0 0000002A"));
}

TEST_CASE("what a program returned is shown with a sign too") {
  const UnitBench bench;
  bench.wait_for_unit();
  const auto screen = run_screen(bench, {{"--argument", "0xFFFFFFF6"}});  // -10
  write(bench, 0x041000, kAddFive);
  REQUIRE(shows_after(*screen, "\n", "Run the program at 0x041000?"));
  (void)letter(*screen, 'y');
  CHECK_MESSAGE(shows(*screen, "signed -5"), picture(*screen));
}

TEST_CASE("Tab gives the addresses of the regions to the argument, a field that is wrong is named") {
  const StateFolder folder;
  const auto screen = form_titled("RUN USER SOFTWARE", no_link());
  (void)press(*screen, Key::Name::down);
  for (int k = 0; k < 4; ++k) (void)press(*screen, Key::Name::tab);
  CHECK(contains(picture(*screen), "0x0E0000"));
  replace_line(*screen, "seven");
  CHECK(shows(*screen, "--argument: expected a whole number"));
}

TEST_CASE("a program that never ends is stopped by Esc, and says so where the emulator is killed under it") {
  const UnitBench bench;
  bench.wait_for_unit();
  const auto screen = running_forever(bench);
  SUBCASE("Esc") {
    CHECK(press(*screen, Key::Name::escape).kind == Step::Kind::stay);
    REQUIRE(until(*screen, [&] { return !contains(picture(*screen), "running, "); }));
    CHECK_MESSAGE(contains(picture(*screen), "link or unit failed"), picture(*screen));
  }
  SUBCASE("kill -9") {
    CHECK(kill_emulators() == 1);
    REQUIRE(shows(*screen, "link or unit failed"));
    REQUIRE(until(*screen, [&] { return bench.controller->snapshot().open; }));
    write(bench, 0x041000, kAddFive);
    REQUIRE(shows_after(*screen, "\n", "It begins with 5A80"));
    REQUIRE(shows_after(*screen, "y", "returned 5 ("));
  }
}

/// A unit whose code the program does not know.
struct UnarmedCase : StateFolder {
  OwnEmulator emulator{*this, {"--mode", "integrate"}};
  std::shared_ptr<UnitConnection> unit;
  UnarmedCase() {
    ::unsetenv("ECS_ARM_CODE");
    unit = std::make_shared<UnitConnection>("rtu:" + emulator.pty + ":115200");
    for (int k = 0; k < 3000 && !unit->newest(); ++k) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    REQUIRE(unit->newest());  // it answers: what is refused after this is not for want of a line
  }
  UnarmedCase(const UnarmedCase&) = delete;
  UnarmedCase& operator=(const UnarmedCase&) = delete;
  ~UnarmedCase() { ::setenv("ECS_ARM_CODE", kArmCode.c_str(), 1); }
  [[nodiscard]] Result<void> preset() const {
    JobControl control;
    return unit->with_link(control, [](UnitLink& link) { return link.client().set_axis_position(Axis::X, 1.0); });
  }
};

TEST_CASE("what the unit refuses for want of its code opens the question for it, and goes afterwards") {
  const UnarmedCase bench;
  CHECK(arm_screen_if_wanted(bench.unit) == nullptr);
  CHECK(must_fail(bench.preset()).kind == ProblemKind::refused);
  CHECK(bench.unit->snapshot().wants_code);
  const auto question = arm_screen_if_wanted(bench.unit);
  REQUIRE(question != nullptr);
  CHECK(arm_screen_if_wanted(bench.unit) == nullptr);  // asked once
  CHECK(reads(picture(*question), "The unit is read-only for this host"));
  CHECK(shows_after(*question, "314159\n", "this is not the code shown by the unit"));
  for (int k = 0; k < 50 && !contains(picture(*question), "accepts writes and"); ++k) {  // a second of the unit's clock
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    replace_line(*question, kArmCode);
    CHECK(until(*question, [&] { return !question->advance(); }));
  }
  CHECK(reads(picture(*question), "the unit accepts writes and commands from this host for 30 minutes"));
  CHECK(press(*question, Key::Name::enter).kind == Step::Kind::back);
  CHECK(bench.preset().has_value());
}

TEST_CASE("Esc leaves the unit read-only") {
  const UnarmedCase bench;
  CHECK_FALSE(bench.preset().has_value());
  const auto question = arm_screen_if_wanted(bench.unit);
  REQUIRE(question != nullptr);
  CHECK(press(*question, Key::Name::escape).kind == Step::Kind::back);
  CHECK_FALSE(bench.preset().has_value());
}

}  // namespace
}  // namespace ecs::app
