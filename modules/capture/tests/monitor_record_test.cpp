// Recordings of the monitor with a thermometer beside it: run under umockdev-wrapper.
#include <chrono>
#include <filesystem>
#include <optional>
#include <thread>

#include <doctest/doctest.h>

#include "app/screens/unit/screens.hpp"
#include "app/ui/screen_program.hpp"
#include "base/text.hpp"
#include "tests/support/fake_devices/fake_hid.hpp"
#include "tests/support/unit_model.hpp"
#include "tests/support/verb_run.hpp"

namespace ecs::app {
namespace {

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
  for (int k = 0; k < 500 && seen().find("air 20.50") == std::string::npos; ++k) look(1);
  CHECK(seen().find("material 19.25") != std::string::npos);
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
