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
    REQUIRE(driver.shows_after("\n", "Send the map to"));
    CHECK(std::filesystem::exists(folder.path / "map.csv"));
    driver.type("\n");  // Enter is no yes
    CHECK(contains(driver.seen(), "Send the map to"));
    REQUIRE(driver.shows_after("y", "and verified"));
    CHECK(driver.controller().mark(LaserStep::send) == LaserMark::done);
    REQUIRE(driver.shows_after("9\n", "the unit contains this map and its parameters"));
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
  check_holds(driver.seen(), {"s left", "sending the map"});
  ready.unit.kill();
  REQUIRE(driver.until([&] { return !driver.controller().busy(); }, 60));
  check_holds(driver.seen(), {"not sent: ", "The unit keeps its old map"});
  CHECK(laser::settings_of(driver.controller().choices().recipe, Component::EXX).increment_mm == 4.0);
  ready.unit.start();
  REQUIRE(driver.until([&] { return contains(driver.seen(), "the old map is still active and complete"); }, 60));
  CHECK(contains(driver.seen(), fmt::format("{:08X}", old_check)));
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
  CHECK(contains(driver.seen(), "not sent: "));
  REQUIRE(driver.shows("it contains no map, as before"));
  REQUIRE(driver.shows_after("\n", "Send the map to"));
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
  CHECK(contains(driver.seen(), "volumetric"));
}

TEST_CASE("without a unit everything up to the file works, and sending says why it cannot") {
  const StateFolder folder;
  const LinearMill mill(folder);
  LaserScreenDriver driver;
  make_ready(driver, folder, mill);
  REQUIRE(driver.shows_after("\n", "saved, but not sent: "));
  CHECK(std::filesystem::exists(folder.path / "map.csv"));
  CHECK(driver.controller().unsaved().empty());
  CHECK(contains(driver.seen(), "no link to a unit"));
}

const char* const kStale = "the unit has changed since then: verify again";

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
  REQUIRE(driver.shows_after("s", "saved: "));
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
  CHECK(contains(changed_since(then, now), "unit MCM-0999 answers instead of MCM-0107"));
  now = then;
  now.check = 0xCAFE0001;
  CHECK(contains(changed_since(then, now), "checksum CAFE0001 instead of checksum 12345678"));
  now.check.reset();
  CHECK(contains(changed_since(then, now), "no map instead of"));
  now = then;
  now.activations = 5;
  CHECK(contains(changed_since(then, now), "another host made a map"));
  now = then;
  now.uptime_s = 3;
  CHECK(changed_since(then, now) == "it was restarted");
  now = then;
  now.opened_at += std::chrono::seconds(5);
  CHECK(changed_since(then, now) == "the link to it was reopened");
}

TEST_CASE("another host makes another map active: the verdict is said to be stale, and compensation is refused") {
  ReadyMill ready;
  LaserScreenDriver& driver = ready.driver;
  save_another_map(driver, ready.folder);
  send_from(ready);
  verify_at(driver);
  CHECK(driver.controller().verified());
  CHECK(contains(driver.seen(), "commit no. 1"));

  as_another_host(driver, [&](UnitLink& link) {
    return map_sent_over(link, (ready.folder.path / "other.csv").string(),
                         (ready.folder.path / "other-parameters.toml").string());
  });
  SUBCASE("on its own within seconds while the step is open") {
    CHECK(driver.until([&] { return contains(driver.seen(), kStale); }, 10));
    CHECK(driver.controller().mark(LaserStep::verify) == LaserMark::doubtful);
    CHECK(contains(driver.seen(), "another host"));
    CHECK(!contains(driver.seen(), "reference every axis"));
    verify_at(driver);
    CHECK(driver.controller().stale().empty());
    CHECK_FALSE(driver.controller().verdict()->same());
    CHECK(driver.shows_after("c", "the map of the file is not in the unit"));
  }
  SUBCASE("but once that map is the one of the file here and compared, the unit may compensate with it") {
    driver.controller().change("the other map", [&](LaserChoices& c) {
      laser::settings_in(c.recipe, Component::EXX).smoothing_mm = 800.0;
      c.map_file = (ready.folder.path / "other.csv").string();
    });
    REQUIRE(driver.settled());
    REQUIRE(driver.shows_after("sy", "saved: "));
    verify_at(driver);
    CHECK(driver.controller().verified());
    CHECK(driver.shows_after("cy", "reference every axis at the control now; the unit is waiting"));
  }
  SUBCASE("and compensation, asked for at once, is refused with both checksums") {
    CHECK(driver.shows_after("cy", "another host has changed it"));
    CHECK(contains(driver.seen(), fmt::format("{:08X}", driver.controller().sent()->check)));
    CHECK(driver.unit->newest()->mode == UnitMode::integration);
  }
}

TEST_CASE(
    "a map that was verified but not sent from here counts: compensation is refused once the unit holds another") {
  ReadyMill ready;
  LaserScreenDriver& driver = ready.driver;
  save_another_map(driver, ready.folder);
  REQUIRE(driver.shows_after("s", "saved: "));
  CHECK_FALSE(contains(driver.after("9c"), "Switch the unit to compensation?"));
  CHECK(contains(driver.seen(), "the map in the unit is not known: press Enter to compare"));
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
  CHECK(driver.until([&] { return contains(driver.controller().message().text(), "the compared map was checksum"); }));
  as_another_host(driver, [&](UnitLink& link) {
    return map_sent_over(link, (ready.folder.path / "map.csv").string(),
                         (ready.folder.path / "map-parameters.toml").string());
  });
  CHECK(driver.shows_after("cy", "reference every axis at the control now; the unit is waiting"));
}

TEST_CASE("a unit that was switched off and on has to be verified again") {
  ReadyMill ready;
  LaserScreenDriver& driver = ready.driver;
  send_from(ready);
  verify_at(driver);
  SUBCASE("with its line") {
    ready.unit.kill();
    ready.unit.start();
    CHECK(driver.until([&] { return contains(driver.seen(), kStale); }, 30));
  }
  SUBCASE("while the line stayed open") {
    driver.until([] { return false; }, 5);  // long enough that the next sample shows a shorter time since the start
    as_another_host(driver, [](UnitLink& link) { return link.client().reset_unit(); });
    CHECK(driver.until([&] { return contains(driver.seen(), kStale); }, 30));
    CHECK(contains(driver.seen(), "it was restarted"));
  }
  verify_at(driver);
  CHECK(driver.controller().verified());
}

}  // namespace
}  // namespace ecs::app
