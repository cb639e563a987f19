// A capture on the screen: what comes next, values typed, what was read.
#include <chrono>
#include <filesystem>
#include <string>
#include <thread>

#include <doctest/doctest.h>
#include <unistd.h>

#include "app/screens/verbs/live_screen.hpp"
#include "app/ui/screen_program.hpp"
#include "base/file.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/screen_driver.hpp"

using namespace ecs;
using namespace ecs::app;
using namespace ecs::app::screen_test;

namespace {

std::vector<std::string> words(const ecs::StateFolder& folder) {
  return {"laser",  "capture", "--axis",         "X",  "--sense", "EX",
          "--from", "0",       "--to",           "50", "--step",  "50",
          "--runs", "1",       "--min-interval", "0",  "-o",      (folder.path / "x.csv").string()};
}

TEST_CASE("a capture leads through its targets on the screen and ends with its file") {
  const ecs::StateFolder folder;
  const auto screen_made = live_screen("laser capture", words(folder));
  Screen& screen = *screen_made;
  REQUIRE(shows(screen, "next: X forward to 0 mm (1 of 2"));
  enter(screen, "0.5");
  REQUIRE(shows(screen, "next: X forward to 50 mm (2 of 2"));
  CHECK(picture(screen).find("0.50 um at X 0 mm") != std::string::npos);
  enter(screen, "u");
  REQUIRE(shows(screen, "next: X forward to 0 mm (1 of 2"));
  for (const char* value : {"0", "1", "2", "3"}) enter(screen, value);
  REQUIRE(shows(screen, "4 readings of 4 targets written"));
  CHECK(std::filesystem::exists(folder.path / "x.csv"));
  CHECK(screen.on_key({Key::Name::escape}).kind == Step::Kind::back);
}

TEST_CASE("escape leaves a capture with what was read in its part file") {
  const ecs::StateFolder folder;
  const auto screen_made = live_screen("laser capture", words(folder));
  Screen& screen = *screen_made;
  REQUIRE(shows(screen, "next: X forward to 0 mm"));
  enter(screen, "0.5");
  REQUIRE(shows(screen, "next: X forward to 50 mm"));
  CHECK(screen.on_key({Key::Name::escape}).kind == Step::Kind::stay);
  REQUIRE(shows(screen, "not finished: see below"));
  CHECK(std::filesystem::exists(folder.path / "x.csv.part"));
}

TEST_CASE("closing the screen ends the capture") {
  const ecs::StateFolder folder;
  {
    const auto screen_made = live_screen("laser capture", words(folder));
    Screen& screen = *screen_made;
    REQUIRE(shows(screen, "next: X forward to 0 mm"));
    enter(screen, "0.5");
    REQUIRE(shows(screen, "next: X forward to 50 mm"));
  }
  CHECK(std::filesystem::exists(folder.path / "x.csv.part"));
}

}  // namespace
