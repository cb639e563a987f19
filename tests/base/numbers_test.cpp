// Numbers as a user types them.
#include <doctest/doctest.h>

#include "base/text.hpp"

using namespace ecs;

TEST_CASE("whole numbers are decimal or hexadecimal, of 32 bits") {
  CHECK(whole_number("4096", "length") == 4096U);
  CHECK(whole_number(" 0x1000 ", "length") == 4096U);
  CHECK(whole_number("0XfF", "length") == 255U);
  CHECK(whole_number("4294967295", "length") == 4294967295U);
}

TEST_CASE("anything else is a usage problem that names the value and its text") {
  for (const char* text : {"", "0x", "-1", "1.5", "4294967296", "0x100000000", "12 34", "ten"}) {
    const auto number = whole_number(text, "length");
    REQUIRE_FALSE(number);
    CHECK(number.error().kind == ProblemKind::usage);
    CHECK(number.error().message ==
          "length: expected a whole number such as 4096 or 0x1000, got \"" + std::string(text) + "\"");
  }
}

TEST_CASE("a cell has three decimals, or a dash where there is no value") {
  CHECK(cell_text(1.23456) == "1.235");
  CHECK(cell_text(std::nullopt) == "-");
}
