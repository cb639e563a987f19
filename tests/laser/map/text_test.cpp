// Maps as editors save them: UTF-16, code pages, a byte order mark; and what is no text.
#include <doctest/doctest.h>

#include "laser/map/csv.hpp"

namespace ecs::laser {
namespace {

const std::string kMap =
    "# machine: Fraese\n# rows: 2\naxis,sense,approach,p_mm,value_um\r\nX,EX,0,0,0\r\nX,EX,0,100,-3.5\r\n";

std::string utf16(const std::string& text, bool big, bool mark) {
  std::string out = !mark ? "" : big ? "\xFE\xFF" : "\xFF\xFE";
  for (const char c : text) out += big ? std::string{'\0', c} : std::string{c, '\0'};
  return out;
}

TEST_CASE("a map saved as UTF-16 is read as the same map") {
  const auto plain = parse_map_csv(kMap, "map.csv");
  REQUIRE(plain);
  for (const bool big : {false, true})
    for (const bool mark : {false, true}) {
      const auto read = parse_map_csv(utf16(kMap, big, mark), "map.csv");
      REQUIRE_MESSAGE(read, to_text(read.error()));
      CHECK(*read == *plain);
    }
}

TEST_CASE("a machine's name in Windows-1252 is the name in UTF-8, so that it equals that of the parameters") {
  const auto read = parse_map_csv("# machine: Fr\xE4se 2\naxis,sense,approach,p_mm,value_um\nX,EX,0,0,0\n", "map.csv");
  REQUIRE(read);
  CHECK(read->header.machine == "Fr\xC3\xA4se 2");
}

TEST_CASE("a NUL in a map is named with its place") {
  const auto read =
      parse_map_csv(std::string("axis,sense,approach,p_mm,value_um\nX,EX,0,0,0\nX,EX,0,1\0,0\n", 54), "map.csv");
  REQUIRE_FALSE(read);
  CHECK(to_text(read.error()).starts_with("map.csv:3:9: a NUL byte (0)"));
}

TEST_CASE("UTF-16 cut in the middle of a letter is reported as such") {
  std::string cut = utf16(kMap, false, true);
  cut.pop_back();
  const auto read = parse_map_csv(cut, "map.csv");
  REQUIRE_FALSE(read);
  CHECK(read.error().message.find("UTF-16") != std::string::npos);
}

}  // namespace
}  // namespace ecs::laser
