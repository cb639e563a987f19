// The link: a setting chosen, tried, used and stored; what the doctor says of lines that go wrong.
#include "app/screens/unit/screens.hpp"
#include "commissioning/link/choice.hpp"
#include "tests/screens/support/bad_line.hpp"

namespace ecs::app {
namespace {

using namespace screen_test;

std::string form_text(const std::string& link) { return LinkForm(*parsed_link(link, "test")).text(); }

TEST_CASE("every kind of link goes into the form and comes out the same") {
  for (const char* link :
       {"rtu:/dev/ttyUSB0:9600:8E1:17", "tcp:mill:502:2", "tcp:[::1]:502:1", "tcp:mill:502:2?token=unit.token"}) {
    CAPTURE(link);
    CHECK(form_text(link) == link);
  }
  const std::string machine = sample_machine()->string();
  CHECK(form_text("emulator:" + machine) == "emulator:" + machine);
}

TEST_CASE("choices step round and ports are among them") {
  LinkForm form(*parsed_link("rtu:/dev/ttyUSB0:115200", "test"));
  const std::vector<std::string> ports{"/dev/ttyS0", "/dev/ttyUSB7"};
  form.step(1, 1, ports);
  CHECK(form.text() == "rtu:/dev/ttyS0:115200:8N1:1");
  form.step(1, -1, ports);
  CHECK(form.text() == "rtu:/dev/ttyUSB7:115200:8N1:1");
  form.step(2, 1, ports);
  form.step(3, 1, ports);
  CHECK(form.text() == "rtu:/dev/ttyUSB7:230400:8E1:1");
  form.step(0, 1, ports);
  CHECK(form.kind() == LinkKind::network);
}

/// The setting screen with the form filled in by its keys.
struct LinkCase : StateFolder {
  std::shared_ptr<UnitConnection> unit;
  std::unique_ptr<Screen> made;
  Screen& screen;
  explicit LinkCase(const std::string& link)
      : unit(std::make_shared<UnitConnection>(link)), made(link_screen(unit)), screen(*made) {}
  /// Tries and waits for the end.
  void try_it() {
    REQUIRE(until(screen, [this] { return !contains(picture(screen), "looking for serial ports"); }));
    type(screen, "t");
    REQUIRE(until(screen, [this] {
      const std::string seen = picture(screen);
      return contains(seen, "the link works") || contains(seen, "the link does not work");
    }));
  }
};

TEST_CASE("a port that is not there is named with what to do, and nothing waits for it") {
  LinkCase one("rtu:/dev/no-such-port:9600");
  REQUIRE(shows(one.screen, "NO ANSWER"));
  one.try_it();
  check_holds(picture(one.screen), {"PROBLEM  port:", "-> ", "the link does not work"});
}

TEST_CASE("the form is edited, used, and stored only after a question where it has not answered") {
  LinkCase one("rtu:/dev/no-such-port:9600");
  REQUIRE(until(one.screen, [&] { return !contains(picture(one.screen), "looking"); }));
  (void)one.screen.on_key({Key::Name::mouse, 0, 0, 4, 10});  // the row of the port
  (void)press(one.screen, Key::Name::enter);
  CHECK(one.screen.typing());
  replace_line(one.screen, "/dev/no-other-port");
  CHECK_FALSE(one.screen.typing());
  CHECK(contains(picture(one.screen), "resulting link: rtu:/dev/no-other-port:9600:8N1:1"));
  CHECK(contains(after(one.screen, "s"), "Store a link that has not answered?"));
  type(one.screen, "n");
  CHECK_FALSE(stored_link().value());
  type(one.screen, "sy");
  CHECK(stored_link().value() == "rtu:/dev/no-other-port:9600:8N1:1");
  type(one.screen, "u");
  REQUIRE(until(one.screen, [&] { return one.unit->link() == "rtu:/dev/no-other-port:9600:8N1:1"; }));
  REQUIRE(shows(one.screen, "is in use now"));
  (void)press(one.screen, Key::Name::down);
  (void)press(one.screen, Key::Name::down);
  (void)press(one.screen, Key::Name::down);
  (void)press(one.screen, Key::Name::enter);
  replace_line(one.screen, "999");
  CHECK(contains(after(one.screen, "t"), "999"));
  CHECK_FALSE(contains(picture(one.screen), "cancels"));
}

TEST_CASE("the bundled emulator answers, the doctor says how well, and the statistics count") {
  LinkCase one("emulator");
  REQUIRE(shows(one.screen, "unit MCM-0107 answers"));
  one.try_it();
  check_holds(picture(one.screen), {"20 of 20 reads answered", "the link works"});
  REQUIRE(shows_after(one.screen, "3", "a good link"));
  type(one.screen, "s");
  CHECK(stored_link().value().value().starts_with("emulator"));
}

TEST_CASE("a unit with another number is found, offered and taken") {
  LinkCase one("rtu:/dev/no-such-port:9600");
  const OwnEmulator emulator(one, {"--unit", "3"});
  one.unit->choose("rtu:" + emulator.pty + ":115200");
  const auto screen_made = link_screen(one.unit);
  Screen& screen = *screen_made;
  type(screen, "t");
  REQUIRE(until(screen, [&] {
    type(screen, contains(picture(screen), "tried:") ? "" : "t");
    return contains(picture(screen), "Use the setting that answers?");
  }));
  REQUIRE(shows_after(screen, "y", "unit MCM-0107 answers"));
  CHECK(one.unit->link() == "rtu:" + emulator.pty + ":115200:8N1:3");
  CHECK(contains(picture(screen), "unit number: unit 3 answers, unit 1 does not"));
  type(screen, "s");
  CHECK(stored_link().value() == one.unit->link());
}

TEST_CASE("a link that returns what is sent is called an echo") {
  const BadLine echo("");
  LinkCase one("rtu:" + echo.device + ":9600");
  one.try_it();
  CHECK(contains(picture(one.screen), "PROBLEM  echo: the link echoes the sent bytes"));
}

TEST_CASE("the right speed is found and offered where another was set") {
  LinkCase one("rtu:/dev/no-such-port:9600");
  const OwnEmulator emulator(one, {});
  const BadLine slow(emulator.pty, B9600);
  one.unit->choose("rtu:" + slow.device + ":115200");
  const auto screen_made = link_screen(one.unit);
  Screen& screen = *screen_made;
  REQUIRE(until(screen, [&] { return !contains(picture(screen), "looking for serial"); }));
  REQUIRE(shows_after(screen, "t", "Use the setting that answers?"));
  CHECK(contains(after(screen, "n"), "9600 baud, parity N, not at 115200"));
}

TEST_CASE("late and garbled answers are reported with their causes, and the statistics judge them") {
  LinkCase one("rtu:/dev/no-such-port:9600");
  const OwnEmulator emulator(one, {});
  one.unit->choose("rtu:" + emulator.pty + ":115200");
  const auto screen_made = link_screen(one.unit);
  Screen& screen = *screen_made;
  REQUIRE(shows(screen, "unit MCM-0107 answers"));
  OwnEmulator::fault(one, "stale_reply --probability 0.15");
  REQUIRE(shows_after(screen, "t", "late answers"));
  REQUIRE(shows(screen, "the link works"));
  OwnEmulator::fault(one, "clear");
  OwnEmulator::fault(one, "bad_crc --probability 0.3");
  REQUIRE(shows_after(screen, "3", "many garbled answers"));
}

TEST_CASE("the doctor's checks can be cancelled") {
  LinkCase one("rtu:/dev/no-such-port:9600");
  const OwnEmulator emulator(one, {"--unit", "99"});
  one.unit->choose("rtu:" + emulator.pty + ":115200");
  const auto screen_made = link_screen(one.unit);
  Screen& screen = *screen_made;
  REQUIRE(until(screen, [&] { return !contains(picture(screen), "looking for serial"); }));
  REQUIRE(shows_after(screen, "t", "trying unit numbers"));
  CHECK(press(screen, Key::Name::escape).kind == Step::Kind::stay);
  REQUIRE(shows(screen, "cancelled"));
  CHECK(press(screen, Key::Name::escape).kind == Step::Kind::back);
}

TEST_CASE("the link screen reports a killed emulator and its return") {
  LinkCase one("emulator");
  REQUIRE(shows(one.screen, "unit MCM-0107 answers"));
  REQUIRE(kill_emulators() == 1);
  REQUIRE(until(one.screen, [&] { return one.unit->snapshot().times_lost > 0; }));
  REQUIRE(shows(one.screen, "unit MCM-0107 answers"));
  REQUIRE(shows_after(one.screen, "3", "lost and reopened"));
}

TEST_CASE("an emulator that a thread started outlives the thread, and goes with the last that holds it") {
  const StateFolder one;
  const auto choice = must(parsed_link("emulator", "test"));
  std::shared_ptr<EmulatorProcess> emulator;
  std::thread([&] { emulator = open_link(choice)->emulator(); }).join();
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  CHECK(emulator->running());
  CHECK(open_link(choice)->client().identity());
}

TEST_CASE("the link screen fits any size") {
  LinkCase one("rtu:/dev/no-such-port:9600");
  for (const char* page : {"1", "2", "3"}) {
    type(one.screen, page);
    check_fits(one.screen);
  }
}

TEST_CASE("no word of the statistics is cut at 80 columns") {
  WatchedUnit unit;
  protocol::LinkStatistics& s = unit.statistics;
  s.retries = s.timeouts = s.crc_errors = s.stale_replies = s.exceptions = unit.times_lost = 123'456'789;
  s.replies = 1;
  s.worst_round_trip_ms = 1e6;
  for (const StatisticsRow& row : statistics_rows(unit)) CHECK(31 + width_of(row.meaning) <= 78);
}

TEST_CASE("the statistics say in plain words what high numbers mean") {
  WatchedUnit unit;
  unit.open = true;
  unit.statistics.requests = 1000;
  unit.statistics.replies = 1000;
  CHECK(contains(judgement(unit).meaning, "a good link"));
  unit.statistics.retries = 2;
  CHECK(contains(judgement(unit).meaning, "a good link"));
  unit.statistics.timeouts = 20;
  CHECK(contains(judgement(unit).meaning, "plugs and cable"));
  unit.statistics.stale_replies = 20;
  CHECK(contains(judgement(unit).meaning, "latency timer"));
  unit.statistics.crc_errors = 20;
  CHECK(contains(judgement(unit).meaning, "shield"));
  unit.open = false;
  unit.problem = "no such port";
  CHECK(judgement(unit).meaning == "no such port");
}

}  // namespace
}  // namespace ecs::app
