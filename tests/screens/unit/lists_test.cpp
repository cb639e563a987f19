// The log: what the screens told, whole, found again and copied.
// COMMANDS: what was done, copied, written as a script.
#include "app/screens/unit/screens.hpp"
#include "base/file.hpp"
#include "commissioning/session/commands.hpp"
#include "commissioning/session/message.hpp"
#include "tests/screens/support/unit_screen.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/screen_driver.hpp"

namespace ecs::app {
namespace {

using namespace screen_test;

TEST_CASE("the log follows the newest message and shows a long one completely") {
  const StateFolder one;
  const auto screen_made = log_screen();
  Screen& screen = *screen_made;
  log_event(Tone::good, "parameters sent");
  std::string error = "the unit does not answer";
  for (int k = 0; k < 20; ++k) error += " word" + std::to_string(k);
  log_event(Tone::bad, error);
  REQUIRE(screen.advance());
  CHECK_FALSE(screen.advance());
  const std::string text = picture(screen);
  check_holds(text, {"parameters sent", "ERROR", "word19", "new ones are shown as they come"});
  CHECK(contains(text, (one.path / "state" / "screens.log").string()));
}

TEST_CASE("errors alone are shown on e, any message is found by a part of it, and a copy is saved") {
  const StateFolder one;
  log_event(Tone::bad, "first trouble");
  log_event(Tone::good, "Quite well");
  log_event(Tone::bad, "second trouble");
  const auto screen_made = log_screen();
  Screen& screen = *screen_made;
  CHECK_FALSE(contains(after(screen, "e"), "Quite well"));
  CHECK(contains(picture(screen), "errors only"));
  type(screen, "e/");
  CHECK(screen.typing());
  replace_line(screen, "quite");
  CHECK(contains(picture(screen), "> "));
  CHECK_FALSE(contains(picture(screen), "new ones are shown as they come"));
  log_event(Tone::good, "a later one");
  (void)screen.advance();
  CHECK_FALSE(contains(picture(screen), "new ones are shown as they come"));
  type(screen, "/");
  replace_line(screen, "no such words at all");
  CHECK(contains(picture(screen), "is in no message"));
  (void)press(screen, Key::Name::end);
  CHECK(contains(picture(screen), "new ones are shown as they come"));
  (void)screen.on_key({Key::Name::mouse, 0, 0, 3, 10});  // the first row of the list
  CHECK_FALSE(contains(picture(screen), "new ones are shown as they come"));
  type(screen, "s");
  const std::string copy = (one.path / "copy.txt").string();
  replace_line(screen, copy);
  CHECK(contains(picture(screen), "written to"));
  CHECK(contains(read_file(copy).value(), "second trouble"));
  type(screen, "s");
  replace_line(screen, copy);
  CHECK(contains(picture(screen), "Replace "));
  type(screen, "n");
  CHECK(press(screen, Key::Name::escape).kind == Step::Kind::back);
}

TEST_CASE("with the emulator killed the log continues, and the unit returns") {
  const StateFolder one;
  const auto unit = std::make_shared<UnitConnection>("emulator");
  const auto screen_made = log_screen();
  Screen& screen = *screen_made;
  REQUIRE(until(screen, [&] { return unit->snapshot().open; }));
  REQUIRE(kill_emulators() == 1);
  REQUIRE(until(screen, [&] { return unit->snapshot().times_lost > 0; }));
  log_event(Tone::bad, "told while the unit was away");
  REQUIRE(shows(screen, "told while the unit was away"));
  REQUIRE(until(screen, [&] { return unit->snapshot().open; }));
}

TEST_CASE("the log fits any size") {
  const StateFolder one;
  log_event(Tone::bad, std::string(3000, 'x') + "\nsecond line");
  const auto screen_made = log_screen();
  Screen& screen = *screen_made;
  check_fits(screen);
}

struct TwoActions {
  TwoActions() {
    forget_commands();
    note_command({"params", "send", "mill.toml", "--link", "tcp:host:502"});
    note_command({"laser", "prepare", "EXX.csv", "--line", "EX along X at Y -1400, Z 0", "--leave-out-run",
                  "3=somebody walked through the beam", "-o", "out/map-files/EXX_line1.csv"});
  }
  ~TwoActions() { forget_commands(); }
  TwoActions(const TwoActions&) = delete;
  TwoActions& operator=(const TwoActions&) = delete;
};

TEST_CASE("the newest action is marked and stands whole below, which is what F4 copies") {
  const TwoActions two;
  const auto screen = commands_screen();
  const std::string seen = picture(*screen);
  check_holds(seen, {"2 actions, newest last", "ecs params send mill.toml --link tcp:host:502"});
  CHECK(reads(seen, "--leave-out-run '3=somebody walked through the beam' -o out/map-files/EXX_line1.csv"));
  CHECK(screen->copied() ==
        "ecs laser prepare EXX.csv --line 'EX along X at Y -1400, Z 0' --leave-out-run '3=somebody walked through the "
        "beam' -o out/map-files/EXX_line1.csv");
  (void)press(*screen, Key::Name::up);
  CHECK(screen->copied() == "ecs params send mill.toml --link tcp:host:502");
}

TEST_CASE("a script is written and may be run; a file that is there is asked for") {
  const TwoActions two;
  const Folder folder;
  const std::string path = folder / "done.sh";
  const auto screen = commands_screen();
  (void)letter(*screen, 'w');
  CHECK(screen->typing());
  replace_line(*screen, path);
  CHECK(contains(picture(*screen), "2 actions written to"));
  CHECK(contains(content_of(path), "#!/bin/sh"));
  CHECK((std::filesystem::status(path).permissions() & std::filesystem::perms::owner_exec) !=
        std::filesystem::perms::none);
  folder.with("done.sh", "mine");
  (void)letter(*screen, 'w');
  replace_line(*screen, path);
  CHECK(contains(picture(*screen), "Replace "));
  (void)letter(*screen, 'n');
  CHECK(content_of(path) == "mine");
  (void)letter(*screen, 'w');
  replace_line(*screen, path);
  (void)letter(*screen, 'y');
  CHECK(contains(content_of(path), "#!/bin/sh"));
}

TEST_CASE("a new script begins after a question; what is done meanwhile is shown") {
  const TwoActions two;
  const auto screen = commands_screen();
  CHECK(contains(after(*screen, "x"), "Start again?"));
  CHECK(contains(after(*screen, "y"), "No commands yet"));
  CHECK(screen->copied().empty());
  note_command({"utility", "ramtest"});
  CHECK(screen->advance());
  CHECK(screen->copied() == "ecs utility ramtest");
}

}  // namespace
}  // namespace ecs::app
