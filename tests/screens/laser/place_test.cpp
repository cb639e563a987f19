// A place that a file states wrongly, and parameters of another machine: said early, and corrected from the screen.
#include "tests/screens/support/laser_screen.hpp"

namespace ecs::app {
namespace {

const std::string kMillParameters = "samples/mill/parameters.toml";

Measured off_its_line() {
  Measured wrong = kPositioning;
  wrong.parked_mm = {0, -1000, 0};
  return wrong;
}

TEST_CASE("step 6 says why a measured component is not used, step 2 corrects its place") {
  const StateFolder folder;
  LaserScreenDriver driver;
  driver.take_files({folder.with("EXX.csv", measured_csv(off_its_line(), [](double p) { return 0.01 * p; }))},
                    kMillParameters);
  CHECK(contains(driver.seen(24, 160), "EXX is measured, but not used: step 6 says why."));
  driver.type("6");
  const std::string missing = driver.seen(24, 160);
  INFO(missing);
  CHECK(contains(missing, "it was measured at Y -1000, the measurement line of X in the parameters is at Y -1400"));
  CHECK(contains(missing, "c in step 2 corrects a wrong place"));
  driver.type("2c");
  CHECK(contains(driver.seen(), "y=-1000,z=0"));
  driver.press(Key::Name::backspace, 11);
  driver.type("y=-1400,z=0\n");
  REQUIRE(driver.settled());
  const LaserLine& line = driver.controller().work().lines.front();
  CHECK(line.key == kExx);
  REQUIRE(line.notes.size() == 1);
  CHECK(line.notes.front() == "place corrected to y=-1400,z=0; EXX.csv says Y -1000, Z 0");
  CHECK(driver.controller().work().map.components.front().state == ComponentState::present);
  driver.type("u");
  REQUIRE(driver.settled());
  CHECK(driver.controller().work().map.components.front().state == ComponentState::missing);
}

TEST_CASE("what was left out stays with a line whose place is corrected, and both are kept in the draft") {
  const StateFolder folder;
  LaserScreenDriver driver;
  driver.take_files({folder.with("EXX.csv", measured_csv(off_its_line(), [](double) { return 1.0; }))});
  const LaserLine line = driver.controller().work().lines.front();
  LaserChoices choices = driver.controller().choices();
  choices.lines[line.key].runs[2] = "cold";
  REQUIRE(correct_place(choices, line, "y=-1400,z=0").has_value());
  CHECK(choices.lines[kExx].runs.contains(2));
  CHECK(choices_in(choices_text(choices)) == choices);
  const auto wrong = correct_place(choices, line, "y=far");
  REQUIRE_FALSE(wrong.has_value());
  CHECK(contains(to_text(wrong.error()), "expected AXIS=MM"));
}

TEST_CASE("parameters of another machine are reported when they are chosen") {
  const StateFolder folder;
  const Measured along_y{'Y', "EY", -1400, 0, 50, {0, 0, 0}};
  LaserScreenDriver driver;
  const std::string lathe = folder.with("lathe.toml",
                                        "[configuration]\nchain = \"XT\"\naxes = \"X\"\n[compensation]\n"
                                        "scope = \"linear\"\n[axis.X]\ntransducer = \"encoder\"\n"
                                        "# end of parameters\n");
  driver.take_files({folder.with("EYY.csv", measured_csv(along_y, [](double) { return 1.0; }))}, lathe);
  CHECK(contains(driver.seen(24, 120), "EYY was measured, but the parameters (XT) have no axis Y."));
  driver.controller().change("parameters", [](LaserChoices& c) { c.params_file = kMillParameters; });
  REQUIRE(driver.settled());
  CHECK(driver.controller().mismatch().empty());
}

}  // namespace
}  // namespace ecs::app
