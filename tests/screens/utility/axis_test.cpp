// SET AXIS POSITION, OUTPUT COMPENSATION VALUE and driving on the emulated unit.
#include "app/screens/unit/screens.hpp"
#include "app/screens/utility/screens.hpp"
#include "commissioning/unit/transfer.hpp"
#include "commissioning/unit/utility_work.hpp"
#include "commissioning/utility/unit_view.hpp"
#include "tests/screens/support/unit_screen.hpp"
#include "tests/screens/support/utility_bench.hpp"
#include "tests/support/unit_model.hpp"

namespace ecs::app {
namespace {

using namespace screen_test;

TEST_CASE("a position that is not a number, or too far away, is refused before the unit is asked") {
  const StateFolder folder;
  const auto screen_made = position_screen(no_link());
  Screen& screen = *screen_made;
  CHECK(contains(after(screen, "\n12,5\n"), "expected a position in mm, found"));
  replace_line(screen, "1000001");
  CHECK(contains(picture(screen), "expected a position within"));
  replace_line(screen, "-1000000");
  CHECK(contains(picture(screen), "Show -1000000.0000 mm for axis X?"));
}

TEST_CASE("a position is typed, confirmed, set, shown live and undone") {
  const BenchOf bench(position_screen);
  Screen& screen = *bench.screen;
  REQUIRE(shows(screen, "unit MCM-0107, integration"));
  type(screen, "y\n");
  CHECK(screen.typing());
  CHECK(contains(after(screen, "-123.5"), "New position of Y, mm: -123.5"));
  const std::string asked = after(screen, "\n");
  check_holds(asked, {"Show -123.5000 mm for axis Y?", "Nothing moves"});
  REQUIRE(shows_after(screen, "y", "Axis Y now shows -123.5000 mm; it showed 0.0000 mm."));
  CHECK(shows(screen, "Y        -123.5000"));
  (void)picture(screen);
  REQUIRE(shows_after(screen, "u", "Axis Y is back at 0.0000 mm"));
  CHECK(shows(screen, "Y           0.0000"));
}

TEST_CASE("with imperial parameters positions are shown and typed in inches, and the unit counts in mm") {
  const UnitBench bench;
  bench.wait_for_unit();
  auto file = must(params::read_parameters("samples/mill/parameters.toml"));
  file.parameters.measurement_system = MeasurementSystem::imperial;
  REQUIRE(bench.with_link([&](UnitLink& link) { return send_parameters(link.client(), file.parameters, {}); }));
  const auto screen_made = position_screen(bench.controller);
  Screen& screen = *screen_made;
  REQUIRE(shows(screen, "position in"));
  CHECK(contains(picture(screen), "in/min"));
  (void)after(screen, "y\n");
  CHECK(contains(after(screen, "-10"), "New position of Y, in: -10"));
  CHECK(contains(after(screen, "\n"), "Show -10.00000 in for axis Y?"));
  REQUIRE(shows_after(screen, "y", "Axis Y now shows -10.00000 in; it showed 0.00000 in."));
  CHECK(shows(screen, "Y        -10.00000"));
  const auto sample = must(bench.with_link([](UnitLink& link) { return link.client().monitor(); }));
  CHECK(sample.axes[1].position_mm == Approx(-254.0));
  const auto monitor = monitor_screen(bench.controller);
  CHECK(shows(*monitor, "Y   -10.00000      0.00"));
}

TEST_CASE("answering no sets nothing") {
  const BenchOf bench(position_screen);
  Screen& screen = *bench.screen;
  CHECK_FALSE(contains(after(screen, "\n5\nn"), "Show"));
  CHECK(bench.controller->newest()->axes[0].position_mm == Approx(0.0));
}

TEST_CASE("kill -9 of the emulator while positions are set: it is said, and the next one works again") {
  const BenchOf bench(position_screen);
  Screen& screen = *bench.screen;
  const auto set = [&](const std::string& mm) {
    (void)press(screen, Key::Name::enter);
    type(screen, mm);
    type(screen, "\ny");
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
  REQUIRE(shows_after(screen, "ry", "RELAY CLOSED"));
}

TEST_CASE("the output scale follows from what was put out and what a gauge showed") {
  AxisParameters axis;
  axis.output_scale_counts_per_um = 10.0;
  // 20 um put out are 200 counts; they moved 16 um: 12.5 counts a um
  const auto short_of = must(scale_from(axis, Axis::X, 20.0, 16.0));
  CHECK(short_of.counts_per_um == Approx(12.5));
  CHECK(short_of.polarity == 1);
  CHECK(contains(short_of.sentence, "12.5 counts/um"));
  const auto turned = must(scale_from(axis, Axis::X, 20.0, -40.0));
  CHECK(turned.counts_per_um == Approx(5.0));
  CHECK(turned.polarity == -1);
  CHECK_FALSE(scale_from(axis, Axis::X, 0.0, 3.0));
  CHECK(contains(must_fail(scale_from(axis, Axis::X, 20.0, 0.1)).message, "does not follow"));
}

TEST_CASE("with the relay open a value is output at once; beyond the limit it is refused with the reason") {
  const BenchOf bench(output_screen);
  Screen& screen = *bench.screen;
  REQUIRE(shows(screen, "MCM-0107, integration"));
  CHECK(contains(after(screen, "\n600\n"), "beyond the output limit of axis X, 500 um"));
  CHECK(contains(picture(screen), "600"));  // it stays for correction
  clear_line(screen);
  REQUIRE(shows_after(screen, "12.5\n", "+12.5 um at the converter of X, nothing moves"));
  REQUIRE(shows(screen, "125 counts"));
  CHECK(contains(after(screen, "y"), "press o first"));
  REQUIRE(shows_after(screen, "o", "Every output is 0, every relay is open."));
}

TEST_CASE("the relay is asked for, the axis moves, steps go on, one key ends everything") {
  const BenchOf bench(output_screen);
  Screen& screen = *bench.screen;
  REQUIRE(shows(screen, "MCM-0107, integration"));
  const std::string zero = after(screen, "r");  // a frame divides its sentences
  check_holds(zero, {"Close the relay of axis X?", "plus", "offset"});
  CHECK_FALSE(contains(zero, "shows)"));
  (void)after(screen, "n");
  CHECK(contains(after(screen, ">>"), "step 5 um"));
  REQUIRE(shows_after(screen, "+", "+5 um at the converter of X"));
  const std::string asked = after(screen, "r");
  check_holds(asked, {"Move axis X by +5 um?", "larger coordinates)"});
  REQUIRE(shows_after(screen, "y", "RELAY CLOSED     axis X is moved by +5 um"));
  REQUIRE(shows(screen, "moved          +5"));
  REQUIRE(shows_after(screen, "+", "axis X is moved by +10 um"));
  REQUIRE(shows(screen, "moved         +10"));
  CHECK(contains(after(screen, "m"), "Measured movement of X, um: 10.00"));
  CHECK(contains(after(screen, "\n"), "scale and polarity are correct"));
  CHECK(bench.controller->newest()->axes[0].relay_closed);
  CHECK(press(screen, Key::Name::escape).kind == Step::Kind::stay);
  REQUIRE(shows(screen, "no output, nothing moves"));
  CHECK(press(screen, Key::Name::escape).kind == Step::Kind::back);
}

TEST_CASE("a relay that the unit opens for another reason is seen") {
  const BenchOf bench(output_screen);
  Screen& screen = *bench.screen;
  close_relay(screen);
  REQUIRE(bench.with_link([](UnitLink& link) { return link.client().output_off(); }));
  REQUIRE(shows(screen, "The unit has opened the relay:"));
  CHECK(contains(picture(screen), "RELAY OPEN       no output"));
}

TEST_CASE("what another host puts out is shown, and steps go on from there") {
  const BenchOf bench(output_screen);
  Screen& screen = *bench.screen;
  close_relay(screen);
  REQUIRE(bench.with_link([](UnitLink& link) { return link.client().output_compensation(Axis::X, 30.0, true); }));
  REQUIRE(shows(screen, "Another host has changed the output of axis X: +30 um now"));
  CHECK(contains(picture(screen), "axis X is moved by +30 um"));
  REQUIRE(shows_after(screen, "+", "axis X is moved by +31 um"));
  const auto seen = must(bench.with_link([](UnitLink& link) { return link.client().monitor(); }));
  CHECK(seen.axes[0].compensation_um == Approx(31.0).epsilon(0.01));
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
  CHECK_FALSE(must(bench.with_link([](UnitLink& link) { return link.client().monitor(); })).axes[0].relay_closed);
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
  REQUIRE(shows_after(screen, "+", "um at the converter of X"));
}

TEST_CASE("what is typed to drive the emulated machine is a jog, a block or a program") {
  CHECK(drive_request("x-100 Y=50 f2000").value() == R"({"action":"jog","X":-100.0,"Y":50.0,"feed":2000.0})");
  CHECK(drive_request("G01 X-100 F2000").value() == R"({"action":"mdi","block":"G01 X-100 F2000"})");
  CHECK(contains(drive_request("samples/mill/appendix_b.nc").value(), R"("action":"run")"));
  for (const char* wrong : {"", "F2000", "fast", "X", "no-such.nc"}) CHECK_FALSE(drive_request(wrong));
}

/// What table and box say of the relay of X, or "differ".
std::string relay_of_x(const std::string& seen) {
  const std::size_t row = seen.find("> X ");
  const bool closed = contains(seen.substr(row, seen.find('\n', row) - row), " CLOSED");
  return contains(seen, "RELAY CLOSED") != closed ? "differ" : (closed ? "closed" : "open");
}

TEST_CASE("the box agrees with the relays of the newest sample while the unit begins and ends to compensate") {
  const UnitBench bench;
  bench.wait_for_unit();
  give_map(*bench.controller, bench.folder);
  const auto screen_made = output_screen(bench.controller);
  Screen& screen = *screen_made;
  std::string last;
  const auto becomes = [&](const std::string& wanted) {
    return until(screen,
                 [&] {
                   last = relay_of_x(picture(screen));
                   return last == wanted || last == "differ";
                 }) &&
           last == wanted;
  };
  REQUIRE(shows(screen, "MCM-0107, integration"));
  REQUIRE(becomes("open"));
  REQUIRE(bench.with_link([](UnitLink& link) { return link.client().enter_compensation(); }));
  REQUIRE(shows(screen, "MCM-0107, referencing"));
  REQUIRE(becomes("open"));
  TaskRunner referencing;
  Message failed;
  reference_machine(referencing, bench.controller->snapshot().workshop, {}, failed);
  REQUIRE(becomes("closed"));
  CHECK(contains(picture(screen), ", its compensation"));
  REQUIRE(bench.with_link([](UnitLink& link) { return link.client().enter_integration(); }));
  CHECK(becomes("open"));
}

TEST_CASE("a motion that the machine refuses stays open for correction") {
  const BenchOf bench(monitor_screen);
  Screen& screen = *bench.screen;
  REQUIRE(shows(screen, "no fault"));
  REQUIRE(shows_after(screen, "jX-9000 F2000\n", "-9000"));
  REQUIRE(until(screen, [&] { return screen.typing(); }));
  CHECK(contains(picture(screen), "Drive to: X-9000 F2000"));
  replace_line(screen, "X-20 F3000");
  REQUIRE(shows(screen, "is at X -"));
}

TEST_CASE("the monitor says of which axes the positions are not machine coordinates") {
  const BenchOf bench(monitor_screen);
  CHECK(shows(*bench.screen, "X, Y, Z not referenced: counted from switch-on, or from the position entered"));
}

TEST_CASE("j on the monitor drives the emulated machine, and what is no place is refused and stays") {
  const BenchOf bench(monitor_screen);
  Screen& screen = *bench.screen;
  REQUIRE(shows(screen, "no fault"));
  CHECK(contains(after(screen, "jover there\n"), "expected axes with their machine coordinates"));
  replace_line(screen, "X-20 F3000");
  REQUIRE(shows(screen, "is at X -"));
}

TEST_CASE("the monitor has a row for the rotary axes of the map, within 80 columns") {
  auto shop = protocol::Workshop::on_tcp();
  shop.in_model([](protocol::UnitModel& model) {
    model.mode = UnitMode::compensating;
    model.turning = {{-12.5, 0.5, 3.0},
                     {{{'A', true, -110.0004, Approach::reverse}, {'C', true, 359.5, Approach::forward}}}};
  });
  const auto monitor = monitor_screen(std::make_shared<UnitConnection>(protocol::to_text(shop.address())));
  CHECK(shows(*monitor, "A -110.000 deg reverse C 359.500 deg forward add X -12.5 Y +0.5 Z +3.0 um"));
  check_fits(*monitor);
  shop.in_model([](protocol::UnitModel& model) { model.turning.axes[1].sensed = false; });
  CHECK(shows(*monitor, "C without signal"));
}

TEST_CASE("the monitor shows the temperatures and the load that the unit was given") {
  const BenchOf bench(monitor_screen);
  REQUIRE(bench.with_link([](UnitLink& link) { return link.client().set_input(2, 24.5); }));
  REQUIRE(bench.with_link([](UnitLink& link) { return link.client().set_input(kLoadInput, 800.0); }));
  CHECK(shows(*bench.screen, "inputs   3: 24.50 degC   load: 800.00 kg"));
}

}  // namespace
}  // namespace ecs::app
