// `ecs laser devices` over devices that umockdev plays: run under umockdev-wrapper.
#include <chrono>
#include <thread>

#include <doctest/doctest.h>

#include "tests/support/fake_devices/fake_hid.hpp"
#include "tests/support/verb_run.hpp"

namespace ecs::app {
namespace {

TEST_CASE("devices lists what is plugged in, and which description fits") {
  fake::Bus bus;
  CHECK(ran({"laser", "devices"}).out.find("no HID device is plugged in") == 0);
  const auto pedal = bus.plug(fake::pedal_spec("A1"));
  const auto stick = bus.plug(fake::temper_spec(0x413D, 0x2107));
  const Ran run = ran({"laser", "devices", "--json"});
  REQUIRE(run.code == 0);
  const auto devices = run.json()["devices"];
  REQUIRE(devices.size() == 2);
  CHECK(devices[0]["vendor_id"] == "0x16c0");
  CHECK(devices[0]["serial"] == "A1");
  CHECK(devices[0]["described_by"].is_null());
  CHECK(devices[0]["input_reports"]["0"] == 8);
  CHECK(devices[0]["usable"] == true);
  CHECK(devices[1]["described_by"] == "temper-hundredths");
}

TEST_CASE("learn writes a description that takes the presses of that device") {
  fake::Bus bus;
  const auto pedal = bus.plug(fake::pedal_spec());
  const auto other = bus.plug(fake::gauge_spec());
  const Folder folder;
  const std::string file = folder / "pedal.toml";
  std::thread foot([&] {
    fake::rest(400);
    for (int k = 0; k < 3; ++k) fake::press_bouncing(*pedal, 2);
  });
  const Ran run = ran({"laser", "devices", "--learn", "-o", file, "--name", "pedal", "--timeout", "10", "--json"});
  foot.join();
  REQUIRE_MESSAGE(run.code == 0, run.out);
  CHECK(run.json()["byte"] == 0);
  CHECK(run.json()["mask"] == 1);
  CHECK(run.json()["active"] == "high");
  CHECK(run.json()["debounce_ms"] >= 20);
  CHECK(run.messages.find("3 of 3") != std::string::npos);
  std::thread again([&] {
    fake::rest(400);
    fake::press(*pedal);
    fake::rest(200);
    fake::press(*pedal);
  });
  const Ran tried = ran({"laser", "devices", "--try", file, "--count", "2", "--timeout", "5"});
  again.join();
  CHECK(tried.code == 0);
}

TEST_CASE("learn refuses a device whose counter moves with the button") {
  fake::Bus bus;
  const auto pedal = bus.plug(fake::pedal_spec());
  const Folder folder;
  std::thread foot([&] {
    fake::rest(400);
    for (std::uint8_t k = 0; k < 6; ++k) {
      pedal->send({static_cast<std::uint8_t>(k % 2 == 0 ? 1 : 0), 0, 0, static_cast<std::uint8_t>(k + 1), 0, 0, 0, 0});
      fake::rest(250);  // on a busy computer far above the 60 ms that count as bounce
    }
  });
  const Ran run = ran({"laser", "devices", "--learn", "-o", folder / "p.toml", "--timeout", "10"});
  foot.join();
  CHECK(run.code == 1);
  CHECK(run.messages.find("it is not clear which one is the button") != std::string::npos);
  CHECK(!std::filesystem::exists(folder / "p.toml"));
}

TEST_CASE("try shows the temperatures of a stick") {
  fake::Bus bus;
  const auto stick = bus.plug(fake::temper_spec(0x1A86, 0xE025));
  fake::answer_like_temper(*stick, {{0x80, 0x20, 0x09, 0x01, 0x11, 0x93, 0, 0}});
  const Ran run = ran({"laser", "devices", "--try", "temper", "--timeout", "5", "--json"});
  REQUIRE_MESSAGE(run.code == 0, run.out);
  CHECK(run.json()["answers"][0]["air_degC"] == doctest::Approx(23.05));
  CHECK(run.json()["answers"][0]["humidity_pct"] == doctest::Approx(44.99));
}

TEST_CASE("a device that is not plugged in ends with exit code 4 and says what is there") {
  fake::Bus bus;
  const auto pedal = bus.plug(fake::pedal_spec());
  const Ran run = ran({"laser", "devices", "--try", "temper"});
  CHECK(run.code == 4);
  CHECK(run.messages.find("is not plugged in; there are: 16c0:27db Maker Pedal") != std::string::npos);
}

TEST_CASE("the udev rules cover the devices that come with the program and those that are described") {
  const Ran run = ran({"laser", "devices", "--udev", "samples/devices/foot_switch.toml"});
  CHECK(run.code == 0);
  CHECK(run.out.find("ATTRS{idVendor}==\"0c45\", ATTRS{idProduct}==\"7401\"") != std::string::npos);
  CHECK(run.out.find("ATTRS{idVendor}==\"16c0\", ATTRS{idProduct}==\"27db\"") != std::string::npos);
}

}  // namespace
}  // namespace ecs::app
