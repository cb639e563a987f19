#include "base/plain_text.hpp"

#include <doctest/doctest.h>

namespace ecs {
namespace {

std::string utf16le(const std::string& text, bool mark) {
  std::string out = mark ? "\xFF\xFE" : "";
  for (const char c : text) out += {c, '\0'};
  return out;
}

TEST_CASE("UTF-16 is recognised by its mark or by its zeros, and the message says what to do") {
  for (const bool mark : {true, false}) {
    const auto why = why_no_text(utf16le("name = \"mill\"\n", mark), "m.toml");
    REQUIRE(why);
    CHECK(to_text(*why) == "m.toml: this is UTF-16: save it as UTF-8");
  }
  CHECK(utf16_order(utf16le("abcd", true)) == std::string("UTF-16LE"));
  CHECK(utf16_order(std::string_view("\0a\0b\0c", 6)) == std::string("UTF-16BE"));
}

TEST_CASE("a NUL byte is named with its line and column") {
  const auto why = why_no_text(std::string_view("first\nsec\0nd\n", 13), "p.toml");
  REQUIRE(why);
  CHECK(to_text(*why).starts_with("p.toml:2:4: a NUL byte (0)"));
  CHECK(why_no_text(std::string_view("\0abc", 4), "p")->column == 1);
}

TEST_CASE("text is left alone, whatever its letters") {
  CHECK_FALSE(why_no_text("", "p"));
  CHECK_FALSE(why_no_text("a\xC3\xA4\r\n\xFF", "p"));
  CHECK_FALSE(why_no_text("\xEF\xBB\xBFname", "p"));
}

}  // namespace
}  // namespace ecs
