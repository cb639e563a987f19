// The real hidapi over devices that umockdev plays: run under umockdev-wrapper.
#include <chrono>
#include <thread>

#include <unistd.h>

#include "modules/capture/description.hpp"
#include "modules/capture/port.hpp"
#include "tests/support/fake_devices/fake_hid.hpp"
#include "tests/support/test.hpp"

namespace ecs::devices {
namespace {

using std::chrono::milliseconds;

double steady_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

DeviceDescription pedal() { return *read_device("samples/devices/foot_switch.toml"); }

int presses_within(Trigger& trigger, double seconds) {
  int presses = 0;
  for (const double end = steady_s() + seconds; steady_s() < end;) {
    presses += trigger.pressed(milliseconds(10), steady_s()) ? 1 : 0;
    static_cast<void>(trigger.look(steady_s()));
  }
  return presses;
}

/// What a sensor says within two seconds.
Values values_of(Sensor& sensor) {
  for (const double end = steady_s() + 2.0; steady_s() < end && sensor.answers() == 0;) {
    sensor.attend(steady_s());
    std::this_thread::sleep_for(milliseconds(5));
  }
  return sensor.values(steady_s(), 10.0);
}

TEST_CASE("devices are listed with ids, names, serial number, interface, usage page and report lengths") {
  fake::Bus bus;
  CHECK(hid_devices()->empty());
  fake::DeviceSpec spec = fake::pedal_spec("A1");
  spec.interface = 2;
  const auto device = bus.plug(spec);
  const auto found = must(hid_devices());
  REQUIRE(found.size() == 1);
  const HidIdentity& one = found.front();
  CHECK(one.path == "/dev/hidraw0");
  CHECK(one.vendor_id == 0x16C0);
  CHECK(one.product_id == 0x27DB);
  CHECK(one.serial == "A1");
  CHECK(one.manufacturer == "Maker");
  CHECK(one.product == "Pedal");
  CHECK(one.interface == 2);
  CHECK(one.usage_page == 0xFF00);
  CHECK(one.reports.input.at(0) == 8);
}

TEST_CASE("reports are read completely, within the time, and what is written arrives") {
  fake::Bus bus;
  const auto device = bus.plug(fake::pedal_spec());
  fake::Bytes arrived;
  device->answers([&arrived](const fake::Bytes& written) {
    arrived = written;
    return std::vector<fake::Bytes>{{9, 8, 7, 6, 5, 4, 3, 2}};
  });
  auto opened = must(HidDevice::open(hid_devices()->front()));
  CHECK(!opened.read(8, milliseconds(20))->has_value());
  const Bytes query{1, 2, 3, 4, 5, 6, 7, 8};
  REQUIRE(opened.write(0, query));
  CHECK(must(must(opened.read(8, milliseconds(1000)))) == Bytes{9, 8, 7, 6, 5, 4, 3, 2});
  CHECK(arrived == fake::Bytes{0, 1, 2, 3, 4, 5, 6, 7, 8});
}

TEST_CASE("a feature report is asked for by its number, and comes without the 0 of unnumbered ones") {
  fake::Bus bus;
  fake::DeviceSpec spec = fake::pedal_spec();
  spec.feature = {0, 0xAA, 0xBB, 0xCC};
  const auto device = bus.plug(spec);
  CHECK(must(must(HidDevice::open(hid_devices()->front())).feature(0, 3)) == Bytes{0xAA, 0xBB, 0xCC});
}

TEST_CASE("without permission the message names the udev rule") {
  fake::Bus bus;
  const auto device = bus.plug(fake::pedal_spec());
  const auto found = hid_devices();
  REQUIRE(found->size() == 1);
  bus.forbid(*device);
  const bool root = ::geteuid() == 0;
  if (root) REQUIRE(::seteuid(65534) == 0);
  const auto opened = HidDevice::open(found->front());
  if (root) REQUIRE(::seteuid(0) == 0);
  REQUIRE(!opened);
  CHECK(opened.error().kind == ProblemKind::link);
  const std::string& message = opened.error().message;
  CHECK(message.find("no permission for 16c0:27db") == 0);
  check_holds(message, {"/etc/udev/rules.d/70-ecs.rules", "ATTRS{idVendor}==\"16c0\", ATTRS{idProduct}==\"27db\""});
}

TEST_CASE("a press is a press once, however much the contact bounces") {
  fake::Bus bus;
  const auto device = bus.plug(fake::pedal_spec());
  auto port = must(DevicePort::open(pedal()));
  Trigger trigger(std::move(port));
  std::thread foot([&] {
    fake::press_bouncing(*device, 3);
    fake::press_bouncing(*device, 3);
  });
  CHECK(presses_within(trigger, 1.0) == 2);
  foot.join();
}

TEST_CASE("an unplugged trigger is reported once, waited for, and works again under another path") {
  fake::Bus bus;
  auto device = bus.plug(fake::pedal_spec());
  auto port = must(DevicePort::open(pedal()));
  Trigger trigger(std::move(port));
  fake::press(*device);
  CHECK(presses_within(trigger, 0.2) == 1);
  device->unplug();
  int lost = 0, back = 0;
  const auto count = [&](double seconds) {
    for (const double end = steady_s() + seconds; steady_s() < end;) {
      static_cast<void>(trigger.pressed(milliseconds(5), steady_s()));
      const PortChange change = trigger.look(steady_s());
      lost += change == PortChange::lost ? 1 : 0;
      back += change == PortChange::back ? 1 : 0;
      std::this_thread::sleep_for(milliseconds(5));
    }
  };
  count(0.8);
  CHECK(lost == 1);
  CHECK(back == 0);
  CHECK(!trigger.port().present());
  device = bus.plug(fake::pedal_spec());
  count(0.8);
  CHECK(lost == 1);
  CHECK(back == 1);
  CHECK(trigger.port().identity().path == "/dev/hidraw1");
  fake::press(*device);
  CHECK(presses_within(trigger, 0.2) == 1);
}

TEST_CASE("of two alike, the one whose serial number is said is opened; unsaid, it is asked for") {
  fake::Bus bus;
  const auto left = bus.plug(fake::pedal_spec("LEFT"));
  const auto right = bus.plug(fake::pedal_spec("RIGHT"));
  const auto unsaid = must_fail(DevicePort::open(pedal()));
  CHECK(unsaid.message.find("2 devices match foot switch") == 0);
  CHECK(contains(unsaid.message, "serial RIGHT"));
  DeviceDescription said = pedal();
  said.match.serial = "RIGHT";
  auto port = must(DevicePort::open(said));
  Trigger trigger(std::move(port));
  fake::press(*left);
  CHECK(presses_within(trigger, 0.15) == 0);
  fake::press(*right);
  CHECK(presses_within(trigger, 0.15) == 1);
}

TEST_CASE("a TEMPer stick of the older protocol gives air, and the table's probe where it has one") {
  fake::Bus bus;
  const auto stick = bus.plug(fake::temper_spec(0x0C45, 0x7401));
  fake::answer_like_temper(*stick, {{0x80, 0x04, 0x13, 0x50, 0x14, 0x80, 0, 0}});
  auto port = must(DevicePort::open(builtin_named("temper-fm75").at(0)));
  Sensor sensor(std::move(port), 1.0);
  const Values values = values_of(sensor);
  CHECK(values.at(Quantity::air_degC) == Approx(19.3125));
  CHECK(values.at(Quantity::material_degC) == Approx(20.5));
}

TEST_CASE("a TEMPer stick of the newer protocol answers with two reports") {
  fake::Bus bus;
  const auto stick = bus.plug(fake::temper_spec(0x1A86, 0xE025));
  fake::answer_like_temper(*stick,
                           {{0x80, 0x80, 0x08, 0x5F, 0x4E, 0x20, 0, 0}, {0x80, 0x01, 0x07, 0x8B, 0x4E, 0x20, 0, 0}});
  auto port = must(DevicePort::open(builtin_named("temper-hundredths").at(0)));
  Sensor sensor(std::move(port), 1.0);
  const Values values = values_of(sensor);
  CHECK(values.at(Quantity::air_degC) == Approx(21.43));
  CHECK(values.at(Quantity::material_degC) == Approx(19.31));
}

TEST_CASE("a described sensor with a feature report is read without waiting for reports") {
  fake::Bus bus;
  fake::DeviceSpec spec = fake::pedal_spec();
  spec.feature = {0, 0x00, 0x08, 0x34};  // 0x0834 = 2100
  const auto device = bus.plug(spec);
  const auto description = must(parse_device(
      "name = \"probe\"\nkind = \"environment\"\n[match]\nvendor_id = 0x16c0\nproduct_id = 0x27db\n[report]\ntype = "
      "\"feature\"\nlength = 3\n[[field]]\nquantity = \"material_degC\"\nbyte = 1\norder = \"big\"\nscale = 0.01\n",
      "probe.toml"));
  auto port = must(DevicePort::open(description));
  Sensor sensor(std::move(port), 1.0);
  CHECK(values_of(sensor).at(Quantity::material_degC) == Approx(21.0));
}

TEST_CASE("a sensor that answers nothing is silent, and its old values age") {
  fake::Bus bus;
  const auto stick = bus.plug(fake::temper_spec(0x0C45, 0x7401));
  DeviceDescription description = builtin_named("temper-fm75").at(0);
  description.report.timeout_ms = 50;
  auto port = must(DevicePort::open(description));
  Sensor sensor(std::move(port), 0.05);
  for (const double end = steady_s() + 0.5; steady_s() < end;) {
    sensor.attend(steady_s());
    std::this_thread::sleep_for(milliseconds(5));
  }
  CHECK(sensor.silent() >= 3);
  CHECK(sensor.values(steady_s(), 10.0).empty());
}

TEST_CASE("a gauge that sends on its own keeps the value it sent last") {
  fake::Bus bus;
  const auto device = bus.plug(fake::gauge_spec());
  auto port = must(DevicePort::open(*read_device("samples/devices/gauge.toml")));
  Sensor sensor(std::move(port), 1.0);
  fake::show(*device, -12.3);
  CHECK(values_of(sensor).at(Quantity::reading_um) == Approx(-12.3));
}

}  // namespace
}  // namespace ecs::devices
