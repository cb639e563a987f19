// `ecs laser devices` over devices that umockdev plays; recordings of the monitor with a thermometer beside it: run
// under umockdev-wrapper.
#include <chrono>
#include <filesystem>
#include <thread>

#include "app/screens/unit/screens.hpp"
#include "app/ui/screen_program.hpp"
#include "base/text.hpp"
#include "tests/support/fake_devices/fake_hid.hpp"
#include "tests/support/unit_model.hpp"
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
  CHECK(contains(run.messages, "3 of 3"));
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
  CHECK(contains(run.messages, "the bit of the button is ambiguous"));
  CHECK(!std::filesystem::exists(folder / "p.toml"));
}

TEST_CASE("try shows the temperatures of a stick") {
  fake::Bus bus;
  const auto stick = bus.plug(fake::temper_spec(0x1A86, 0xE025));
  fake::answer_like_temper(*stick, {{0x80, 0x20, 0x09, 0x01, 0x11, 0x93, 0, 0}});
  const Ran run = ran({"laser", "devices", "--try", "temper", "--timeout", "5", "--json"});
  REQUIRE_MESSAGE(run.code == 0, run.out);
  CHECK(run.json()["answers"][0]["air_degC"] == Approx(23.05));
  CHECK(run.json()["answers"][0]["humidity_pct"] == Approx(44.99));
}

TEST_CASE("a device that is not plugged in ends with exit code 4 and says what is there") {
  fake::Bus bus;
  const auto pedal = bus.plug(fake::pedal_spec());
  const Ran run = ran({"laser", "devices", "--try", "temper"});
  CHECK(run.code == 4);
  CHECK(contains(run.messages, "is not plugged in; available: 16c0:27db Maker Pedal"));
}

TEST_CASE("the udev rules cover the devices that come with the program and those that are described") {
  const Ran run = ran({"laser", "devices", "--udev", "samples/devices/foot_switch.toml"});
  CHECK(run.code == 0);
  check_holds(run.out, {"ATTRS{idVendor}==\"0c45\", ATTRS{idProduct}==\"7401\"",
                        "ATTRS{idVendor}==\"16c0\", ATTRS{idProduct}==\"27db\""});
}

constexpr const char* kHeader =
    "time_s,mode,fault,axis,position_mm,speed_mm_min,referenced,switch,marker,approach,compensation_um,output_counts,"
    "relay_closed,t_air_degC,t_material_degC";

std::unique_ptr<fake::Device> stick_in(fake::Bus& bus) {
  auto stick = bus.plug(fake::temper_spec(0x0C45, 0x7401));
  fake::answer_like_temper(*stick, {{0x80, 0x04, 0x14, 0x80, 0x13, 0x40, 0, 0}});  // 20.5 and 19.25 degC
  return stick;
}

/// How many rows end in these two fields, and whether every row has as many fields as the header.
struct Rows {
  std::size_t measured = 0;
  std::size_t empty = 0;
  bool whole = true;
  bool ends_empty = false;
};
Rows rows_of(const std::string& csv) {
  Rows rows;
  bool first = true;
  for (const std::string_view line : lines_of(csv)) {
    if (std::exchange(first, false)) {
      CHECK(line == kHeader);
      continue;
    }
    rows.whole = rows.whole && split(line, ',').size() == 15;
    rows.ends_empty = line.ends_with(",,");
    (line.ends_with(",20.5,19.25") ? rows.measured : rows.empty) += 1;
    if (!line.ends_with(",20.5,19.25")) CHECK(rows.ends_empty);
  }
  return rows;
}

TEST_CASE("ecs monitor records air and material temperature in the last columns, empty once the stick is pulled out") {
  auto shop = protocol::Workshop::on_tcp();
  fake::Bus bus;
  auto stick = stick_in(bus);
  const Folder folder;
  const std::string record = folder / "m.csv";
  std::thread hand([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(2500));
    stick->unplug();
  });
  const Ran r = ran({"monitor", "--link", protocol::to_text(shop.address()), "--count", "50", "--interval", "100",
                     "--environment", "temper", "--record", record});
  hand.join();
  REQUIRE_MESSAGE(r.code == 0, r.messages);
  const Rows rows = rows_of(content_of(record));
  CHECK(rows.whole);
  CHECK(rows.measured >= 5);
  CHECK(rows.ends_empty);
}

TEST_CASE("without a sensor the last columns of a recording are empty") {
  auto shop = protocol::Workshop::on_tcp();
  const Folder folder;
  REQUIRE(ran({"monitor", "--link", protocol::to_text(shop.address()), "--count", "2", "--interval", "5", "--record",
               folder / "m.csv"})
              .code == 0);
  const Rows rows = rows_of(content_of(folder / "m.csv"));
  CHECK(rows.whole);
  CHECK(rows.measured == 0);
  CHECK(rows.empty > 0);
}

TEST_CASE("a recording of the monitor screen has the temperatures of the thermometer beside it") {
  auto shop = protocol::Workshop::on_tcp();
  fake::Bus bus;
  auto stick = stick_in(bus);
  const Folder folder;
  const auto here = std::filesystem::current_path();
  std::filesystem::current_path(folder / "");
  auto connection = std::make_shared<UnitConnection>(protocol::to_text(shop.address()));
  auto screen = monitor_screen(connection);
  const auto press_key = [&](char32_t letter) { (void)screen->on_key({Key::Name::letter, letter}); };
  const auto look = [&](int times) {
    for (int k = 0; k < times; ++k) {
      (void)screen->advance();
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  };
  const auto seen = [&] { return picture_of(*screen, "", {}, Canvas(24, 80, Glyphs::unicode), false).plain_text(); };
  press_key(U't');
  for (int k = 0; k < 500 && !contains(seen(), "air 20.50"); ++k) look(1);
  CHECK(contains(seen(), "material 19.25"));
  press_key(U'r');
  look(60);
  press_key(U't');  // the thermometer is put away
  look(60);
  press_key(U'r');
  std::string csv;
  for (const auto& entry : std::filesystem::directory_iterator(".")) csv = content_of(entry.path().string());
  screen.reset();
  std::filesystem::current_path(here);
  const Rows rows = rows_of(csv);
  CHECK(rows.whole);
  CHECK(rows.measured > 0);
  CHECK(rows.ends_empty);
}

}  // namespace
}  // namespace ecs::app
