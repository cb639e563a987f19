// Measured lengths and plans of them (tests/fuzz/import_fuzz.cpp says how).
#include "modules/lengths/length_test.hpp"
#include "tests/fuzz/parsers.hpp"

namespace ecs::fuzz {

/// What was read is finite and, written, is as many lengths again or refused. Every other file is a plan.
const AddedReader kLengths{[](std::string_view id, std::uint8_t choice, std::string_view bytes) {
  if (id != "lengths") return false;
  const bool plan = (choice & 1u) != 0;
  const auto read = model::parse_lengths(bytes, "lengths.csv", plan);
  if (!was_read(read)) return true;
  for (const model::LengthReading& reading : read->readings) {
    check(reading.set_up < read->set_ups.size() && reading.tool < read->tools.size());
    all_finite(reading.position_mm);
    check_finite(reading.deviation_um);
    check_finite(model::point_of(*read, reading)[0]);
  }
  const auto again = model::parse_lengths(model::to_csv(*read, plan), "again.csv", plan);
  check(!again || again->readings.size() == read->readings.size());
  return true;
}};

}  // namespace ecs::fuzz
