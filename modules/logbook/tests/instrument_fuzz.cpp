// The files of measuring instruments (text_fuzz.cpp says how).
#include "modules/logbook/place.hpp"
#include "tests/fuzz/parsers.hpp"

namespace ecs::fuzz {

const AddedParsers kInstrument("instrument", [](std::string_view text) {
  const auto read = commissioning::parse_instrument(text, kFile);
  if (!was_read(read)) return;
  const auto again = commissioning::parse_instrument(commissioning::to_toml(*read), kFile);
  check(again && *again == *read);
  static_cast<void>(commissioning::calibrated_on(*read, "2026-01-31"));
});

}  // namespace ecs::fuzz
