// The map on its way: sent and verified, cancelled, and an emulator that is killed in the middle.
#include "tests/support/laser_unit.hpp"

namespace ecs::app {
namespace {

TEST_CASE("a map is saved, checked, sent, verified; the verb finds the same map in the unit") {
  const StateFolder folder;
  PacedUnit unit(folder, "115200");
  const LinearMill mill(folder);
  {
    LaserSitting sitting(unit.link());
    make_ready(sitting, folder, mill);
    REQUIRE(sitting.shows("serial number MCM-0107"));
    sitting.type("\n");
    REQUIRE(sitting.shows("Send the map to"));
    CHECK(std::filesystem::exists(folder.path / "map.csv"));
    sitting.type("\n");  // Enter is no yes
    CHECK(sitting.seen().find("Send the map to") != std::string::npos);
    sitting.type("y");
    REQUIRE(sitting.shows("and read back"));
    CHECK(sitting.controller().mark(LaserStep::send) == LaserMark::done);
    sitting.type("9\n");
    REQUIRE(sitting.shows("the unit holds this map and its parameters"));
    CHECK(sitting.controller().mark(LaserStep::verify) == LaserMark::done);
    sitting.controller().change("smoothing", [](LaserChoices& c) { c.components["EXX"].smoothing_mm = 300.0; });
    REQUIRE(sitting.settled());
    CHECK(sitting.controller().mark(LaserStep::send) == LaserMark::doubtful);
    CHECK(sitting.controller().mark(LaserStep::verify) == LaserMark::doubtful);
  }
  CHECK(ran_text({"map", "verify", (folder.path / "map.csv").string(), "--params",
                  (folder.path / "map-parameters.toml").string(), "--link", unit.link()})
            .starts_with("0 "));
}

TEST_CASE("an emulator killed while a map is sent: the old map stays, the screen says so, sending again works") {
  const StateFolder folder;
  PacedUnit unit(folder, "19200");
  const LinearMill mill(folder);
  LaserSitting sitting(unit.link());
  make_ready(sitting, folder, mill);
  sitting.type("\n");
  REQUIRE(sitting.shows("Send the map to"));
  sitting.type("y");
  REQUIRE(sitting.shows("and read back"));
  const std::uint32_t old_check = sitting.controller().sent()->check;

  sitting.controller().change("finer", [](LaserChoices& c) {
    for (const char* code : {"EXX", "EYY", "EZZ"}) c.components[code].increment_mm = 4.0;
  });
  REQUIRE(sitting.settled());
  sitting.type("\n");
  REQUIRE(sitting.shows("Send the map to"));
  sitting.type("y");
  REQUIRE(sitting.until([&] { return sitting.controller().part() > 0.2; }));
  CHECK(sitting.seen().find("s left") != std::string::npos);
  CHECK(sitting.seen().find("sending the map") != std::string::npos);
  unit.kill();
  REQUIRE(sitting.until([&] { return !sitting.controller().busy(); }, 60));
  CHECK(sitting.seen().find("not sent: ") != std::string::npos);
  CHECK(sitting.seen().find("The unit keeps the map it had") != std::string::npos);
  CHECK(sitting.controller().choices().components.at("EXX").increment_mm == 4.0);
  unit.start();
  REQUIRE(sitting.until(
      [&] { return sitting.seen().find("the map it had before is still active and whole") != std::string::npos; }, 60));
  CHECK(sitting.seen().find(fmt::format("{:08X}", old_check)) != std::string::npos);
  sitting.type("\n");
  REQUIRE(sitting.shows("Send the map to"));
  sitting.type("y");
  REQUIRE(sitting.until([&] { return sitting.controller().sent_is_current(); }, 60));
  CHECK(sitting.controller().sent()->check != old_check);
}

TEST_CASE("escape while a map is sent stops it, and the unit keeps the map it had") {
  const StateFolder folder;
  PacedUnit unit(folder, "19200");
  const LinearMill mill(folder, 10.0);
  LaserSitting sitting(unit.link());
  make_ready(sitting, folder, mill);
  sitting.type("\n");
  REQUIRE(sitting.shows("Send the map to"));
  sitting.type("y");
  REQUIRE(sitting.until([&] { return sitting.controller().part() > 0.1; }));
  sitting.type("\x1b");
  REQUIRE(sitting.until([&] { return !sitting.controller().busy(); }));
  CHECK(sitting.seen().find("not sent: ") != std::string::npos);
  REQUIRE(sitting.shows("it holds no map, as before"));
  sitting.type("\n");
  REQUIRE(sitting.shows("Send the map to"));
}

TEST_CASE("parameters are received from the unit where no file is given") {
  const StateFolder folder;
  PacedUnit unit(folder, "115200");
  REQUIRE(ran_text({"params", "send", "samples/mill/parameters.toml", "--link", unit.link()}).starts_with("0 "));
  LaserSitting sitting(unit.link());
  sitting.type("6p\n");
  const bool there = sitting.until([&] { return sitting.controller().work().map.parameters.has_value(); });
  REQUIRE(there);
  CHECK(sitting.controller().choices().params_file == (folder.path / "state/unit-parameters.toml").string());
  CHECK(sitting.seen().find("volumetric") != std::string::npos);
}

TEST_CASE("without a unit everything up to the file works, and sending says why it cannot") {
  const StateFolder folder;
  const LinearMill mill(folder);
  LaserSitting sitting;
  make_ready(sitting, folder, mill);
  sitting.type("\n");
  REQUIRE(sitting.shows("saved, but not sent: "));
  CHECK(std::filesystem::exists(folder.path / "map.csv"));
  CHECK(sitting.controller().unsaved().empty());
  CHECK(sitting.seen().find("no line to a unit") != std::string::npos);
}

}  // namespace
}  // namespace ecs::app
