// Memory access with the emulator's memory, and with dumps of it.
#include "app/screens/memory/screen.hpp"

#include "tests/screens/support/unit_screen.hpp"

namespace ecs::app {
namespace {

using namespace screen_test;

struct MemoryCase : StateFolder {
  std::shared_ptr<UnitConnection> unit = std::make_shared<UnitConnection>("emulator");
  MemoryScreen screen{unit};

  MemoryCase() = default;
  explicit MemoryCase(const std::string& where) {
    REQUIRE(shows(screen, "unit MCM-0107"));
    go(where);
  }
  /// Goes there and waits until the bytes are read.
  void go(const std::string& where) {
    REQUIRE(until(screen, [&] {  // names are there when they are read
      type(screen, "g");
      replace_line(screen, where);
      return !contains(picture(screen), "no such address or name");
    }));
    REQUIRE(until(screen, [this] { return !contains(picture(screen), " .. "); }));
  }
  [[nodiscard]] std::vector<std::uint8_t> bytes_of_unit(Address address, std::size_t bytes) {
    JobControl control;
    return must(unit->with_link(control, [&](UnitLink& link) { return link.client().read_memory(address, bytes); }));
  }
};

TEST_CASE("the unit's memory is shown page by page with the names of its contents") {
  MemoryCase one;
  give_map(*one.unit, one);
  REQUIRE(shows(one.screen, "[45]43 53 49"));
  REQUIRE(shows(one.screen, "ACTIVE: "));
  check_holds(picture(one.screen), {"prefix.magic = ECSI", "unit MCM-0107"});
  one.go("axis.X.deadband_um");
  CHECK(contains(picture(one.screen), "axis.X.deadband_um"));
  CHECK_FALSE(contains(after(one.screen, "n"), "axis.X.deadband_um = "));
  one.go("table EYY");
  REQUIRE(shows(one.screen, "table EYY at -1400 mm = "));
  CHECK(contains(picture(one.screen), "um ("));
  one.go("EPROM");
  REQUIRE(shows(one.screen, "PROTECTED"));
  type(one.screen, "gzzz\n");  // stays open
  CHECK(one.screen.typing());
  CHECK(contains(picture(one.screen), "no such address or name: \"zzz\""));
  replace_line(one.screen, "axis.X.deadband_um");
  CHECK_FALSE(one.screen.typing());
  one.go("100000");
}

TEST_CASE("the screen opens at the active bank, whichever of the two that is") {
  MemoryCase one;
  give_map(*one.unit, one);
  REQUIRE(ran_on(*one.unit, {"params", "send",
                             one.with("q.toml",
                                      "[compensation]\nscope = \"linear\"\n"
                                      "loop_period_us = 1500\n[axis.Y.datum]\n"
                                      "approach_direction = \"reverse\"\n[axis.X]\n"
                                      "transducer = \"encoder\"\n[axis.Z]\n"
                                      "transducer = \"encoder\"\n# end of parameters\n")}) == 0);
  MemoryScreen later{one.unit};
  REQUIRE(shows(later, "ACTIVE: "));
  CHECK(contains(picture(later), "0x200000"));
}

TEST_CASE("writing asks with old and new bytes, is read back, and is undone by undo") {
  MemoryCase one("48000");
  const auto before = one.bytes_of_unit(0x48000, 4);
  type(one.screen, "w");
  replace_line(one.screen, "DE AD BE EF");
  check_holds(picture(one.screen),
              {"Write 4 bytes of unit MCM-0107 (EMULATOR)?", "now 00 00 00 00", "new DE AD BE EF"});
  type(one.screen, "n");
  CHECK(one.bytes_of_unit(0x48000, 4) == before);
  type(one.screen, "w");
  replace_line(one.screen, "DE AD BE EF");
  REQUIRE(shows_after(one.screen, "y", "4 bytes written at 0x048000, read back the same"));
  CHECK(one.bytes_of_unit(0x48000, 4) == std::vector<std::uint8_t>{0xDE, 0xAD, 0xBE, 0xEF});
  CHECK(contains(after(one.screen, "3"), "00 00 00 00 -> DE AD BE EF"));
  CHECK(contains(after(one.screen, "1u"), "Write the old bytes back"));
  REQUIRE(shows_after(one.screen, "y", "4 bytes written back at 0x048000"));
  CHECK(one.bytes_of_unit(0x48000, 4) == before);
  CHECK(contains(after(one.screen, "u"), "no write to undo"));
}

TEST_CASE("bytes that changed since they were shown are not overwritten") {
  MemoryCase one("48000");
  type(one.screen, "w");
  replace_line(one.screen, "01");
  JobControl control;
  REQUIRE(one.unit->with_link(
      control, [](UnitLink& link) { return link.client().write_memory(0x48000, std::vector<std::uint8_t>{9}); }));
  REQUIRE(shows_after(one.screen, "y", "not written"));
  CHECK(one.bytes_of_unit(0x48000, 1) == std::vector<std::uint8_t>{9});
}

TEST_CASE("protected memory and a unit that does not integrate refuse writing with the reason") {
  MemoryCase one;
  give_map(*one.unit, one);
  REQUIRE(shows(one.screen, "ACTIVE: "));
  one.go("0");
  CHECK(contains(after(one.screen, "w"), "EPROM is protected"));
  CHECK_FALSE(one.screen.typing());
  one.go("commit");
  CHECK(contains(after(one.screen, "w"), "commit records is protected"));
  one.go("100040");
  CHECK(contains(after(one.screen, "w"), "axis memory bank A is protected"));
  CHECK_FALSE(one.screen.typing());
  one.go("48000");
  JobControl control;
  REQUIRE(one.unit->with_link(control, [](UnitLink& link) { return link.client().enter_compensation(); }));
  REQUIRE(until(one.screen, [&] { return one.unit->newest() && one.unit->newest()->mode != UnitMode::integration; }));
  CHECK(contains(after(one.screen, "w"), "integration mode only"));
  CHECK_FALSE(one.screen.typing());
}

TEST_CASE("a dump is saved, opened, searched and compared with the unit") {
  MemoryCase one;
  give_map(*one.unit, one);
  REQUIRE(shows(one.screen, "ACTIVE: "));
  const std::string file = (one.path / "before.ecsdump").string();
  CHECK(contains(after(one.screen, "S"), "save the active map to"));
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
  REQUIRE(shows_after(one.screen, "y", "2 bytes written"));
  type(one.screen, "c");
  replace_line(one.screen, file);
  REQUIRE(shows(one.screen, "compared with"));
  INFO(picture(one.screen));
  CHECK(contains(picture(one.screen), "1 place differs"));
  (void)press(one.screen, Key::Name::home);
  CHECK(contains(after(one.screen, "d"), "0x048000"));
  (void)press(one.screen, Key::Name::left);
  CHECK(contains(picture(one.screen), "*"));
  CHECK(contains(after(one.screen, "2"), "0x048000"));
  (void)press(one.screen, Key::Name::enter);

  type(one.screen, "o");
  replace_line(one.screen, file);
  REQUIRE(shows(one.screen, "file before.ecsdump, unit MCM-0107, taken 2"));
  one.go("100000");
  type(one.screen, "/");
  replace_line(one.screen, "\"ECSI\"");
  CHECK(contains(picture(one.screen), "found at 0x100000"));
  CHECK(contains(after(one.screen, "w"), "this is a file"));
  CHECK(contains(after(one.screen, "m"), "is not in axis memory bank A"));
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
  CHECK(contains(picture(one.screen), "cancelled: looking for CA FE 01"));
  REQUIRE(shows_after(one.screen, "a", "reading axis memory bank A"));
  (void)press(one.screen, Key::Name::escape);
  CHECK(contains(picture(one.screen), "cancelled: reading axis memory bank A"));
}

TEST_CASE("the screen reports a killed emulator, and reads again when it is back") {
  MemoryCase one("48000");
  REQUIRE(kill_emulators() == 1);
  REQUIRE(shows(one.screen, "reopened"));
  REQUIRE(until(one.screen, [&] { return !contains(picture(one.screen), " .. "); }));
}

TEST_CASE("a write while the unit dies either is confirmed or is in the list as not confirmed") {
  MemoryCase one("48000");
  type(one.screen, "w");
  replace_line(one.screen, "01 02");
  REQUIRE(kill_emulators() == 1);
  REQUIRE(shows_after(one.screen, "y3", "00 00 -> 01 02"));
  const bool confirmed = !contains(picture(one.screen), "NOT CONFIRMED");
  REQUIRE(until(one.screen, [&] { return one.unit->newest().has_value(); }));
  CHECK(one.bytes_of_unit(0x48000, 2) ==
        (confirmed ? std::vector<std::uint8_t>{1, 2} : std::vector<std::uint8_t>{0, 0}));
  REQUIRE(shows_after(one.screen, "1uy", confirmed ? "written back at" : "not written"));
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
  check_fits(screen);
}

}  // namespace
}  // namespace ecs::app
