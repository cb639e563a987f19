// What the laser screen says of a map that covers little of its axis, and of a header that lacks something.
#include "tests/screens/support/laser_unit.hpp"

namespace ecs::app {
namespace {

/// The sample of 200 mm of X, with the parameters and the machine of the mill's X axis alone.
void take_short_axis(LaserScreenDriver& driver, const StateFolder& folder) {
  folder.with("machine.toml",
              "configuration = \"TX\"\nname = \"moving column mill\"\n[axis.X]\ntravel_mm = [-4100.0, 0.0]\n");
  const std::string params = folder.with("p.toml",
                                         "[identity]\nmachine = \"moving column mill\"\n[configuration]\nchain = "
                                         "\"TX\"\naxes = \"X\"\n[compensation]\nscope = \"linear\"\n[axis.X]\n"
                                         "transducer = \"encoder\"\n# end of parameters\n");
  driver.take_files({"samples/laser/x_axis.csv"}, params);
}

TEST_CASE("a map of a piece of its axis is complete with its remarks, in step 6 and in step 8") {
  const StateFolder folder;
  LaserScreenDriver driver;
  take_short_axis(driver, folder);
  REQUIRE(driver.controller().work().map.complete());
  CHECK(driver.controller().mark(LaserStep::map) == LaserMark::doubtful);
  driver.type("6");
  CHECK(driver.seen(24, 120).find("nothing is missing, 3 remarks") != std::string::npos);
  driver.type("\t");
  CHECK(driver.seen(40, 120).find("remark: EXX covers 200 of 4100 mm") != std::string::npos);
  driver.type("8");
  const std::string seen = driver.seen(24, 100);
  CHECK(seen.find("complete, 3 remarks") != std::string::npos);
  CHECK(seen.find("EXX covers 200 of 4100 mm of the travel of X (-4100 to 0)") != std::string::npos);
}

TEST_CASE("the date of the header is a date; another text is not taken, and what is expected is said") {
  const StateFolder folder;
  LaserScreenDriver driver;
  take_short_axis(driver, folder);
  driver.type("7");
  driver.press(Key::Name::down, 4);
  driver.type("\nN. Comer\n");
  CHECK(driver.seen(24, 120).find("expected year-month-day, as in 2026-03-12, found \"2024-05-06N. Comer\"") !=
        std::string::npos);
  CHECK(driver.controller().choices().header.date.empty());
  driver.press(Key::Name::backspace, 8);
  driver.type("\n");
  REQUIRE(driver.settled());
  CHECK(driver.controller().work().map.made->map.map.header.date == "2024-05-06");
}

TEST_CASE("an invalid date of the files is not preset") {
  const StateFolder folder;
  const std::string file = folder.with("x.csv", "# date: Mon Mar 12\naxis,sense,x_mm,reading\nX,EX,0,0\nX,EX,-50,1\n");
  LaserScreenDriver driver;
  driver.take_files({file});
  CHECK(header_with_files({}, driver.controller().work().lines).date.empty());
}

TEST_CASE("the question before sending names the first remark and what the header does not state") {
  const StateFolder folder;
  PacedUnit unit(folder, "115200");
  const LinearMill mill(folder);
  LaserScreenDriver driver(unit.link());
  make_ready(driver, folder, mill);
  // X measured over a tenth of its travel: samples/mill/machine.toml says -4100 to 0
  const std::string piece = folder.with("piece.csv", measured_csv({'X', "EX", 0, -400, 50, {0, -1400, 0}}, mill.error));
  driver.controller().change("a piece of X", [&](LaserChoices& c) { c.files.front().path = piece; });
  REQUIRE(driver.settled());
  driver.type("\n");
  REQUIRE(driver.shows("Send the map to"));
  const std::string asked = driver.seen(24, 100);
  CHECK(asked.find("1 remark: EXX covers 400 of 4100 mm") != std::string::npos);
  CHECK(asked.find("The header states no") != std::string::npos);
  CHECK(asked.find("customer, no engineer.") != std::string::npos);
  CHECK(asked.find("y send") != std::string::npos);
}

}  // namespace
}  // namespace ecs::app
