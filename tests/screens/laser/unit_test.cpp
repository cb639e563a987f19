// The map on its way: sent and verified, cancelled, and an emulator that is killed in the middle.
#include "tests/screens/support/laser_unit.hpp"

namespace ecs::app {
namespace {

TEST_CASE("a map is saved, checked, sent, verified; the verb finds the same map in the unit") {
  const StateFolder folder;
  PacedUnit unit(folder, "115200");
  const LinearMill mill(folder);
  {
    LaserScreenDriver driver(unit.link());
    make_ready(driver, folder, mill);
    REQUIRE(driver.shows("serial number MCM-0107"));
    driver.type("\n");
    REQUIRE(driver.shows("Send the map to"));
    CHECK(std::filesystem::exists(folder.path / "map.csv"));
    driver.type("\n");  // Enter is no yes
    CHECK(driver.seen().find("Send the map to") != std::string::npos);
    driver.type("y");
    REQUIRE(driver.shows("and verified"));
    CHECK(driver.controller().mark(LaserStep::send) == LaserMark::done);
    driver.type("9\n");
    REQUIRE(driver.shows("the unit holds this map and its parameters"));
    CHECK(driver.controller().mark(LaserStep::verify) == LaserMark::done);
    driver.controller().change("smoothing", [](LaserChoices& c) { c.components["EXX"].smoothing_mm = 300.0; });
    REQUIRE(driver.settled());
    CHECK(driver.controller().mark(LaserStep::send) == LaserMark::doubtful);
    CHECK(driver.controller().mark(LaserStep::verify) == LaserMark::doubtful);
  }
  CHECK(ran_text({"map", "verify", (folder.path / "map.csv").string(), "--params",
                  (folder.path / "map-parameters.toml").string(), "--link", unit.link()})
            .starts_with("0 "));
}

TEST_CASE("an emulator killed while a map is sent: the old map stays, the screen says so, sending again works") {
  const StateFolder folder;
  PacedUnit unit(folder, "19200");
  const LinearMill mill(folder);
  LaserScreenDriver driver(unit.link());
  make_ready(driver, folder, mill);
  driver.type("\n");
  REQUIRE(driver.shows("Send the map to"));
  driver.type("y");
  REQUIRE(driver.shows("and verified"));
  const std::uint32_t old_check = driver.controller().sent()->check;

  driver.controller().change("finer", [](LaserChoices& c) {
    for (const char* code : {"EXX", "EYY", "EZZ"}) c.components[code].increment_mm = 4.0;
  });
  REQUIRE(driver.settled());
  driver.type("\n");
  REQUIRE(driver.shows("Send the map to"));
  driver.type("y");
  REQUIRE(driver.until([&] { return driver.controller().task().part() > 0.2; }));
  CHECK(driver.seen().find("s left") != std::string::npos);
  CHECK(driver.seen().find("sending the map") != std::string::npos);
  unit.kill();
  REQUIRE(driver.until([&] { return !driver.controller().busy(); }, 60));
  CHECK(driver.seen().find("not sent: ") != std::string::npos);
  CHECK(driver.seen().find("The unit keeps the map it had") != std::string::npos);
  CHECK(driver.controller().choices().components.at("EXX").increment_mm == 4.0);
  unit.start();
  REQUIRE(driver.until(
      [&] { return driver.seen().find("the map it had before is still active and whole") != std::string::npos; }, 60));
  CHECK(driver.seen().find(fmt::format("{:08X}", old_check)) != std::string::npos);
  driver.type("\n");
  REQUIRE(driver.shows("Send the map to"));
  driver.type("y");
  REQUIRE(driver.until([&] { return driver.controller().sent_is_current(); }, 60));
  CHECK(driver.controller().sent()->check != old_check);
}

TEST_CASE("escape while a map is sent stops it, and the unit keeps the map it had") {
  const StateFolder folder;
  PacedUnit unit(folder, "19200");
  const LinearMill mill(folder, 10.0);
  LaserScreenDriver driver(unit.link());
  make_ready(driver, folder, mill);
  driver.type("\n");
  REQUIRE(driver.shows("Send the map to"));
  driver.type("y");
  REQUIRE(driver.until([&] { return driver.controller().task().part() > 0.1; }));
  driver.type("\x1b");
  REQUIRE(driver.until([&] { return !driver.controller().busy(); }));
  CHECK(driver.seen().find("not sent: ") != std::string::npos);
  REQUIRE(driver.shows("it holds no map, as before"));
  driver.type("\n");
  REQUIRE(driver.shows("Send the map to"));
}

TEST_CASE("parameters are received from the unit where no file is given") {
  const StateFolder folder;
  PacedUnit unit(folder, "115200");
  REQUIRE(ran_text({"params", "send", "samples/mill/parameters.toml", "--link", unit.link()}).starts_with("0 "));
  LaserScreenDriver driver(unit.link());
  driver.type("6p\n");
  const bool there = driver.until([&] { return driver.controller().work().map.parameters.has_value(); });
  REQUIRE(there);
  CHECK(driver.controller().choices().params_file == (folder.path / "state/unit-parameters.toml").string());
  CHECK(driver.seen().find("volumetric") != std::string::npos);
}

TEST_CASE("without a unit everything up to the file works, and sending says why it cannot") {
  const StateFolder folder;
  const LinearMill mill(folder);
  LaserScreenDriver driver;
  make_ready(driver, folder, mill);
  driver.type("\n");
  REQUIRE(driver.shows("saved, but not sent: "));
  CHECK(std::filesystem::exists(folder.path / "map.csv"));
  CHECK(driver.controller().unsaved().empty());
  CHECK(driver.seen().find("no link to a unit") != std::string::npos);
}

}  // namespace
}  // namespace ecs::app
