// The file of the measuring instrument, read and written.
#include "modules/logbook/instrument.hpp"

#include <doctest/doctest.h>

namespace ecs::commissioning {
namespace {

TEST_CASE("an instrument with any characters in its words is written and read again as the same") {
  for (const char* word : {"\n", "a\nb", "\t", "'", "\"", "\\", "\x01", "\xC2\xB5m", "'''\n\"\"\""}) {
    CAPTURE(word);
    Instrument instrument;
    instrument.name = word;
    instrument.serial_number = word;
    instrument.calibration_interval_days = 365;
    const auto again = parse_instrument(to_toml(instrument), "instrument.toml");
    REQUIRE(again);
    CHECK(*again == instrument);
  }
}

}  // namespace
}  // namespace ecs::commissioning
