// SET AXIS POSITION, OUTPUT COMPENSATION VALUE and driving on the emulated unit.
#include "app/screens/unit/screens.hpp"
#include "app/screens/utility/screens.hpp"
#include "commissioning/unit/utility_work.hpp"
#include "commissioning/utility/unit_view.hpp"
#include "tests/screens/support/unit_screen.hpp"
#include "tests/screens/support/utility_bench.hpp"

namespace ecs::app {
namespace {

using namespace screen_test;

TEST_CASE("a position that is not a number, or too far away, is refused before the unit is asked") {
  const StateFolder folder;
  const auto screen_made = position_screen(no_link());
  Screen& screen = *screen_made;
  (void)press(screen, Key::Name::enter);
  enter(screen, "12,5");
  CHECK(contains(picture(screen), "expected a position in mm, found"));
  replace_line(screen, "1000001");
  CHECK(contains(picture(screen), "expected a position within"));
  replace_line(screen, "-1000000");
  CHECK(contains(picture(screen), "Let the unit show -1000000.0000 mm for axis X?"));
}

TEST_CASE("a position is typed, confirmed, set, shown live and undone") {
  const BenchOf bench(position_screen);
  Screen& screen = *bench.screen;
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
  const BenchOf bench(position_screen);
  Screen& screen = *bench.screen;
  (void)press(screen, Key::Name::enter);
  type(screen, "5");
  (void)press(screen, Key::Name::enter);
  (void)letter(screen, 'n');
  CHECK_FALSE(contains(picture(screen), "Let the unit show"));
  CHECK(bench.controller->newest()->axes[0].position_mm == doctest::Approx(0.0));
}

TEST_CASE("kill -9 of the emulator while positions are set: it is said, and the next one works again") {
  const BenchOf bench(position_screen);
  Screen& screen = *bench.screen;
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

/// Nothing is put out yet.
void close_relay(Screen& screen) {
  REQUIRE(shows(screen, "MCM-0107, integration"));
  (void)letter(screen, 'r');
  (void)letter(screen, 'y');
  REQUIRE(shows(screen, "RELAY CLOSED"));
}

TEST_CASE("the output scale follows from what was put out and what a gauge showed") {
  AxisParameters axis;
  axis.output_scale_counts_per_um = 10.0;
  // 20 um put out are 200 counts; they moved 16 um: 12.5 counts a um
  const auto short_of = scale_from(axis, Axis::X, 20.0, 16.0);
  REQUIRE(short_of);
  CHECK(short_of->counts_per_um == doctest::Approx(12.5));
  CHECK(short_of->polarity == 1);
  CHECK(contains(short_of->sentence, "12.5 counts/um"));
  const auto turned = scale_from(axis, Axis::X, 20.0, -40.0);
  REQUIRE(turned);
  CHECK(turned->counts_per_um == doctest::Approx(5.0));
  CHECK(turned->polarity == -1);
  CHECK_FALSE(scale_from(axis, Axis::X, 0.0, 3.0));
  const auto stuck = scale_from(axis, Axis::X, 20.0, 0.1);
  REQUIRE_FALSE(stuck);
  CHECK(contains(stuck.error().message, "does not follow"));
}

TEST_CASE("with the relay open a value is output at once; beyond the limit it is refused with the reason") {
  const BenchOf bench(output_screen);
  Screen& screen = *bench.screen;
  REQUIRE(shows(screen, "MCM-0107, integration"));
  (void)press(screen, Key::Name::enter);
  type(screen, "600");
  (void)press(screen, Key::Name::enter);
  CHECK(contains(picture(screen), "beyond the output limit of axis X, 500 um"));
  CHECK(contains(picture(screen), "600"));  // it stays for correction
  clear_line(screen);
  type(screen, "12.5");
  (void)press(screen, Key::Name::enter);
  REQUIRE(shows(screen, "+12.5 um at the converter of X, nothing moves"));
  REQUIRE(shows(screen, "125 counts"));
  (void)letter(screen, 'y');
  CHECK(contains(picture(screen), "press o first"));
  (void)letter(screen, 'o');
  REQUIRE(shows(screen, "Every output is 0, every relay is open."));
}

TEST_CASE("the relay is asked for, the axis moves, steps go on, one key ends everything") {
  const BenchOf bench(output_screen);
  Screen& screen = *bench.screen;
  REQUIRE(shows(screen, "MCM-0107, integration"));
  (void)letter(screen, '>');
  (void)letter(screen, '>');
  CHECK(contains(picture(screen), "step 5 um"));
  (void)letter(screen, '+');
  REQUIRE(shows(screen, "+5 um at the converter of X"));
  (void)letter(screen, 'r');
  const std::string asked = picture(screen);
  CHECK(contains(asked, "Move axis X by +5 um?"));
  CHECK(contains(asked, "larger coordinates)"));
  (void)letter(screen, 'y');
  REQUIRE(shows(screen, "RELAY CLOSED     axis X is moved by +5 um"));
  REQUIRE(shows(screen, "moved          +5"));
  (void)letter(screen, '+');
  REQUIRE(shows(screen, "axis X is moved by +10 um"));
  REQUIRE(shows(screen, "moved         +10"));
  (void)letter(screen, 'm');
  CHECK(contains(picture(screen), "Measured movement of X, um: 10.00"));
  (void)press(screen, Key::Name::enter);
  CHECK(contains(picture(screen), "scale and polarity are right"));
  CHECK(bench.controller->newest()->axes[0].relay_closed);
  CHECK(press(screen, Key::Name::escape).kind == Step::Kind::stay);
  REQUIRE(shows(screen, "nothing is put out, nothing moves"));
  CHECK(press(screen, Key::Name::escape).kind == Step::Kind::back);
}

TEST_CASE("a relay that the unit opens for another reason is seen") {
  const BenchOf bench(output_screen);
  Screen& screen = *bench.screen;
  close_relay(screen);
  REQUIRE(bench.with_link([](UnitLink& link) { return link.client().output_off(); }));
  REQUIRE(shows(screen, "The unit has opened the relay by itself"));
  CHECK(contains(picture(screen), "RELAY OPEN       nothing is put out"));
}

TEST_CASE("what another host puts out is shown, and steps go on from there") {
  const BenchOf bench(output_screen);
  Screen& screen = *bench.screen;
  close_relay(screen);
  REQUIRE(bench.with_link([](UnitLink& link) { return link.client().output_compensation(Axis::X, 30.0, true); }));
  REQUIRE(shows(screen, "Another host has changed the output of axis X: +30 um now"));
  CHECK(contains(picture(screen), "axis X is moved by +30 um"));
  (void)letter(screen, '+');
  REQUIRE(shows(screen, "axis X is moved by +31 um"));
  const auto seen = bench.with_link([](UnitLink& link) { return link.client().monitor(); });
  REQUIRE(seen);
  CHECK(seen->axes[0].compensation_um == doctest::Approx(31.0).epsilon(0.01));
}

TEST_CASE("a unit that lacks what it had run was started again; one that is as much later as time passed was not") {
  using std::chrono::milliseconds;
  const auto at = [](double s) {
    protocol::MonitorSample sample;
    sample.unit_time_us = static_cast<std::uint64_t>(1e6 * s);
    return sample;
  };
  CHECK_FALSE(began_anew(at(5.0), at(5.1), milliseconds(100)));
  CHECK_FALSE(began_anew(at(5.0), at(65.0), milliseconds(60'000)));
  CHECK_FALSE(began_anew(at(5.0), at(5.1), milliseconds(900)));  // the answer waited in a buffer
  CHECK(began_anew(at(5.0), at(0.4), milliseconds(2'000)));      // its clock stands lower
  CHECK(began_anew(at(0.5), at(7.0), milliseconds(8'000)));      // or higher: it was away for longer than it had run
  CHECK_FALSE(began_anew(at(0.5), at(8.5), milliseconds(8'000)));
}

TEST_CASE("leaving by any way opens the relay") {
  const UnitBench bench;
  bench.wait_for_unit();
  {
    const auto screen_made = output_screen(bench.controller);
    Screen& screen = *screen_made;
    close_relay(screen);
  }
  const auto after = bench.with_link([](UnitLink& link) { return link.client().monitor(); });
  REQUIRE(after);
  CHECK_FALSE(after->axes[0].relay_closed);
}

TEST_CASE("kill -9 of the emulator with the relay closed: it is said, and everything is off when it is back") {
  const BenchOf bench(output_screen);
  Screen& screen = *bench.screen;
  close_relay(screen);
  bench.wait_until_it_ran(std::chrono::seconds(1));
  CHECK(kill_emulators() == 1);
  REQUIRE(shows(screen, "The link is lost"));
  REQUIRE(shows(screen, "The unit was restarted: every output is 0"));
  REQUIRE(shows(screen, "RELAY OPEN"));
  (void)letter(screen, '+');
  REQUIRE(shows(screen, "um at the converter of X"));
}

TEST_CASE("what is typed to drive the emulated machine is a jog, a block or a program") {
  CHECK(drive_request("x-100 Y=50 f2000").value() == R"({"action":"jog","X":-100.0,"Y":50.0,"feed":2000.0})");
  CHECK(drive_request("G01 X-100 F2000").value() == R"({"action":"mdi","block":"G01 X-100 F2000"})");
  CHECK(contains(drive_request("samples/mill/appendix_b.nc").value(), R"("action":"run")"));
  for (const char* wrong : {"", "F2000", "fast", "X", "no-such.nc"}) CHECK_FALSE(drive_request(wrong));
}

TEST_CASE("j on the monitor drives the emulated machine, and what is no place is refused and stays") {
  const BenchOf bench(monitor_screen);
  Screen& screen = *bench.screen;
  REQUIRE(shows(screen, "no fault"));
  type(screen, "j");
  enter(screen, "over there");
  CHECK(contains(picture(screen), "expected axes with their machine coordinates"));
  replace_line(screen, "X-20 F3000");
  REQUIRE(shows(screen, "stands at X -"));
}

}  // namespace
}  // namespace ecs::app
