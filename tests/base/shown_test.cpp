// Text of files and units on a terminal, and in JSON.
#include <rapidcheck.h>

#include "base/json.hpp"
#include "base/text.hpp"
#include "tests/support/test.hpp"

namespace ecs {
namespace {

TEST_CASE("letters of every language, tabs and line ends stay") {
  for (const char* text : {"plain", "Müller & Söhne, 5 µm\tΔ\n", "工作機械", "\xF0\x9F\x94\xA7"})
    CHECK(shown(text) == text);
}

TEST_CASE("control characters of a terminal become question marks") {
  CHECK(shown("a\x1B[2Jb") == "a?[2Jb");
  CHECK(shown("\x07\x08\r\x7F") == "????");
  CHECK(shown("\xC2\x9B"
              "31m") == "?31m");                    // CSI as one character
  CHECK(shown("map\xE2\x80\xAEvsc") == "map?vsc");  // right-to-left override
  CHECK(shown(std::string_view("a\0b", 3)) == "a?b");
}

TEST_CASE("bytes that are no UTF-8 become question marks, one each") {
  CHECK(shown("\xFF") == "?");
  CHECK(shown("\xC0\x9B") == "??");  // overlong escape
  CHECK(shown("\xE0\x80\x9B") == "???");
  CHECK(shown("\xED\xA0\x80") == "???");       // surrogate
  CHECK(shown("\xF4\x90\x80\x80") == "????");  // above U+10FFFF
  CHECK(shown("ab\xC3") == "ab?");
}

TEST_CASE("JSON on a terminal holds no control character, and means the same") {
  const std::string name = "a\x1B[2J\x7F\xC2\x9B\xE2\x80\xAEµ\n";
  const std::string line = one_line(Json(name));
  CHECK(line == "\"a\\u001b[2J\\u007f\\u009b\\u202eµ\\n\"");
  CHECK(Json::parse(line).get<std::string>() == name);
}

TEST_CASE("a line that is too long is cut between characters, and says so") {
  CHECK(cut_line("short", 5) == "short");
  CHECK(cut_line("aµb", 2) == "a… (cut: 4 bytes)");
  CHECK(cut_line(std::string(3'000'000, 'N'), 4).size() < 40);
}

TEST_CASE("whatever the bytes, what is shown holds no control character and stays as it is when shown again") {
  CHECK(rc::check([](const std::string& bytes) {
    const std::string once = shown(bytes);
    for (const char c : once) {
      const auto byte = static_cast<unsigned char>(c);
      RC_ASSERT(byte >= 0x20 || c == '\n' || c == '\t');
      RC_ASSERT(byte != 0x7F);
    }
    RC_ASSERT(shown(once) == once);
    // what is left is UTF-8: strict JSON takes it
    RC_ASSERT(Json(once).dump().size() >= 2);
  }));
}

}  // namespace
}  // namespace ecs
