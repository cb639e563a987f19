// Which machine a file was measured on.
#include "laser/measured_machine.hpp"

#include <doctest/doctest.h>

namespace ecs::laser {
namespace {

TEST_CASE("machine and serial number are found in our header and in an instrument's own") {
  CHECK(measured_machine({{"machine", "mill"}, {"serial_number", "7"}}).serial_number == "7");
  const MeasuredMachine instrument = measured_machine({{"Owner", "x"}, {"Machine", "VMC 7"}, {"Serial No", "1234"}});
  CHECK(instrument.name == "VMC 7");
  CHECK(instrument.serial_number == "1234");
  CHECK(measured_machine({}).name.empty());
}

TEST_CASE("another machine is one whose name or serial number contradicts; what is not said contradicts nothing") {
  CHECK(other_machine({"mill", ""}, {"lathe", ""}, "the machine file is of") ==
        "measured on \"mill\", the machine file is of \"lathe\"");
  CHECK(other_machine({"mill", "1"}, {"mill", "2"}, "the parameters are of") ==
        "measured on serial number 1, the parameters are of serial number 2");
  CHECK_FALSE(other_machine({"mill", ""}, {"", "2"}, "x").has_value());
  CHECK_FALSE(other_machine({"mill", "1"}, {"mill", "1"}, "x").has_value());
}

}  // namespace
}  // namespace ecs::laser
