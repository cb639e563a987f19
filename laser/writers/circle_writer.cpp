#include "laser/writers/circle_writer.hpp"

#include <cctype>

#include <fmt/format.h>

#include "base/text.hpp"

namespace ecs::laser {
namespace {

std::string metadata_line(std::string_view key, std::string_view value) {
  return fmt::format("# {}: {}\n", key, value);
}

}  // namespace

std::string to_csv(const CircleTest& test) {
  std::string own = metadata_line("plane", plane_name(test.plane));
  own += metadata_line("radius_mm", shortest(test.radius_mm));
  if (test.feed_mm_min) own += metadata_line("feed_mm_min", shortest(*test.feed_mm_min));
  if (test.start_angle_deg) own += metadata_line("start_angle_deg", shortest(*test.start_angle_deg));
  for (std::size_t i = 0; i < test.plane.size(); ++i)
    if (test.centre_mm[i])
      own += metadata_line(fmt::format("centre_{}_mm", static_cast<char>(std::tolower(letter_of(test.plane[i])))),
                           shortest(*test.centre_mm[i]));
  std::string text;
  for (const MetadataEntry& entry : test.metadata)
    if (const std::string line = metadata_line(entry.key, entry.value);
        own.find(fmt::format("# {}: ", entry.key)) == own.npos)
      text += line;
  text += own + "angle_deg,deviation_um,direction,run\n";
  for (const CircleReading& reading : test.readings)
    text += fmt::format("{:.4f},{:.4f},{},{}\n", reading.angle_deg, reading.deviation_um,
                        contouring_name(reading.clockwise), reading.run);
  return text;
}

}  // namespace ecs::laser
