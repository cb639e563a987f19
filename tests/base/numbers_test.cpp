// Numbers as a user types them.
#include "base/text.hpp"
#include "tests/support/test.hpp"

using namespace ecs;

TEST_CASE("whole numbers are decimal or hexadecimal, of 32 bits") {
  CHECK(whole_number("4096", "length") == 4096U);
  CHECK(whole_number(" 0x1000 ", "length") == 4096U);
  CHECK(whole_number("0XfF", "length") == 255U);
  CHECK(whole_number("4294967295", "length") == 4294967295U);
}

TEST_CASE("anything else is a usage problem that names the value and its text") {
  for (const char* text : {"", "0x", "-1", "1.5", "4294967296", "0x100000000", "12 34", "ten"}) {
    const auto number = must_fail(whole_number(text, "length"));
    CHECK(number.kind == ProblemKind::usage);
    CHECK(number.message ==
          "length: expected a whole number such as 4096 or 0x1000, got \"" + std::string(text) + "\"");
  }
}

TEST_CASE("a cell has three decimals, or a dash where there is no value") {
  CHECK(cell_text(1.23456) == "1.235");
  CHECK(cell_text(std::nullopt) == "-");
}
