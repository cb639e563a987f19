// The parameters screen with the real emulator at the far end of the line: receiving, sending, a lost line.
#include <cstdlib>

#include <fcntl.h>
#include <unistd.h>

#include "commissioning/link/not_armed.hpp"
#include "core/memory_image.hpp"
#include "tests/screens/support/parameters_screen.hpp"
#include "tests/screens/support/unit_screen.hpp"

namespace ecs::app {
namespace {

using namespace screen_test;

/// Until the line is open again; half a minute at most.
bool opens_again(const UnitConnection& line) {
  for (int k = 0; k < 3000 && !line.newest(); ++k) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  return line.newest().has_value();
}

UnitParameters held_by(UnitConnection& line) {
  JobControl control;
  return must(line.with_link(control, [](UnitLink& unit) { return receive_parameters(unit.client()); }));
}

TEST_CASE("what is sent is asked first, read back without a difference, and received again the same") {
  const ParametersCase one;
  auto line = std::make_shared<UnitConnection>("emulator");
  ParametersScreen screen(line);
  CHECK(shows(screen, "EMULATOR, unit MCM-0107 answers"));
  CHECK(shows_after(screen, "r", "it contains no parameters yet"));
  open_file(screen, one);
  edit(screen, "deadband", "7.5");
  REQUIRE(shows_after(screen, "t", "Send the parameters to EMULATOR, unit MCM-0107?"));
  CHECK(reads(picture(screen), "No parameters will be overwritten"));
  REQUIRE(shows_after(screen, "y", "read back: no difference"));
  CHECK(screen.controller().differs_from_unit().empty());
  CHECK(screen.unsaved().empty());
  CHECK_FALSE(draft_of("parameters"));

  edit(screen, "9");
  CHECK(reads(picture(screen), "unit 7.5"));
  REQUIRE(shows_after(screen, "t", "1 parameter will be overwritten"));
  CHECK(reads(picture(screen), "X deadband: 7.5 -> 9 um"));
  type(screen, "n");
  CHECK(held_by(*line).axes[0].deadband_um == 7.5);

  ParametersScreen another(line);
  CHECK(shows(another, "Unsaved work of"));
  REQUIRE(shows_after(another, "dyr", "received from EMULATOR"));
  CHECK(another.controller().set().parameters.axes[0].deadband_um == 7.5);
  CHECK(another.controller().set().identity.serial_number == "MCM-0107");
  CHECK(another.unsaved().empty());
}

TEST_CASE("received parameters have the machine that the unit names, unless its name may be cut") {
  const StateFolder folder;
  for (const std::string& name : {std::string("small mill"), std::string(kMostMachineBytes, 'm')}) {
    UnitContent unit{.name = "a unit", .parameters = UnitParameters{}};
    unit.identity.machine = name;
    ParametersController controller;
    CHECK(controller.take_from_unit(unit));
    CHECK(controller.set().identity.machine == (name.size() < kMostMachineBytes ? name : ""));
  }
}

TEST_CASE("a refusal because no code was typed is told without options of a verb") {
  const std::string reason(protocol::text_of(protocol::UnitError::not_armed));
  CHECK(is_not_armed({ProblemKind::refused, "the unit refuses \"start a transfer\": " + reason, "", 0, 0, {}}));
  CHECK_FALSE(is_not_armed({ProblemKind::refused, "the unit is busy", "", 0, 0, {}}));
}

TEST_CASE("g takes the unit's value; receiving over edits asks first and can be undone") {
  const ParametersCase one;
  REQUIRE(ran({"params", "send", one.file()}).code == 0);
  ParametersScreen screen(std::make_shared<UnitConnection>("emulator"));
  open_file(screen, one);
  REQUIRE(shows(screen, "the unit has the same"));
  edit(screen, "deadband", "7.5");
  CHECK(reads(after(screen, "5"), "X deadband"));
  type(screen, "g");
  CHECK(screen.controller().set().parameters.axes[0].deadband_um == 4.0);
  CHECK(reads(picture(screen), "Screen, file and unit agree."));
  CHECK(reads(after(screen, "ur"), "continue, keep the draft"));
  REQUIRE(shows_after(screen, "y", "received from EMULATOR"));
  CHECK(screen.controller().set().parameters.axes[0].deadband_um == 4.0);
  type(screen, "u");
  CHECK(screen.controller().set().parameters.axes[0].deadband_um == 7.5);
}

TEST_CASE("a unit that is not in integration mode is switched only after a yes") {
  const ParametersCase one;
  REQUIRE(ran({"params", "send", one.file()}).code == 0);
  (void)one.with("map.csv", kLinearMap);
  REQUIRE(ran({"map", "send", one.file("map.csv"), "--params", one.file()}).code == 0);
  auto line = std::make_shared<UnitConnection>("emulator");
  JobControl control;
  const auto mode = [&] {
    return line->with_link(control, [](UnitLink& unit) { return unit.client().status(); }).value().mode;
  };
  REQUIRE(line->with_link(control, [](UnitLink& unit) { return unit.client().enter_compensation(); }));
  REQUIRE(mode() == UnitMode::datuming);
  ParametersScreen screen(line);
  open_file(screen, one);
  edit(screen, "deadband", "7.5");
  REQUIRE(shows_after(screen, "t", "Switch EMULATOR, unit MCM-0107 to integration mode?"));
  type(screen, "n");
  CHECK(mode() == UnitMode::datuming);
  REQUIRE(shows_after(screen, "t", "to integration mode?"));
  REQUIRE(shows_after(screen, "y", "Send the parameters to EMULATOR"));
  CHECK(mode() == UnitMode::integration);
  REQUIRE(shows_after(screen, "y", "its map fits and is kept"));
}

TEST_CASE("a map that does not fit what is sent is dropped only after a yes") {
  const ParametersCase one;
  (void)one.with("map.csv", kLinearMap);
  REQUIRE(ran({"map", "send", one.file("map.csv"), "--params", one.file()}).code == 0);
  auto line = std::make_shared<UnitConnection>("emulator");
  ParametersScreen screen(line);
  open_file(screen, one);
  find(screen, "compensation.scope");
  type(screen, "  ");  // volumetric: the map lacks the other components
  REQUIRE(shows_after(screen, "t", "Send the parameters to EMULATOR"));
  REQUIRE(shows_after(screen, "y", "Send them without the map?"));
  type(screen, "n");
  CHECK_FALSE(screen.unsaved().empty());
  REQUIRE(shows_after(screen, "t", "Send the parameters to EMULATOR"));
  REQUIRE(shows_after(screen, "y", "Send them without the map?"));
  REQUIRE(shows_after(screen, "y", "it now has no map"));
  CHECK(screen.unsaved().empty());
}

TEST_CASE("parameters of another unit are said to be so before they are sent") {
  const ParametersCase one;
  ParametersScreen screen(std::make_shared<UnitConnection>("emulator"));
  open_file(screen, one);
  edit(screen, "serial_number", "CH-0005");
  REQUIRE(shows_after(screen, "t", "ANOTHER UNIT"));
  CHECK(reads(picture(screen), "CH-0005"));
  REQUIRE(shows_after(screen, "y", "read back: no difference"));
}

TEST_CASE("a unit that dies keeps every edit here, and takes them when it is back") {
  const ParametersCase one;
  auto line = std::make_shared<UnitConnection>("emulator");
  ParametersScreen screen(line);
  open_file(screen, one);
  REQUIRE(shows(screen, "the unit has no parameters"));
  edit(screen, "deadband", "7.5");
  REQUIRE(kill_emulators() == 1);
  REQUIRE(shows_after(screen, "t", "The parameters here are unchanged"));
  CHECK(screen.controller().set().parameters.axes[0].deadband_um == 7.5);
  CHECK(draft_of("parameters"));
  CHECK_FALSE(screen.unsaved().empty());
  REQUIRE(opens_again(*line));
  REQUIRE(shows_after(screen, "t", "Send the parameters to EMULATOR"));
  REQUIRE(shows_after(screen, "y", "read back: no difference"));
}

TEST_CASE("a link without answers never blocks the keys, and Esc cancels the exchange") {
  const ParametersCase one;
  const int master = ::posix_openpt(O_RDWR | O_NOCTTY);
  REQUIRE(master >= 0);
  REQUIRE(::grantpt(master) == 0);
  REQUIRE(::unlockpt(master) == 0);
  ParametersScreen screen(std::make_shared<UnitConnection>(std::string("rtu:") + ::ptsname(master) + ":115200"));
  open_file(screen, one);
  edit(screen, "deadband", "7.5");
  CHECK(reads(after(screen, "t"), "Esc cancels"));
  type(screen, "d");
  CHECK(reads(picture(screen), "7.5 um"));  // what is being sent is not edited meanwhile
  (void)press(screen, Key::Name::up);
  (void)press(screen, Key::Name::escape);
  REQUIRE(shows(screen, "The parameters here are unchanged"));
  CHECK(screen.controller().set().parameters.axes[0].deadband_um == 7.5);
  ::close(master);
}

TEST_CASE("warnings are part of the question before parameters are sent") {
  const ParametersCase one;
  ParametersScreen screen(std::make_shared<UnitConnection>("emulator"));
  open_file(screen, one);
  edit(screen, "X.output_limit", "0");
  REQUIRE(shows_after(screen, "t", "1 warning:"));
  CHECK(reads(picture(screen), "disables the compensation"));
}

}  // namespace
}  // namespace ecs::app
