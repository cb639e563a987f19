// The columns of a table that no format describes, on the screen: first rows, roles, units, settings, what would be
// read; accepted, refused, taken over for the next file.
#include "tests/screens/support/laser_screen.hpp"

namespace ecs::app {
namespace {

std::string gauge_text(int columns = 3) {
  std::string text = "Pos [mm];Abweichung [um]";
  for (int c = 3; c <= columns; ++c) text += fmt::format(";extra {}", c);
  for (int k = 0; k < 12; ++k) {
    text += fmt::format("\n{};{}.5", 10 * (k < 6 ? k : 11 - k), k % 5);
    for (int c = 3; c <= columns; ++c) text += fmt::format(";{}", 100 * c + k);
  }
  return text + "\n";
}

/// A file chosen by its path.
void add(LaserScreenDriver& driver, const std::string& path) { driver.type("a" + path + "\n"); }

TEST_CASE("an unknown table is shown with its first rows, roles and units, and Enter accepts what would be read") {
  const StateFolder folder;
  LaserScreenDriver driver;
  add(driver, folder.with("gauge.txt", gauge_text()));
  const std::string seen = driver.seen();
  INFO(seen);
  check_holds(seen, {"Columns of gauge.txt: guessed from headings and values", "Pos [mm]", "Abweichung", "X position",
                     "reading", "axis", "along the axis", "errors", "from the motion", "EXX: 12 readings, 1 run",
                     "first readings: 0.5 um at 0", "(Space, Backspace or a letter"});
  REQUIRE(driver.settles_after("\n"));
  CHECK(only(driver.controller().work().lines).summary.readings == 12);
  CHECK(driver.controller().mark(LaserStep::files) == LaserMark::done);
}

TEST_CASE("roles and units change below the cursor, and what is wrong is said before and after Enter") {
  const StateFolder folder;
  LaserScreenDriver driver;
  add(driver, folder.with("gauge.txt", gauge_text()));
  driver.press(Key::Name::right);
  CHECK(contains(driver.after("-"), "No column gives readings"));
  CHECK(contains(driver.after("\n"), "Not accepted: No column gives readings"));
  CHECK(contains(driver.after("r"), "EXX: 12 readings"));
  driver.press(Key::Name::down);
  CHECK(contains(driver.after(" "), "states um, but"));  // the heading states um
  CHECK(contains(driver.after("*"), "EXX: 12 readings"));
  driver.press(Key::Name::down, 2);
  CHECK(contains(driver.after(" "), "EYY: 12 readings"));
  CHECK(contains(driver.seen(), "Y position"));
  driver.press(Key::Name::down, 6);
  REQUIRE(driver.settles_after("x=-20\n"));
  const LaserLine& line = only(driver.controller().work().lines);
  CHECK(line.place == "X -20, Z ?");
}

TEST_CASE("thirty columns scroll with the cursor at 80 columns and in a small terminal") {
  const StateFolder folder;
  LaserScreenDriver driver;
  add(driver, folder.with("wide.txt", gauge_text(30)));
  CHECK(contains(driver.seen(), "30 >"));
  CHECK_FALSE(contains(driver.seen(), "extra 30"));
  driver.press(Key::Name::right, 40);
  CHECK(contains(driver.seen(), "extra 30"));
  CHECK_FALSE(contains(driver.seen(), "30 >"));
  CHECK(contains(driver.seen(14, 40), "extra 30"));
  CHECK(contains(driver.after("p"), "pressure"));
  driver.press(Key::Name::home);
  CHECK(contains(driver.seen(), "X position"));
  for (int rows = 1; rows < 24; ++rows) (void)driver.seen(rows, 20 + rows);
}

TEST_CASE("several files with the same headings are read the same way after one question") {
  const StateFolder folder;
  for (const char* name : {"one.txt", "two.txt", "three.txt"}) folder.with(std::string("f/") + name, gauge_text());
  LaserScreenDriver driver;
  REQUIRE(driver.shows_after("a" + folder.path.string() + "/f/\t", "[all 3"));
  driver.press(Key::Name::home);
  driver.press(Key::Name::down);
  driver.type("\n");
  CHECK(contains(driver.seen(), "Columns of one.txt"));
  driver.type("\n");
  CHECK(contains(driver.seen(), "Read 2 more files the same way?"));
  REQUIRE(driver.settles_after("y"));
  CHECK(only(driver.controller().work().lines).summary.readings == 36);
}

TEST_CASE("a mapping is offered for the next file with these headings, and Esc leaves the file for later") {
  const StateFolder folder;
  {
    LaserScreenDriver driver;
    add(driver, folder.with("monday.txt", gauge_text()));
    driver.press(Key::Name::down, 3);
    REQUIRE(driver.settles_after(" \n"));
    CHECK(only(driver.controller().work().lines).component == Component::EYY);
  }
  LaserScreenDriver later;
  later.type("d");
  later.type("y");
  add(later, folder.with("tuesday.txt", gauge_text()));
  CHECK(contains(later.seen(), "as monday.txt was read"));
  CHECK(contains(later.seen(), "Y position"));
  REQUIRE(later.settles_after("\x1b"));
  CHECK(contains(later.seen(), "table: press Enter to assign its columns"));
  CHECK(contains(later.after("\n"), "as monday.txt was read"));
  CHECK(contains(later.after("\t"), "import options of tuesday.txt"));
  CHECK(contains(later.seen(), "y_mm=1[mm],reading=2[um],approach=motion"));
  REQUIRE(later.settles_after("\n"));
  CHECK(only(later.controller().work().lines).component == Component::EYY);
}

TEST_CASE("files that hold no table keep the form of all options and their messages") {
  const StateFolder folder;
  LaserScreenDriver driver;
  add(driver, folder.with("one.txt", "1\n2\n3\n4\n"));
  REQUIRE(driver.settled());
  CHECK_FALSE(contains(driver.seen(), "Columns of"));
  CHECK(contains(driver.after("\n"), "import options of one.txt"));
}

}  // namespace
}  // namespace ecs::app
