// Surroundings beside the monitor: run under umockdev-wrapper.
#include <chrono>
#include <thread>

#include <doctest/doctest.h>

#include "modules/capture/devices.hpp"
#include "tests/support/fake_devices/fake_hid.hpp"

namespace ecs::commissioning {
namespace {

bool says(const SurroundingsWatch& watch, const std::string& text) {
  for (int k = 0; k < 500; ++k) {
    if (watch.now().text.find(text) != std::string::npos) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  MESSAGE(watch.now().text);
  return false;
}

TEST_CASE("a thermometer is read beside the monitor, reported when unplugged, and read again when it is back") {
  fake::Bus bus;
  const auto watch = environment_watch("temper", 0.1);
  CHECK(says(*watch, "temper"));  // none is plugged in, and that is said
  auto stick = bus.plug(fake::temper_spec(0x0C45, 0x7401));
  fake::answer_like_temper(*stick, {{0x80, 0x04, 0x14, 0x80, 0x13, 0x40, 0, 0}});  // 20.5 and 19.25 degC
  CHECK(says(*watch, "air 20.50 degC, material 19.25 degC"));
  stick->unplug();
  CHECK(says(*watch, "was unplugged"));
  stick = bus.plug(fake::temper_spec(0x0C45, 0x7401));
  fake::answer_like_temper(*stick, {{0x80, 0x04, 0x15, 0x00, 0x13, 0x40, 0, 0}});
  CHECK(says(*watch, "air 21.00 degC"));
}

TEST_CASE("a device that is not an environment sensor is refused with its kind") {
  const auto watch = environment_watch("samples/devices/foot_switch.toml", 0.1);
  CHECK(says(*watch, "trigger"));
}

}  // namespace
}  // namespace ecs::commissioning
