#include "modules/capture/description.hpp"

#include <fstream>
#include <iterator>

#include <rapidcheck.h>

#include "modules/capture/port.hpp"
#include "tests/support/test.hpp"

namespace ecs::devices {
namespace {

DeviceDescription read(const char* file) { return must(read_device(std::string("samples/devices/") + file)); }

TEST_CASE("the sample descriptions read, and what is written of them reads back as the same text") {
  for (const char* file : {"foot_switch.toml", "environment.toml", "gauge.toml"}) {
    const std::string text = to_toml(read(file));
    CHECK(to_toml(must(parse_device(text, "again.toml"))) == text);
  }
}

TEST_CASE("every wrong key of a description is reported at once, with its line") {
  const std::string text = to_text(must_fail(parse_device(
      "name = \"x\"\nkind = \"trigger\"\n[match]\nvendor_id = 70000\nproduct_id = 1\n[trigger]\nbyte = 0\nbit = 9\n"
      "actve = \"high\"\n",
      "bad.toml")));
  check_holds(text, {"bad.toml:4", "vendor_id: expected a whole number from 0 to 65535", "bad.toml:8",
                     "did you mean \"active\""});
}

TEST_CASE("a field beyond the report, and a gauge that measures degrees, are refused") {
  const auto beyond = must_fail(parse_device(
      "name = \"x\"\nkind = \"environment\"\n[match]\nvendor_id = 1\nproduct_id = 1\n[report]\nlength = 8\n[[field]]\n"
      "quantity = \"air_degC\"\nbyte = 7\n",
      "e.toml"));
  CHECK(contains(to_text(beyond), "bytes 7 to 8 are beyond the report of 8 bytes"));
  const auto gauge = must_fail(
      parse_device("name = \"x\"\nkind = \"gauge\"\n[match]\nvendor_id = 1\nproduct_id = 1\n[[field]]\nquantity = "
                   "\"air_degC\"\nbyte = 0\n",
                   "g.toml"));
  CHECK(contains(to_text(gauge), "expected reading_um"));
}

TEST_CASE("bytes and scales that no number holds are refused") {
  const std::string gauge =
      "name = \"g\"\nkind = \"gauge\"\n[match]\nvendor_id = 1\nproduct_id = 2\n"
      "[[field]]\nquantity = \"reading_um\"\nbyte = 1\n";
  CHECK(parse_device(gauge + "scale = 0.01\nstarts = [1, 255]\n", "g.toml"));
  for (const char* line : {"starts = [1e300]", "starts = [256]", "scale = 1e300", "offset = -1e300"}) {
    CAPTURE(line);
    CHECK(must_fail(parse_device(gauge + line + "\n", "g.toml")).line == 9);
  }
}

TEST_CASE("the button is held when all bits of the mask are active, whichever way that is") {
  DeviceDescription device;
  device.trigger = {2, 0x05, true, 30};
  CHECK(held_in(device, {0, 0, 0x05}) == true);
  CHECK(held_in(device, {0, 0, 0x0F}) == true);
  CHECK(held_in(device, {0, 0, 0x04}) == false);
  device.trigger.active_high = false;
  CHECK(held_in(device, {0, 0, 0x0A}) == true);
  CHECK(held_in(device, {0, 0, 0x01}) == false);
  CHECK(!held_in(device, {0, 0}).has_value());
  device.report.number = 3;
  CHECK(!held_in(device, {1, 0, 0x05}).has_value());
  CHECK(held_in(device, {3, 0, 0x00}) == true);
}

TEST_CASE("fields read both byte orders, signs, scales, offsets and the mark of an absent sensor") {
  const DeviceDescription sensor = read("environment.toml");
  const Values values = values_in(sensor, {{0x52, 0, 0x3A, 0x08, 0x00, 0x80, 0x1D, 0x8B, 0x01, 0x00, 0xC4, 0x11}});
  CHECK(values.at(Quantity::air_degC) == Approx(21.06));                                      // 0x083A = 2106
  CHECK(values.count(Quantity::material_degC) == 0);                                          // 0x8000 = -32768: absent
  CHECK(values.at(Quantity::pressure_hPa) == Approx(1011.49));                                // 0x00018B1D = 101149
  CHECK(values.at(Quantity::humidity_pct) == Approx(45.48));                                  // 0x11C4 = 4548
  CHECK(values_in(sensor, {{0x52, 0, 0x18, 0xFC}}).at(Quantity::air_degC) == Approx(-10.0));  // 0xFC18 = -1000
}

TEST_CASE("TEMPer sticks of both protocols read as their users published") {
  const auto fm75 = builtin_named("temper-fm75").at(0);
  CHECK(values_in(fm75, {{0x80, 0x02, 0x13, 0x50, 0x65, 0x72, 0x31, 0x46}}).at(Quantity::air_degC) == Approx(19.3125));
  CHECK(values_in(fm75, {{0x80, 0x02, 0x13, 0x50, 0x65, 0x72, 0x31, 0x46}}).size() == 1);
  CHECK(values_in(fm75, {{0x80, 0x02, 0xFB, 0x80, 0, 0, 0, 0}}).at(Quantity::air_degC) == Approx(-4.5));
  CHECK(values_in(fm75, {{0x80, 0x04, 0xFF, 0xFF, 0xFF, 0xFF, 0, 0}}).empty());
  const auto hundredths = builtin_named("temper-hundredths").at(0);
  const Values two =
      values_in(hundredths, {{0x80, 0x80, 0x08, 0x5F, 0x4E, 0x20, 0, 0}, {0x80, 0x01, 0x07, 0x8B, 0x4E, 0x20, 0, 0}});
  CHECK(two.at(Quantity::air_degC) == Approx(21.43));
  CHECK(two.at(Quantity::material_degC) == Approx(19.31));
  CHECK(two.size() == 2);
  const Values humid = values_in(hundredths, {{0x80, 0x20, 0x09, 0x01, 0x11, 0x93, 0, 0}});
  CHECK(humid.at(Quantity::air_degC) == Approx(23.05));
  CHECK(humid.at(Quantity::humidity_pct) == Approx(44.99));
  CHECK(builtin_named("temper").size() == 2);
}

TEST_CASE("a report descriptor gives the lengths of the reports") {
  const Bytes plain{0x06, 0x00, 0xFF, 0x09, 0x01, 0xA1, 0x01, 0x19, 0x01, 0x29, 0x08, 0x15, 0x00, 0x26, 0xFF,
                    0x00, 0x75, 0x08, 0x95, 0x08, 0x81, 0x02, 0x19, 0x01, 0x29, 0x08, 0x91, 0x02, 0xC0};
  const HidReports reports = reports_in(plain);
  CHECK(!reports.numbered);
  CHECK(reports.input.at(0) == 8);
  CHECK(reports.output.at(0) == 8);
  // report 1: 3 buttons and 5 bits of padding; report 2: 16 bits; feature 2: 7 bytes
  const Bytes numbered{0x85, 0x01, 0x75, 0x01, 0x95, 0x03, 0x81, 0x02, 0x95, 0x05, 0x81, 0x03, 0x85,
                       0x02, 0x75, 0x10, 0x95, 0x01, 0x81, 0x02, 0x75, 0x08, 0x95, 0x07, 0xB1, 0x02};
  const HidReports two = reports_in(numbered);
  CHECK(two.numbered);
  CHECK(two.input.at(1) == 2);
  CHECK(two.input.at(2) == 3);
  CHECK(two.feature.at(2) == 8);
  CHECK(reports_in({}).input.empty());
  const Bytes cut{0x75, 0x08, 0x95, 0x08, 0x81, 0x02, 0x26, 0xFF};
  CHECK(reports_in(cut).input.at(0) == 8);
}

TEST_CASE("no report descriptor and no report, however garbled, does harm") {
  rc::check([] {
    const auto bytes = *rc::gen::arbitrary<Bytes>();
    for (const auto& entry : reports_in(bytes).input) RC_ASSERT(entry.second <= 8193u);
    for (const DeviceDescription& device : builtin_devices())
      for (const auto& entry : values_in(device, {bytes})) RC_ASSERT(std::abs(entry.second) < 1e3);
    static_cast<void>(held_in(*read_device("samples/devices/foot_switch.toml"), bytes));
  });
}

TEST_CASE("a missing device, and two identical ones, are reported with what to do") {
  DeviceDescription pedal = read("foot_switch.toml");
  HidIdentity one{"/dev/hidraw0", 0x16C0, 0x27DB, "A1", "Maker", "Pedal", 0, 0, 0, {}};
  HidIdentity two = one;
  two.path = "/dev/hidraw4";
  two.serial = "B2";
  const auto none = must_fail(matching(pedal, {}));
  CHECK(none.kind == ProblemKind::link);
  CHECK(none.message.find("foot switch (16c0:27db) is not plugged in") == 0);
  check_holds(must_fail(matching(pedal, {one, two})).message, {"serial A1", "@SERIAL"});
  pedal.match.serial = "B2";
  CHECK(matching(pedal, {one, two})->path == "/dev/hidraw4");
  pedal.match.serial.reset();
  pedal.match.path = "/dev/hidraw0";
  CHECK(matching(pedal, {one, two})->serial == "A1");
}

TEST_CASE("the shipped udev rules are those that are printed") {
  std::ifstream file("modules/capture/70-ecs.rules");
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  CHECK(text == udev_rules(builtin_devices()));
  CHECK(contains(text, "ATTRS{idVendor}==\"0c45\", ATTRS{idProduct}==\"7401\""));
}

}  // namespace
}  // namespace ecs::devices
