// A capture on the screen with a foot switch, a gauge and a thermometer: run under umockdev-wrapper.
#include <chrono>
#include <filesystem>
#include <thread>

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "tests/support/verb_run.hpp"
#include "app/screens/verbs/live_screen.hpp"
#include "app/ui/screen_program.hpp"
#include "tests/support/fake_hid.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::app {
namespace {

void rest(int ms) { std::this_thread::sleep_for(std::chrono::milliseconds(ms)); }

std::string seen(const Screen& screen) {
  return picture_of(screen, screen.title(), {}, Canvas(30, 120, Glyphs::unicode), false).plain_text();
}

bool shows(LiveScreen& screen, const std::string& text) {
  for (int k = 0; k < 1000; ++k) {
    (void)screen.advance();
    if (seen(screen).find(text) != std::string::npos) return true;
    rest(10);
  }
  MESSAGE(seen(screen));
  return false;
}

/// Three runs of three targets, forward and back.
std::vector<std::string> words(const std::string& output) {
  return {"laser",
          "capture",
          "--axis",
          "Y",
          "--sense",
          "EX",
          "--from",
          "0",
          "--to",
          "200",
          "--step",
          "100",
          "--runs",
          "3",
          "--trigger",
          "samples/devices/foot_switch.toml",
          "--gauge",
          "samples/devices/gauge.toml",
          "--environment",
          "temper",
          "--environment-every",
          "0.2",
          "--min-interval",
          "0.05",
          "-o",
          output};
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
  LiveScreen screen("laser capture", words(out));
  for (int k = 0; k < 18; ++k) {
    REQUIRE(shows(screen, fmt::format("{} of 18 in all", k + 1)));
    if (k == 7) {
      pedal->unplug();
      REQUIRE(shows(screen, "Nothing is lost: 7"));
      pedal = bus.plug(fake::pedal_spec());
      REQUIRE(shows(screen, "is back"));
    }
    if (k == 11) {
      gauge->unplug();
      REQUIRE(shows(screen, "Nothing is lost: 11"));
      fake::press(*pedal);
      REQUIRE(shows(screen, "not taken: the gauge is unplugged"));
      gauge = bus.plug(fake::gauge_spec());
      REQUIRE(shows(screen, "Indicator (/dev/hidraw4"));
      rest(100);
    }
    fake::show(*gauge, 0.5 * k);
    rest(60);
    fake::press(*pedal, 35);
  }
  REQUIRE(shows(screen, "18 readings of 18 targets written"));
  const auto set = laser::read_measurement_set(out);
  REQUIRE(set);
  REQUIRE(set->readings.size() == 18);
  for (std::size_t k = 0; k < 18; ++k) {
    CHECK(set->readings[k].error == doctest::Approx(0.5 * static_cast<double>(k)));
    CHECK(set->readings[k].run == static_cast<int>(k / 6) + 1);
    CHECK(set->readings[k].sensors_degC.at("t_air_degC") == 20.5);
    CHECK(set->readings[k].sensors_degC.at("t_material_degC") == 19.25);
  }
}

}  // namespace
}  // namespace ecs::app
