// Coded blocks: what is coded comes back, and it is shorter where the bytes are smooth or text.
#include <random>

#include <rapidcheck.h>

#include "protocol/client/block_frames.hpp"
#include "tests/support/test.hpp"

namespace ecs::protocol {
namespace {

using Memory = std::vector<std::uint8_t>;

/// All blocks of [from, end) as one code.
BitWriter coded(const Memory& bytes, std::size_t from, std::size_t block_bytes) {
  BitWriter code;
  for (std::size_t at = from; at < bytes.size(); at += block_bytes)
    code.append(coded_block(bytes, at, std::min(at + block_bytes, bytes.size())));
  return code;
}

/// What the unit makes of it that holds the bytes before `from` already.
std::optional<Memory> decoded(const BitWriter& code, const Memory& bytes, std::size_t from, std::size_t block_bytes) {
  const std::size_t history = std::min(from, block_code::kHistoryBytes);
  const auto first = bytes.begin() + static_cast<std::ptrdiff_t>(from - history);
  Memory memory(first, first + static_cast<std::ptrdiff_t>(history));
  memory.resize(history + bytes.size() - from, 0xEE);
  if (!decode_blocks(code.bytes(), memory, history, block_bytes)) return std::nullopt;
  return Memory(memory.begin() + static_cast<std::ptrdiff_t>(history), memory.end());
}

void comes_back(const Memory& bytes, std::size_t from, std::size_t block_bytes) {
  const Memory wanted(bytes.begin() + static_cast<std::ptrdiff_t>(from), bytes.end());
  RC_ASSERT(decoded(coded(bytes, from, block_bytes), bytes, from, block_bytes) == wanted);
}

Memory any_bytes(std::size_t most) {
  return *rc::gen::resize(static_cast<int>(most), rc::gen::nonEmpty(rc::gen::arbitrary<Memory>()));
}

Memory words(const std::vector<std::int16_t>& values) {
  Memory bytes(2 * values.size());
  for (std::size_t i = 0; i < values.size(); ++i) store_big(bytes, 2 * i, static_cast<std::uint16_t>(values[i]));
  return bytes;
}

Memory smooth(std::size_t count) {
  std::vector<std::int16_t> values;
  for (std::size_t i = 0; i < count; ++i)
    values.push_back(static_cast<std::int16_t>(std::lround(2000.0 * std::sin(0.02 * static_cast<double>(i)))));
  return words(values);
}

Memory of(const std::string& text) { return {text.begin(), text.end()}; }

TEST_CASE("any bytes come back from their code, from any place of the image on") {
  CHECK(rc::check([] {
    const Memory bytes = any_bytes(2000);
    const std::size_t from = *rc::gen::inRange<std::size_t>(0, bytes.size());
    comes_back(bytes, from, 2 * *rc::gen::inRange<std::size_t>(1, 130));
  }));
}

TEST_CASE("words that jump between the ends of their range come back") {
  CHECK(rc::check([] {
    const auto values = *rc::gen::nonEmpty(rc::gen::container<std::vector<std::int16_t>>(
        rc::gen::element<std::int16_t>(-32'768, -32'767, -1, 0, 1, 255, 256, 32'766, 32'767)));
    comes_back(words(values), 0, 120);
  }));
}

TEST_CASE("text of few letters comes back, however often it repeats itself") {
  CHECK(rc::check([] {
    const auto text =
        *rc::gen::nonEmpty(rc::gen::container<std::string>(rc::gen::element('a', 'f', '0', '9', 'x', ' ')));
    const std::size_t times = *rc::gen::inRange<std::size_t>(1, 20);
    std::string all;
    for (std::size_t i = 0; i < times; ++i) all += text;
    comes_back(of(all), 0, 120);
  }));
}

TEST_CASE("a smooth table takes less than half of its bytes, zeros next to none, noise hardly more than itself") {
  CHECK(coded(smooth(1200), 0, 120).bytes().size() * 2 < 2400);
  CHECK(coded(Memory(2400, 0), 0, 120).bytes().size() < 100);
  std::mt19937 random(5);
  Memory noise(2400);
  for (auto& byte : noise) byte = static_cast<std::uint8_t>(random());
  CHECK(coded(noise, 0, 120).bytes().size() <= 2400 + 2400 / 120);
}

TEST_CASE("a digest takes half of its characters, the second of two equal lines a few bytes") {
  const std::string digest = "279732e7ffcf63cbabb9105f8b5ceb4a0fbc3cf3d3684e99befa005f711d6444";
  CHECK(coded(of(digest), 0, 120).bytes().size() <= 34);
  const std::string line = "source: EXX EXX.csv sha256=" + digest + "\n";
  CHECK(coded_block(of(line + line), line.size(), 2 * line.size()).bytes().size() <= 5);
}

TEST_CASE("a code that is cut, or longer than its blocks, is refused") {
  const Memory bytes = smooth(120);
  auto code = coded(bytes, 0, 120).bytes();
  Memory memory(bytes.size());
  REQUIRE(decode_blocks(code, memory, 0, 120));
  auto longer = code;
  longer.insert(longer.end(), 2, 0);
  CHECK_FALSE(decode_blocks(longer, memory, 0, 120));
  code.pop_back();
  CHECK_FALSE(decode_blocks(code, memory, 0, 120));
}

}  // namespace
}  // namespace ecs::protocol
