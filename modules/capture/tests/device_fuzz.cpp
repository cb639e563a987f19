// Descriptions of devices (tests/fuzz/text_fuzz.cpp says how).
#include <array>
#include <cstdint>

#include "modules/capture/description.hpp"
#include "tests/fuzz/parsers.hpp"

namespace ecs::fuzz {

const AddedParsers kCapture("device", [](std::string_view text) {
  const auto read = devices::parse_device(text, kFile);
  if (!was_read(read)) return;
  for (const devices::ReportField& field : read->fields) all_finite(std::array{field.scale, field.offset});
  const std::string written = devices::to_toml(*read);
  const auto again = devices::parse_device(written, kFile);
  check(again && devices::to_toml(*again) == written);
  const devices::Bytes report(read->report.bytes == 0 ? 8 : read->report.bytes, std::uint8_t{0x81});
  for (const auto& [quantity, value] : devices::values_in(*read, {report})) check_finite(value);
  static_cast<void>(devices::held_in(*read, report));
});

}  // namespace ecs::fuzz
