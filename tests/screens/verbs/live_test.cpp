// A capture on the screen: what comes next, values typed, what was read.
#include "app/screens/verbs/live_screen.hpp"

#include <chrono>
#include <filesystem>
#include <string>
#include <thread>

#include <doctest/doctest.h>
#include <unistd.h>

#include "app/ui/screen_program.hpp"
#include "base/file.hpp"

using namespace ecs::app;

namespace {

std::string seen(const Screen& screen) {
  return picture_of(screen, screen.title(), {}, Canvas(24, 80, Glyphs::unicode), false).plain_text();
}

/// Until the picture shows it; a minute at most.
bool shows(LiveScreen& screen, const std::string& text) {
  for (int k = 0; k < 6000; ++k) {
    (void)screen.advance();
    if (seen(screen).find(text) != std::string::npos) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

void enter(LiveScreen& screen, const std::string& text) {
  for (const char c : text) (void)screen.on_key({Key::Name::letter, static_cast<char32_t>(c)});
  (void)screen.on_key({Key::Name::enter});
}

struct Folder {
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("ecs-live-screen-test-" + std::to_string(::getpid()));
  Folder() { std::filesystem::create_directories(path); }
  ~Folder() { std::filesystem::remove_all(path); }
};

std::vector<std::string> words(const Folder& folder) {
  return {"laser",  "capture", "--axis",         "X",  "--sense", "EX",
          "--from", "0",       "--to",           "50", "--step",  "50",
          "--runs", "1",       "--min-interval", "0",  "-o",      (folder.path / "x.csv").string()};
}

TEST_CASE("a capture leads through its targets on the screen and ends with its file") {
  const Folder folder;
  LiveScreen screen("laser capture", words(folder));
  REQUIRE(shows(screen, "next: X forward to 0 mm (1 of 2"));
  enter(screen, "0.5");
  REQUIRE(shows(screen, "next: X forward to 50 mm (2 of 2"));
  CHECK(seen(screen).find("0.50 um at X 0 mm") != std::string::npos);
  enter(screen, "u");
  REQUIRE(shows(screen, "next: X forward to 0 mm (1 of 2"));
  for (const char* value : {"0", "1", "2", "3"}) enter(screen, value);
  REQUIRE(shows(screen, "4 readings of 4 targets written"));
  CHECK(std::filesystem::exists(folder.path / "x.csv"));
  CHECK(screen.on_key({Key::Name::escape}).kind == Step::Kind::back);
}

TEST_CASE("escape leaves a capture with what was read in its part file") {
  const Folder folder;
  LiveScreen screen("laser capture", words(folder));
  REQUIRE(shows(screen, "next: X forward to 0 mm"));
  enter(screen, "0.5");
  REQUIRE(shows(screen, "next: X forward to 50 mm"));
  CHECK(screen.on_key({Key::Name::escape}).kind == Step::Kind::stay);
  REQUIRE(shows(screen, "ended with code 1"));
  CHECK(std::filesystem::exists(folder.path / "x.csv.part"));
}

TEST_CASE("closing the screen ends the capture") {
  const Folder folder;
  {
    LiveScreen screen("laser capture", words(folder));
    REQUIRE(shows(screen, "next: X forward to 0 mm"));
    enter(screen, "0.5");
    REQUIRE(shows(screen, "next: X forward to 50 mm"));
  }
  CHECK(std::filesystem::exists(folder.path / "x.csv.part"));
}

}  // namespace
