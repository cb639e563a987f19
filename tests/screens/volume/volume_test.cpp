// The screen VOLUME: files as fields, an answer in pages, refusals in words.
#include <doctest/doctest.h>

#include "app/screens/volume/screen.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/screen_driver.hpp"

namespace ecs::app {
namespace {

using namespace screen_test;

constexpr const char* kMap =
    "# configuration: XYTZ\naxis,sense,approach,p_mm,value_um\nX,EX,0,0,0\nX,EX,0,600,-12\nX,EX,0,1200,-24\n";

void wait_for(Screen& screen) {
  for (int k = 0; k < 400 && contains(picture(screen), "computing"); ++k) {
    std::this_thread::sleep_for(std::chrono::milliseconds(25));
    (void)screen.advance();
  }
}

TEST_CASE("the screen asks for files, shows the sizes, then the body diagonals") {
  const Folder folder;
  const auto screen = volume_screen();
  CHECK(contains(picture(*screen), "How large is the error"));
  enter(*screen, folder.with("map.csv", kMap));
  enter(*screen, "samples/machining_centre/parameters.toml");
  for (int left = 0; left < 3; ++left) enter(*screen, "");
  wait_for(*screen);
  CHECK(contains(picture(*screen), "before"));
  CHECK(contains(picture(*screen), "24.0"));
  CHECK(contains(picture(*screen), "95 %"));
  (void)letter(*screen, '2');
  CHECK(contains(picture(*screen), "before, body diagonals"));
  (void)letter(*screen, '3');
  CHECK(contains(picture(*screen), "after, body diagonals"));
  CHECK(press(*screen, Key::Name::escape).kind == Step::Kind::stay);
  CHECK(contains(picture(*screen), "How large is the error"));
  CHECK(press(*screen, Key::Name::escape).kind == Step::Kind::back);
}

TEST_CASE("what cannot be computed is said on the screen of the files") {
  const auto screen = volume_screen();
  for (int field = 0; field < 4; ++field) (void)press(*screen, Key::Name::down);
  (void)press(*screen, Key::Name::enter);
  CHECK(contains(picture(*screen), "The file of the map is needed"));
  enter(*screen, "none.csv");
  enter(*screen, "samples/machining_centre/parameters.toml");
  for (int left = 0; left < 3; ++left) enter(*screen, "");
  wait_for(*screen);
  CHECK(contains(picture(*screen), "none.csv"));
}

TEST_CASE("a machine with rotary axes is shown at every angle, its rotary errors beside the map") {
  const auto screen = volume_screen();
  enter(*screen, "samples/five_axes/map.csv");
  enter(*screen, "samples/machining_centre/parameters.toml");
  enter(*screen, "");
  enter(*screen, "samples/five_axes/machine.toml");
  enter(*screen, "samples/five_axes/rotary.csv");
  wait_for(*screen);
  CHECK(contains(picture(*screen), "rotary axes A"));
  CHECK(contains(picture(*screen), "settings"));
  CHECK(contains(picture(*screen), "95 %"));
  (void)letter(*screen, '2');
  CHECK(contains(picture(*screen), "before, body diagonals"));
}

}  // namespace
}  // namespace ecs::app
