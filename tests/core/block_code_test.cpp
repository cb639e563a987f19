// Codes written by hand: what each mode means, and what no encoder writes.
#include "core/block_code.hpp"

#include "tests/support/test.hpp"

using namespace ecs;

namespace {

/// "01 0000 10" as bytes, filled with zeros.
std::vector<std::uint8_t> bits(const std::string& text) {
  std::vector<std::uint8_t> bytes;
  unsigned count = 0;
  for (const char c : text) {
    if (c == ' ') continue;
    if (count % 8 == 0) bytes.push_back(0);
    if (c == '1') bytes.back() = static_cast<std::uint8_t>(bytes.back() | 0x80u >> count % 8);
    ++count;
  }
  return bytes;
}

/// The decoded bytes; nothing if the code is refused.
std::vector<int> decoded(const std::string& code, std::size_t room, std::vector<std::uint8_t> history = {}) {
  const std::size_t before = history.size();
  history.resize(before + room);
  if (!decode_blocks(bits(code), history, before, 120)) return {};
  return {history.begin() + static_cast<std::ptrdiff_t>(before), history.end()};
}

}  // namespace

TEST_CASE("plain bytes are eight bits each") { CHECK(decoded("00 00000101 11111111", 2) == std::vector<int>{5, 255}); }

TEST_CASE("differences continue the word before, a fold of 1 is minus one") {
  // parameter 0: the fold in ones and a zero; +1, +1, -1
  CHECK(decoded("01 0000 110 110 10", 6, {1, 0}) == std::vector<int>{1, 1, 1, 2, 1, 1});
  // parameter 2: fold 6 = 1 and 10, that is +3
  CHECK(decoded("01 0010 10 10", 2) == std::vector<int>{0, 3});
}

TEST_CASE("second differences continue the line through the two words before") {
  CHECK(decoded("10 0000 0 0", 4, {0, 10, 0, 20}) == std::vector<int>{0, 30, 0, 40});
}

TEST_CASE("a large fold stands in sixteen bits behind twenty ones") {
  CHECK(decoded("01 0000 11111111111111111111 1000000000000000", 2) == std::vector<int>{0x40, 0});
}

TEST_CASE("text is literals, repeats and runs of hexadecimal digits") {
  CHECK(decoded("11 0 01000001 10 0000000000 010", 5) == std::vector<int>{'A', 'A', 'A', 'A', 'A'});
  CHECK(decoded("11 11 000001 1111 0000", 2) == std::vector<int>{'f', '0'});
}

TEST_CASE("what no encoder writes is refused") {
  CHECK(decoded("11 10 0000000000 011", 5).empty());                            // repeats what lies before the image
  CHECK(decoded("11 0 01000001 10 0000000000 010", 4).empty());                 // a repeat beyond the block
  CHECK(decoded("11 11 000010 1111 0000 0000", 2).empty());                     // a run beyond the block
  CHECK(decoded("01 1111 0", 2).empty());                                       // no such parameter
  CHECK(decoded("01 1110 11110 00000000000000", 2).empty());                    // a fold of more than 16 bits
  CHECK(decoded("00 00000101", 2).empty());                                     // ends too early
  CHECK(decoded("00 00000101 1", 1).empty());                                   // padding that is not zero
  CHECK(decoded("11 0 01000001 10 0000000000 0000000000000000 1", 5).empty());  // a length of more than 16 bits
}
