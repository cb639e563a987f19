// Memory access with the emulator's memory, and with dumps of it.
#include "app/screens/memory/screen.hpp"

#include <algorithm>

#include "base/file.hpp"
#include "tests/screens/support/unit_screen.hpp"

namespace ecs::app {
namespace {

using namespace screen_test;

struct MemoryCase : StateFolder {
  std::shared_ptr<UnitConnection> unit = std::make_shared<UnitConnection>("emulator");
  MemoryScreen screen{unit};

  /// Goes there and waits until the bytes are read.
  void go(const std::string& where) {
    REQUIRE(until(screen, [&] {  // names are there when they are read
      type(screen, "g");
      replace_line(screen, where);
      return !contains(picture(screen), "no memory and no name");
    }));
    REQUIRE(until(screen, [this] { return !contains(picture(screen), " .. "); }));
  }
  [[nodiscard]] std::vector<std::uint8_t> bytes_of_unit(Address address, std::size_t bytes) {
    JobControl control;
    const auto read =
        unit->with_link(control, [&](UnitLink& link) { return link.client().read_memory(address, bytes); });
    REQUIRE(read);
    return *read;
  }
};

TEST_CASE("the unit's memory is shown page by page with the names of its contents") {
  MemoryCase one;
  give_map(*one.unit, one);
  REQUIRE(shows(one.screen, "[45]43 53 49"));
  REQUIRE(shows(one.screen, "ACTIVE map of"));
  CHECK(contains(picture(one.screen), "prefix.magic = ECSI"));
  CHECK(contains(picture(one.screen), "unit MCM-0107"));
  one.go("axis.X.deadband_um");
  CHECK(contains(picture(one.screen), "axis.X.deadband_um"));
  type(one.screen, "n");
  CHECK_FALSE(contains(picture(one.screen), "axis.X.deadband_um = "));
  one.go("table EYY");
  REQUIRE(shows(one.screen, "table EYY at -1400 mm = "));
  CHECK(contains(picture(one.screen), "um ("));
  one.go("EPROM");
  REQUIRE(shows(one.screen, "PROTECTED"));
  type(one.screen, "gaxis");
  (void)press(one.screen, Key::Name::escape);
  one.go("100000");
}

TEST_CASE("writing asks with old and new bytes, is read back, and is undone by undo") {
  MemoryCase one;
  REQUIRE(shows(one.screen, "unit MCM-0107"));
  one.go("48000");
  const auto before = one.bytes_of_unit(0x48000, 4);
  type(one.screen, "w");
  replace_line(one.screen, "DE AD BE EF");
  CHECK(contains(picture(one.screen), "Write 4 bytes of unit MCM-0107 (EMULATOR)?"));
  CHECK(contains(picture(one.screen), "now 00 00 00 00"));
  CHECK(contains(picture(one.screen), "new DE AD BE EF"));
  type(one.screen, "n");
  CHECK(one.bytes_of_unit(0x48000, 4) == before);
  type(one.screen, "w");
  replace_line(one.screen, "DE AD BE EF");
  type(one.screen, "y");
  REQUIRE(shows(one.screen, "4 bytes written at 0x048000, read back the same"));
  CHECK(one.bytes_of_unit(0x48000, 4) == std::vector<std::uint8_t>{0xDE, 0xAD, 0xBE, 0xEF});
  type(one.screen, "3");
  CHECK(contains(picture(one.screen), "00 00 00 00 > DE AD BE EF"));
  type(one.screen, "1u");
  CHECK(contains(picture(one.screen), "Write the old bytes back"));
  type(one.screen, "y");
  REQUIRE(shows(one.screen, "4 bytes written back at 0x048000"));
  CHECK(one.bytes_of_unit(0x48000, 4) == before);
  type(one.screen, "u");
  CHECK(contains(picture(one.screen), "nothing was written that could be taken back"));
}

TEST_CASE("bytes that changed since they were shown are not overwritten") {
  MemoryCase one;
  REQUIRE(shows(one.screen, "unit MCM-0107"));
  one.go("48000");
  type(one.screen, "w");
  replace_line(one.screen, "01");
  JobControl control;
  REQUIRE(one.unit->with_link(
      control, [](UnitLink& link) { return link.client().write_memory(0x48000, std::vector<std::uint8_t>{9}); }));
  type(one.screen, "y");
  REQUIRE(shows(one.screen, "nothing was written"));
  CHECK(one.bytes_of_unit(0x48000, 1) == std::vector<std::uint8_t>{9});
}

TEST_CASE("protected memory and a unit that does not integrate refuse writing with the reason") {
  MemoryCase one;
  give_map(*one.unit, one);
  REQUIRE(shows(one.screen, "ACTIVE map of"));
  one.go("0");
  type(one.screen, "w");
  CHECK(contains(picture(one.screen), "EPROM is protected"));
  CHECK_FALSE(one.screen.typing());
  one.go("commit");
  type(one.screen, "w");
  CHECK(contains(picture(one.screen), "commit records is protected"));
  one.go("100040");
  type(one.screen, "w");
  CHECK(contains(picture(one.screen), "axis memory bank A is protected"));
  CHECK_FALSE(one.screen.typing());
  one.go("48000");
  JobControl control;
  REQUIRE(one.unit->with_link(control, [](UnitLink& link) { return link.client().enter_compensation(); }));
  REQUIRE(until(one.screen, [&] { return one.unit->newest() && one.unit->newest()->mode != UnitMode::integration; }));
  type(one.screen, "w");
  CHECK(contains(picture(one.screen), "integration mode only"));
  CHECK_FALSE(one.screen.typing());
}

TEST_CASE("a dump is saved, opened, searched and compared with the unit") {
  MemoryCase one;
  give_map(*one.unit, one);
  REQUIRE(shows(one.screen, "ACTIVE map of"));
  const std::string file = (one.path / "before.ecsdump").string();
  type(one.screen, "S");
  CHECK(contains(picture(one.screen), "save the active map to"));
  (void)press(one.screen, Key::Name::escape);
  type(one.screen, "s");
  replace_line(one.screen, file);
  REQUIRE(shows(one.screen, "with the unit's status written to"));
  CHECK(read_dump(file).value().serial_number == "MCM-0107");
  type(one.screen, "s");
  replace_line(one.screen, file);
  CHECK(contains(picture(one.screen), "Overwrite "));
  type(one.screen, "n");

  one.go("48000");
  type(one.screen, "w");
  replace_line(one.screen, "16:777");
  type(one.screen, "y");
  REQUIRE(shows(one.screen, "2 bytes written"));
  type(one.screen, "c");
  replace_line(one.screen, file);
  REQUIRE(shows(one.screen, "compared with"));
  CHECK(contains(picture(one.screen), "1 place differs"));
  (void)press(one.screen, Key::Name::home);
  type(one.screen, "d");
  CHECK(contains(picture(one.screen), "0x048000"));
  (void)press(one.screen, Key::Name::left);
  CHECK(contains(picture(one.screen), "*"));
  type(one.screen, "2");
  CHECK(contains(picture(one.screen), "0x048000"));
  (void)press(one.screen, Key::Name::enter);

  type(one.screen, "o");
  replace_line(one.screen, file);
  REQUIRE(shows(one.screen, "file before.ecsdump, unit MCM-0107, taken 2"));
  one.go("100000");
  type(one.screen, "/");
  replace_line(one.screen, "\"ECSI\"");
  CHECK(contains(picture(one.screen), "found at 0x100000"));
  type(one.screen, "w");
  CHECK(contains(picture(one.screen), "this is a file"));
  type(one.screen, "m");
  CHECK(contains(picture(one.screen), "is not in axis memory bank A"));
  type(one.screen, "o");
  replace_line(one.screen, "");
  REQUIRE(shows(one.screen, "unit MCM-0107"));
}

TEST_CASE("a search reads through the unit until it finds, and can be cancelled") {
  MemoryCase one;
  REQUIRE(shows(one.screen, "unit MCM-0107"));
  JobControl control;
  REQUIRE(one.unit->with_link(control, [](UnitLink& link) {
    return link.client().write_memory(0x4A123, std::vector<std::uint8_t>{0xCA, 0xFE});
  }));
  one.go("40000");
  type(one.screen, "/");
  replace_line(one.screen, "CA FE");
  REQUIRE(shows(one.screen, "found at 0x04A123"));
  one.go("100000");
  type(one.screen, "/");
  replace_line(one.screen, "CA FE 01");
  REQUIRE(shows(one.screen, "looking for CA FE 01"));
  (void)press(one.screen, Key::Name::escape);
  CHECK(contains(picture(one.screen), "given up: looking for CA FE 01"));
  type(one.screen, "a");
  REQUIRE(shows(one.screen, "reading axis memory bank A"));
  (void)press(one.screen, Key::Name::escape);
  CHECK(contains(picture(one.screen), "given up: reading axis memory bank A"));
}

TEST_CASE("the screen reports a killed emulator, and reads again when it is back") {
  MemoryCase one;
  REQUIRE(shows(one.screen, "unit MCM-0107"));
  one.go("48000");
  REQUIRE(kill_emulators() == 1);
  REQUIRE(shows(one.screen, "opened again"));
  REQUIRE(until(one.screen, [&] { return !contains(picture(one.screen), " .. "); }));
}

TEST_CASE("a write while the unit dies either is confirmed or is in the list as not confirmed") {
  MemoryCase one;
  REQUIRE(shows(one.screen, "unit MCM-0107"));
  one.go("48000");
  type(one.screen, "w");
  replace_line(one.screen, "01 02");
  REQUIRE(kill_emulators() == 1);
  type(one.screen, "y");
  type(one.screen, "3");
  REQUIRE(shows(one.screen, "00 00 > 01 02"));
  const bool confirmed = !contains(picture(one.screen), "NOT CONFIRMED");
  REQUIRE(until(one.screen, [&] { return one.unit->newest().has_value(); }));
  CHECK(one.bytes_of_unit(0x48000, 2) ==
        (confirmed ? std::vector<std::uint8_t>{1, 2} : std::vector<std::uint8_t>{0, 0}));
  type(one.screen, "1u");
  type(one.screen, "y");
  REQUIRE(shows(one.screen, confirmed ? "written back at" : "nothing was written"));
  CHECK(one.bytes_of_unit(0x48000, 2) == std::vector<std::uint8_t>{0, 0});
}

TEST_CASE("without a unit the screen says what is missing and opens a file all the same") {
  const StateFolder one;
  MemoryScreen screen(std::make_shared<UnitConnection>("rtu:/dev/no-such-port:9600"));
  REQUIRE(shows(screen, "no such port"));
  CHECK(contains(picture(screen), "as soon as a unit answers"));
  for (const char* key : {"w", "u", "r", "a", "d", "m", "n", "p", "2", "3", "1"}) type(screen, key);
  type(screen, "o");
  replace_line(screen, "no-such.ecsdump");
  REQUIRE(shows(screen, "no-such.ecsdump"));
  for (const auto& [rows, columns] : {std::pair{24, 80}, {40, 120}, {12, 40}, {5, 20}, {1, 1}}) {
    const std::string text = picture(screen, rows, columns, Glyphs::ascii);
    CHECK(std::count(text.begin(), text.end(), '\n') == rows);
  }
}

}  // namespace
}  // namespace ecs::app
