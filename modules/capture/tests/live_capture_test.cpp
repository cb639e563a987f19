// A capture on the screen, typed, and with a foot switch, a gauge and a thermometer: run under umockdev-wrapper.
#include <filesystem>

#include <fmt/format.h>

#include "app/screens/forms/rows.hpp"
#include "app/verbs/registry.hpp"
#include "laser/measurement_set.hpp"
#include "tests/support/fake_devices/fake_hid.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/screen_driver.hpp"
#include "tests/support/verb_run.hpp"

namespace ecs::app {
namespace {

using namespace screen_test;

/// Three runs of three targets, forward and back.
FormValues asked_for(const std::string& output) {
  return {{"--axis", "Y"},
          {"--sense", "EX"},
          {"--from", "0"},
          {"--to", "200"},
          {"--step", "100"},
          {"--runs", "3"},
          {"--trigger", "samples/devices/foot_switch.toml"},
          {"--gauge", "samples/devices/gauge.toml"},
          {"--environment", "temper"},
          {"--environment-every", "0.2"},
          {"--min-interval", "0.05"},
          {"--output", output}};
}

VerbEntry capture_verb() {
  for (const MenuEntry& menu : verb_catalogue(all_verbs()))
    for (const VerbEntry& verb : menu.verbs)
      if (verb.name() == "laser capture") return verb;
  return {};
}

TEST_CASE(
    "three runs with trigger, gauge and thermometer on the screen, the trigger and the gauge unplugged in between") {
  const Folder folder;
  const std::string out = folder / "c0y.csv";
  fake::Bus bus;
  auto pedal = bus.plug(fake::pedal_spec());
  auto gauge = bus.plug(fake::gauge_spec());
  const auto stick = bus.plug(fake::temper_spec(0x0C45, 0x7401));
  fake::answer_like_temper(*stick, {{0x80, 0x04, 0x14, 0x80, 0x13, 0x40, 0, 0}});  // 20.5 and 19.25 degC
  const auto screen_made = form_screen({.verb = "laser capture"}, capture_verb(), no_link(), asked_for(out), true);
  Screen& screen = *screen_made;
  for (int k = 0; k < 18; ++k) {
    REQUIRE(shows(screen, fmt::format("reading {} of 18)", k + 1), 30, 120));
    if (k == 7) {
      pedal->unplug();
      REQUIRE(shows(screen, "unplugged. 7 reading", 30, 120));
      pedal = bus.plug(fake::pedal_spec());
      REQUIRE(shows(screen, "is back", 30, 120));
    }
    if (k == 11) {
      gauge->unplug();
      REQUIRE(shows(screen, "unplugged. 11 reading", 30, 120));
      fake::press(*pedal);
      REQUIRE(shows(screen, "not accepted: the gauge is unplugged", 30, 120));
      gauge = bus.plug(fake::gauge_spec());
      REQUIRE(shows(screen, "Indicator (/dev/hidraw4", 30, 120));
      fake::rest(100);
    }
    fake::show(*gauge, 0.5 * k);
    fake::rest(60);
    // on a busy computer a press may be too short to be seen: then, as a person does, once more
    const std::string then = k == 17 ? "18 of 18 planned" : fmt::format("reading {} of 18)", k + 2);
    bool taken = false;
    for (int attempt = 0; attempt < 3 && !taken; ++attempt) {
      fake::press(*pedal, 35);
      taken = shows(screen, then, 5, 120);
    }
    REQUIRE(taken);
  }
  REQUIRE(shows(screen, "18 of 18 planned readings written", 30, 120));
  const auto set = must(laser::read_measurement_set(out));
  REQUIRE(set.readings.size() == 18);
  for (std::size_t k = 0; k < 18; ++k) {
    CHECK(set.readings[k].error == Approx(0.5 * static_cast<double>(k)));
    CHECK(set.readings[k].run == static_cast<int>(k / 6) + 1);
    CHECK(set.readings[k].sensors_degC.at("t_air_degC") == 20.5);
    CHECK(set.readings[k].sensors_degC.at("t_material_degC") == 19.25);
  }
}

/// At the second of two targets, without devices.
std::unique_ptr<Screen> typed_capture(const StateFolder& folder) {
  auto screen = form_screen({.verb = "laser capture"}, capture_verb(), no_link(),
                            {{"--axis", "X"},
                             {"--sense", "EX"},
                             {"--from", "0"},
                             {"--to", "50"},
                             {"--step", "50"},
                             {"--runs", "1"},
                             {"--min-interval", "0"},
                             {"--output", (folder.path / "x.csv").string()}},
                            true);
  REQUIRE(shows(*screen, "next: X forward to 0 mm (target 1 of 2"));
  REQUIRE(shows_after(*screen, "0.5\n", "next: X forward to 50 mm (target 2 of 2"));
  return screen;
}

TEST_CASE("a capture leads through its targets on the screen and ends with its file") {
  const StateFolder folder;
  const auto screen = typed_capture(folder);
  CHECK(contains(picture(*screen), "0.50 um at X 0 mm"));
  REQUIRE(shows_after(*screen, "u\n", "next: X forward to 0 mm (target 1 of 2"));
  for (const char* value : {"0", "1", "2", "3"}) enter(*screen, value);
  REQUIRE(shows(*screen, "4 of 4 planned readings written"));
  CHECK(std::filesystem::exists(folder.path / "x.csv"));
  CHECK(press(*screen, Key::Name::escape).kind == Step::Kind::stay);
  CHECK(press(*screen, Key::Name::escape).kind == Step::Kind::back);
}

TEST_CASE("escape leaves a capture with what was read in its part file, and so does closing the screen") {
  const StateFolder folder;
  SUBCASE("escape") {
    const auto screen = typed_capture(folder);
    CHECK(press(*screen, Key::Name::escape).kind == Step::Kind::stay);
    REQUIRE(shows(*screen, "not finished: see below"));
  }
  SUBCASE("closed") { (void)typed_capture(folder); }
  CHECK(std::filesystem::exists(folder.path / "x.csv.part"));
}

}  // namespace
}  // namespace ecs::app
