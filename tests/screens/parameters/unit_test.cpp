// The parameters screen with the real emulator at the far end of the line: receiving, sending, a lost line.
#include <csignal>
#include <cstdlib>
#include <fstream>

#include <fcntl.h>
#include <unistd.h>

#include "app/verbs/registry.hpp"
#include "base/file.hpp"
#include "commissioning/link/emulator_process.hpp"
#include "tests/screens/support/parameters_screen.hpp"
#include "tests/support/emulator.hpp"

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
  const auto held = line.with_link(control, [](UnitLink& unit) { return receive_parameters(unit.client()); });
  REQUIRE(held);
  return *held;
}

TEST_CASE("what is sent is asked first, read back without a difference, and received again the same") {
  const ParametersCase one;
  auto line = std::make_shared<UnitConnection>("emulator");
  ParametersScreen screen(line);
  CHECK(shows(screen, "EMULATOR, unit MCM-0107 answers"));
  type(screen, "r");
  CHECK(shows(screen, "it holds no parameters yet"));
  open_file(screen, one);
  find(screen, "deadband");
  edit(screen, "7.5");
  type(screen, "t");
  REQUIRE(shows(screen, "Send the parameters to EMULATOR, unit MCM-0107?"));
  CHECK(reads(picture(screen), "Nothing is overwritten"));
  type(screen, "y");
  REQUIRE(shows(screen, "read back: no difference"));
  CHECK(screen.controller().differs_from_unit().empty());
  CHECK(screen.unsaved().empty());
  CHECK_FALSE(draft_of("parameters"));

  edit(screen, "9");
  CHECK(reads(picture(screen), "unit 7.5"));
  type(screen, "t");
  REQUIRE(shows(screen, "Overwritten there: 1 parameter"));
  CHECK(reads(picture(screen), "X deadband: 7.5 > 9 um"));
  type(screen, "n");
  CHECK(held_by(*line).axes[0].deadband_um == 7.5);

  ParametersScreen another(line);
  CHECK(shows(another, "Unsaved work of"));
  type(another, "dy");
  type(another, "r");
  REQUIRE(shows(another, "received from EMULATOR"));
  CHECK(another.controller().set().parameters.axes[0].deadband_um == 7.5);
  CHECK(another.controller().set().identity.serial_number == "MCM-0107");
  CHECK(another.unsaved().empty());
}

TEST_CASE("g takes the unit's value; receiving over edits asks first and can be undone") {
  const ParametersCase one;
  REQUIRE(ran({"params", "send", one.file()}).code == 0);
  ParametersScreen screen(std::make_shared<UnitConnection>("emulator"));
  open_file(screen, one);
  REQUIRE(shows(screen, "the unit holds the same"));
  find(screen, "deadband");
  edit(screen, "7.5");
  type(screen, "5");
  CHECK(reads(picture(screen), "X deadband"));
  type(screen, "g");
  CHECK(screen.controller().set().parameters.axes[0].deadband_um == 4.0);
  CHECK(reads(picture(screen), "Screen, file and unit hold the same."));
  type(screen, "u");
  type(screen, "r");
  CHECK(reads(picture(screen), "go on, keep the draft"));
  type(screen, "y");
  REQUIRE(shows(screen, "received from EMULATOR"));
  CHECK(screen.controller().set().parameters.axes[0].deadband_um == 4.0);
  type(screen, "u");
  CHECK(screen.controller().set().parameters.axes[0].deadband_um == 7.5);
}

TEST_CASE("a unit that is not in integration mode is switched only after a yes") {
  const ParametersCase one;
  REQUIRE(ran({"params", "send", one.file()}).code == 0);
  REQUIRE(write_file(one.file("map.csv"),
                     "# machine: moving column mill\n# configuration: "
                     "TXYZ\naxis,sense,approach,p_mm,value_um\nX,EX,0,-4100,1\nX,EX,0,0,5\nY,EY,0,-1400,1\n"
                     "Y,EY,0,0,2\nZ,EZ,0,-1000,1\nZ,EZ,0,0,3\n"));
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
  find(screen, "deadband");
  edit(screen, "7.5");
  type(screen, "t");
  REQUIRE(shows(screen, "Switch EMULATOR, unit MCM-0107 to integration mode?"));
  type(screen, "n");
  CHECK(mode() == UnitMode::datuming);
  type(screen, "t");
  REQUIRE(shows(screen, "to integration mode?"));
  type(screen, "y");
  REQUIRE(shows(screen, "Send the parameters to EMULATOR"));
  CHECK(mode() == UnitMode::integration);
  type(screen, "y");
  REQUIRE(shows(screen, "its map fits and stays"));
}

TEST_CASE("a map that does not fit what is sent is dropped only after a yes") {
  const ParametersCase one;
  REQUIRE(write_file(one.file("map.csv"),
                     "# machine: moving column mill\n# configuration: "
                     "TXYZ\naxis,sense,approach,p_mm,value_um\nX,EX,0,-4100,1\nX,EX,0,0,5\nY,EY,0,-1400,1\n"
                     "Y,EY,0,0,2\nZ,EZ,0,-1000,1\nZ,EZ,0,0,3\n"));
  REQUIRE(ran({"map", "send", one.file("map.csv"), "--params", one.file()}).code == 0);
  auto line = std::make_shared<UnitConnection>("emulator");
  ParametersScreen screen(line);
  open_file(screen, one);
  find(screen, "compensation.scope");
  type(screen, "  ");  // volumetric: the map lacks the other components
  type(screen, "t");
  REQUIRE(shows(screen, "Send the parameters to EMULATOR"));
  type(screen, "y");
  REQUIRE(shows(screen, "Send them without the map?"));
  type(screen, "n");
  CHECK_FALSE(screen.unsaved().empty());
  type(screen, "t");
  REQUIRE(shows(screen, "Send the parameters to EMULATOR"));
  type(screen, "y");
  REQUIRE(shows(screen, "Send them without the map?"));
  type(screen, "y");
  REQUIRE(shows(screen, "it has no map now"));
  CHECK(screen.unsaved().empty());
}

TEST_CASE("parameters of another unit are said to be so before they are sent") {
  const ParametersCase one;
  ParametersScreen screen(std::make_shared<UnitConnection>("emulator"));
  open_file(screen, one);
  find(screen, "serial_number");
  edit(screen, "CH-0005");
  type(screen, "t");
  REQUIRE(shows(screen, "ANOTHER UNIT"));
  CHECK(reads(picture(screen), "CH-0005"));
  type(screen, "y");
  REQUIRE(shows(screen, "read back: no difference"));
}

TEST_CASE("a unit that dies keeps every edit here, and takes them when it is back") {
  const ParametersCase one;
  auto line = std::make_shared<UnitConnection>("emulator");
  ParametersScreen screen(line);
  open_file(screen, one);
  REQUIRE(shows(screen, "the unit holds no parameters"));
  find(screen, "deadband");
  edit(screen, "7.5");
  REQUIRE(kill_emulators() == 1);
  type(screen, "t");
  REQUIRE(shows(screen, "Nothing was changed here"));
  CHECK(screen.controller().set().parameters.axes[0].deadband_um == 7.5);
  CHECK(draft_of("parameters"));
  CHECK_FALSE(screen.unsaved().empty());
  REQUIRE(opens_again(*line));
  type(screen, "t");
  REQUIRE(shows(screen, "Send the parameters to EMULATOR"));
  type(screen, "y");
  REQUIRE(shows(screen, "read back: no difference"));
}

TEST_CASE("a link without answers never blocks the keys, and Esc cancels the exchange") {
  const ParametersCase one;
  const int master = ::posix_openpt(O_RDWR | O_NOCTTY);
  REQUIRE(master >= 0);
  REQUIRE(::grantpt(master) == 0);
  REQUIRE(::unlockpt(master) == 0);
  ParametersScreen screen(std::make_shared<UnitConnection>(std::string("rtu:") + ::ptsname(master) + ":115200"));
  open_file(screen, one);
  find(screen, "deadband");
  edit(screen, "7.5");
  type(screen, "t");
  CHECK(reads(picture(screen), "Esc cancels"));
  type(screen, "d");
  CHECK(reads(picture(screen), "7.5 um"));  // what is being sent is not edited meanwhile
  (void)press(screen, Key::Name::up);
  (void)press(screen, Key::Name::escape);
  REQUIRE(shows(screen, "Nothing was changed here"));
  CHECK(screen.controller().set().parameters.axes[0].deadband_um == 7.5);
  ::close(master);
}

TEST_CASE("warnings are part of the question before parameters are sent") {
  const ParametersCase one;
  ParametersScreen screen(std::make_shared<UnitConnection>("emulator"));
  open_file(screen, one);
  find(screen, "X.output_limit");
  edit(screen, "0");
  type(screen, "t");
  REQUIRE(shows(screen, "1 warning:"));
  CHECK(reads(picture(screen), "lets no"));
}

}  // namespace
}  // namespace ecs::app
