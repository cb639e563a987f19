// The log: what the screens told, whole, found again and copied.
#include <algorithm>

#include "app/screens/unit/screens.hpp"
#include "base/file.hpp"
#include "commissioning/session/message.hpp"
#include "tests/screens/support/unit_screen.hpp"

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
  CHECK(contains(text, "parameters sent"));
  CHECK(contains(text, "ERROR"));
  CHECK(contains(text, "word19"));
  CHECK(contains(text, "following"));
  CHECK(contains(text, (one.path / "state" / "screens.log").string()));
}

TEST_CASE("errors alone are shown on e, any message is found by a part of it, and a copy is saved") {
  const StateFolder one;
  log_event(Tone::bad, "first trouble");
  log_event(Tone::good, "Quite well");
  log_event(Tone::bad, "second trouble");
  const auto screen_made = log_screen();
  Screen& screen = *screen_made;
  type(screen, "e");
  CHECK_FALSE(contains(picture(screen), "Quite well"));
  CHECK(contains(picture(screen), "errors only"));
  type(screen, "e/");
  CHECK(screen.typing());
  replace_line(screen, "quite");
  CHECK(contains(picture(screen), "> "));
  CHECK_FALSE(contains(picture(screen), "following"));
  log_event(Tone::good, "a later one");
  (void)screen.advance();
  CHECK_FALSE(contains(picture(screen), "following"));
  type(screen, "/");
  replace_line(screen, "no such words at all");
  CHECK(contains(picture(screen), "is in no message"));
  (void)press(screen, Key::Name::end);
  CHECK(contains(picture(screen), "following"));
  (void)screen.on_key({Key::Name::mouse, 0, 0, 3, 10});  // the first row of the list
  CHECK_FALSE(contains(picture(screen), "following"));
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
  for (const auto& [rows, columns] : {std::pair{24, 80}, {40, 120}, {12, 40}, {5, 20}, {1, 1}}) {
    const std::string text = picture(screen, rows, columns, Glyphs::ascii);
    CHECK(std::count(text.begin(), text.end(), '\n') == rows);
  }
}

}  // namespace
}  // namespace ecs::app
