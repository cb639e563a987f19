// The map on its way: sent and verified, cancelled, and an emulator that is killed in the middle.
// Step 9: a verdict that holds only as long as the unit is the one that was compared, and compensation with it.
#include "protocol/client/client.hpp"
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
    driver.controller().change(
        "smoothing", [](LaserChoices& c) { laser::settings_in(c.recipe, Component::EXX).smoothing_mm = 300.0; });
    REQUIRE(driver.settled());
    CHECK(driver.controller().mark(LaserStep::send) == LaserMark::doubtful);
    CHECK(driver.controller().mark(LaserStep::verify) == LaserMark::doubtful);
  }
  CHECK(ran_text({"map", "verify", (folder.path / "map.csv").string(), "--params",
                  (folder.path / "map-parameters.toml").string(), "--link", unit.link()})
            .starts_with("0 "));
}

TEST_CASE("an emulator killed while a map is sent: the old map stays, the screen says so, sending again works") {
  ReadyMill ready("19200");
  LaserScreenDriver& driver = ready.driver;
  ready.begin_sending();
  REQUIRE(driver.shows("and verified"));
  const std::uint32_t old_check = driver.controller().sent()->check;

  driver.controller().change("finer", [](LaserChoices& c) {
    for (const Component each : {Component::EXX, Component::EYY, Component::EZZ})
      laser::settings_in(c.recipe, each).increment_mm = 4.0;
  });
  REQUIRE(driver.settled());
  ready.begin_sending();
  REQUIRE(driver.until([&] { return driver.controller().task().part() > 0.2; }));
  CHECK(driver.seen().find("s left") != std::string::npos);
  CHECK(driver.seen().find("sending the map") != std::string::npos);
  ready.unit.kill();
  REQUIRE(driver.until([&] { return !driver.controller().busy(); }, 60));
  CHECK(driver.seen().find("not sent: ") != std::string::npos);
  CHECK(driver.seen().find("The unit keeps the map it had") != std::string::npos);
  CHECK(laser::settings_of(driver.controller().choices().recipe, Component::EXX).increment_mm == 4.0);
  ready.unit.start();
  REQUIRE(driver.until(
      [&] { return driver.seen().find("the map it had before is still active and whole") != std::string::npos; }, 60));
  CHECK(driver.seen().find(fmt::format("{:08X}", old_check)) != std::string::npos);
  ready.begin_sending();
  REQUIRE(driver.until([&] { return driver.controller().sent_is_current(); }, 60));
  CHECK(driver.controller().sent()->check != old_check);
}

TEST_CASE("escape while a map is sent stops it, and the unit keeps the map it had") {
  ReadyMill ready("19200", 10.0);
  LaserScreenDriver& driver = ready.driver;
  ready.begin_sending();
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

const char* const kStale = "the unit has changed since: verify again";

/// As another host would: over the same line, unknown to the screen.
template <class Work>
void as_another_host(LaserScreenDriver& driver, Work work) {
  JobControl control;
  const Result<void> done = driver.unit->with_link(control, [&](UnitLink& link) -> Result<void> { return work(link); });
  REQUIRE(done);
}

Result<void> map_sent_over(UnitLink& link, const std::string& map, const std::string& params) {
  ECS_TRY(prepared, prepared_map(map, params));
  ECS_DO(send_map(link.client(), prepared, map, false));
  return {};
}

/// A map of the same machine with other values, saved beside the first one.
void save_another_map(LaserScreenDriver& driver, const StateFolder& folder) {
  const LaserChoices before = driver.controller().choices();
  driver.controller().change("other values", [&](LaserChoices& c) {
    laser::settings_in(c.recipe, Component::EXX).smoothing_mm = 800.0;
    c.map_file = (folder.path / "other.csv").string();
  });
  REQUIRE(driver.settled());
  driver.type("s");
  REQUIRE(driver.shows("saved: "));
  driver.controller().change("back", [&](LaserChoices& c) { c = before; });
  REQUIRE(driver.settled());
  driver.type("8");
}

void verify_at(LaserScreenDriver& driver) {
  driver.type("9\n");
  REQUIRE(driver.until([&] { return !driver.controller().busy(); }, 60));
  REQUIRE(driver.controller().verdict());
}

TEST_CASE(
    "a verdict goes stale for another unit, another map, a map made active again, a restart, a line opened again") {
  const auto line = std::chrono::steady_clock::now();
  const UnitHolding then{"MCM-0107", 0x12345678, 4, 100, line};
  UnitHolding now = then;
  now.uptime_s = 160;
  CHECK(changed_since(then, now).empty());
  now.serial_number = "MCM-0999";
  CHECK(changed_since(then, now).find("unit MCM-0999 answers in place of MCM-0107") != std::string::npos);
  now = then;
  now.check = 0xCAFE0001;
  CHECK(changed_since(then, now).find("block check CAFE0001 in place of block check 12345678") != std::string::npos);
  now.check.reset();
  CHECK(changed_since(then, now).find("no map in place of") != std::string::npos);
  now = then;
  now.activations = 5;
  CHECK(changed_since(then, now).find("made active in it by another host") != std::string::npos);
  now = then;
  now.uptime_s = 3;
  CHECK(changed_since(then, now) == "it was restarted");
  now = then;
  now.opened_at += std::chrono::seconds(5);
  CHECK(changed_since(then, now) == "the link to it was opened again");
}

TEST_CASE("another host makes another map active: the verdict is said to be stale, and compensation is refused") {
  ReadyMill ready;
  LaserScreenDriver& driver = ready.driver;
  save_another_map(driver, ready.folder);
  send_from(ready);
  verify_at(driver);
  CHECK(driver.controller().verified());
  CHECK(driver.seen().find("commit") == std::string::npos);
  CHECK(driver.seen().find("made active as no. 1") != std::string::npos);

  as_another_host(driver, [&](UnitLink& link) {
    return map_sent_over(link, (ready.folder.path / "other.csv").string(),
                         (ready.folder.path / "other-parameters.toml").string());
  });
  SUBCASE("by itself within seconds while the step is open") {
    CHECK(driver.until([&] { return driver.seen().find(kStale) != std::string::npos; }, 10));
    CHECK(driver.controller().mark(LaserStep::verify) == LaserMark::doubtful);
    CHECK(driver.seen().find("another host") != std::string::npos);
    CHECK(driver.seen().find("reference every axis") == std::string::npos);
    verify_at(driver);
    CHECK(driver.controller().stale().empty());
    CHECK_FALSE(driver.controller().verdict()->same());
    driver.type("c");
    CHECK(driver.shows("the unit does not hold the map of the file"));
  }
  SUBCASE("but once that map is the one of the file here and compared, the unit may compensate with it") {
    driver.controller().change("the other map", [&](LaserChoices& c) {
      laser::settings_in(c.recipe, Component::EXX).smoothing_mm = 800.0;
      c.map_file = (ready.folder.path / "other.csv").string();
    });
    REQUIRE(driver.settled());
    driver.type("sy");
    REQUIRE(driver.shows("saved: "));
    verify_at(driver);
    CHECK(driver.controller().verified());
    driver.type("cy");
    CHECK(driver.shows("the unit watches: reference every axis"));
  }
  SUBCASE("and compensation, asked for at once, is refused with both block checks") {
    driver.type("cy");
    CHECK(driver.shows("another host has changed it"));
    CHECK(driver.seen().find(fmt::format("{:08X}", driver.controller().sent()->check)) != std::string::npos);
    CHECK(driver.unit->newest()->mode == UnitMode::integration);
  }
}

TEST_CASE(
    "a map that was verified but not sent from here counts: compensation is refused once the unit holds another") {
  ReadyMill ready;
  LaserScreenDriver& driver = ready.driver;
  save_another_map(driver, ready.folder);
  driver.type("s");
  REQUIRE(driver.shows("saved: "));
  driver.type("9c");
  CHECK_FALSE(driver.seen().find("Switch the unit to compensation?") != std::string::npos);
  CHECK(driver.seen().find("not known which map the unit holds: Enter compares") != std::string::npos);
  as_another_host(driver, [&](UnitLink& link) {
    return map_sent_over(link, (ready.folder.path / "map.csv").string(),
                         (ready.folder.path / "map-parameters.toml").string());
  });
  verify_at(driver);
  CHECK(driver.controller().verified());
  CHECK(driver.controller().mark(LaserStep::verify) == LaserMark::done);
  as_another_host(driver, [&](UnitLink& link) {
    return map_sent_over(link, (ready.folder.path / "other.csv").string(),
                         (ready.folder.path / "other-parameters.toml").string());
  });
  driver.type("cy");
  CHECK(driver.until([&] {
    return driver.controller().message().text().find("what was compared was block check") != std::string::npos;
  }));
  as_another_host(driver, [&](UnitLink& link) {
    return map_sent_over(link, (ready.folder.path / "map.csv").string(),
                         (ready.folder.path / "map-parameters.toml").string());
  });
  driver.type("cy");
  CHECK(driver.shows("the unit watches: reference every axis"));
}

TEST_CASE("a unit that was switched off and on has to be verified again") {
  ReadyMill ready;
  LaserScreenDriver& driver = ready.driver;
  send_from(ready);
  verify_at(driver);
  SUBCASE("with its line") {
    ready.unit.kill();
    ready.unit.start();
    CHECK(driver.until([&] { return driver.seen().find(kStale) != std::string::npos; }, 30));
  }
  SUBCASE("while the line stayed open") {
    driver.until([] { return false; }, 5);  // long enough that the next sample shows a shorter time since the start
    as_another_host(driver, [](UnitLink& link) { return link.client().reset_unit(); });
    CHECK(driver.until([&] { return driver.seen().find(kStale) != std::string::npos; }, 30));
    CHECK(driver.seen().find("it was restarted") != std::string::npos);
  }
  verify_at(driver);
  CHECK(driver.controller().verified());
}

}  // namespace
}  // namespace ecs::app
