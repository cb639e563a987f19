// The shortest code of a block: every mode is tried; text by the cheapest chain of tokens (dynamic programming).
#include "protocol/client/block_frames.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>

namespace ecs::protocol {
namespace {

using namespace block_code;
using View = std::span<const std::uint8_t>;

// --- differences
void put_rice(BitWriter& out, std::uint16_t number, unsigned parameter) {
  const unsigned ones = number >> parameter;
  if (ones >= kMostUnary) {
    out.put((1u << kMostUnary) - 1, kMostUnary);
    out.put(number, 16);
    return;
  }
  out.put((1u << (ones + 1)) - 2, ones + 1);
  out.put(number & ((1u << parameter) - 1), parameter);
}

std::size_t rice_bits(std::uint16_t number, unsigned parameter) {
  const unsigned ones = number >> parameter;
  return ones >= kMostUnary ? kMostUnary + 16 : ones + 1 + parameter;
}

std::vector<std::uint16_t> numbers_of(View bytes, std::size_t from, std::size_t to, BlockMode mode) {
  std::vector<std::uint16_t> numbers;
  for (std::size_t at = from; at + 1 < to; at += 2)
    numbers.push_back(
        folded(static_cast<std::uint16_t>(load_big<std::uint16_t>(bytes, at) - expected_word(bytes, at, mode))));
  return numbers;
}

BitWriter as_differences(View bytes, std::size_t from, std::size_t to, BlockMode mode) {
  const auto numbers = numbers_of(bytes, from, to, mode);
  unsigned best = 0;
  std::size_t least = std::numeric_limits<std::size_t>::max();
  for (unsigned parameter = 0; parameter <= kMostParameter; ++parameter) {
    std::size_t bits = 0;
    for (const std::uint16_t number : numbers) bits += rice_bits(number, parameter);
    if (bits < least) least = bits, best = parameter;
  }
  BitWriter out;
  out.put(static_cast<std::uint32_t>(mode), kModeBits);
  out.put(best, kParameterBits);
  for (const std::uint16_t number : numbers) put_rice(out, number, best);
  if ((to - from) % 2 != 0) out.put(bytes[to - 1], 8);
  return out;
}

// --- text
struct Token {
  enum class Kind { literal, repeat, digits } kind = Kind::literal;
  std::size_t count = 1;
  std::size_t distance = 0;
};

std::size_t gamma_bits(std::size_t number) { return 2 * static_cast<std::size_t>(std::bit_width(number)) - 1; }

bool is_digit(std::uint8_t byte) { return (byte >= '0' && byte <= '9') || (byte >= 'a' && byte <= 'f'); }

/// The longest repeat of what lies before `at`, and how far back it begins; the nearest of equals.
Token longest_repeat(View bytes, std::size_t at, std::size_t to) {
  Token best{Token::Kind::repeat, 0, 0};
  const std::size_t furthest = std::min(at, kHistoryBytes);
  for (std::size_t distance = 0; distance < furthest && at + best.count < to;) {
    const std::size_t next = at + best.count;  // that byte agrees in a longer one
    const void* const found = ::memrchr(&bytes[next - furthest], bytes[next], furthest - distance);
    if (found == nullptr) break;
    distance = static_cast<std::size_t>(&bytes[next] - static_cast<const std::uint8_t*>(found));
    std::size_t count = 0;
    while (at + count < to && bytes[at + count] == bytes[at + count - distance]) ++count;
    if (count > best.count) best = {Token::Kind::repeat, count, distance};
  }
  return best;
}

/// For every place of the block the token that begins the cheapest code of the rest.
std::vector<Token> cheapest_tokens(View bytes, std::size_t from, std::size_t to) {
  std::vector<std::size_t> bits(to - from + 1, 0);
  std::vector<Token> tokens(to - from);
  std::size_t digits = 0;
  for (std::size_t at = to; at-- > from;) {
    const std::size_t i = at - from;
    const auto take = [&](Token token, std::size_t cost) {
      if (cost + bits[i + token.count] < bits[i]) bits[i] = cost + bits[i + token.count], tokens[i] = token;
    };
    bits[i] = 9 + bits[i + 1];
    digits = is_digit(bytes[at]) ? digits + 1 : 0;
    for (std::size_t count = 2; count <= std::min<std::size_t>(digits, std::size_t{1} << kRunBits); ++count)
      take({Token::Kind::digits, count, 0}, 2 + kRunBits + 4 * count);
    const Token repeat = longest_repeat(bytes, at, to);
    for (std::size_t count = kLeastRepeat; count <= repeat.count; ++count)
      take({Token::Kind::repeat, count, repeat.distance}, 2 + kDistanceBits + gamma_bits(count - kLeastRepeat + 1));
  }
  return tokens;
}

void put_token(BitWriter& out, const Token& token, View bytes, std::size_t at) {
  if (token.kind == Token::Kind::literal) return out.put(bytes[at], 9);
  if (token.kind == Token::Kind::repeat) {
    out.put(0b10, 2);
    out.put(static_cast<std::uint32_t>(token.distance - 1), kDistanceBits);
    const std::size_t number = token.count - kLeastRepeat + 1;
    return out.put(static_cast<std::uint32_t>(number), static_cast<unsigned>(gamma_bits(number)));
  }
  out.put(0b11, 2);
  out.put(static_cast<std::uint32_t>(token.count - 1), kRunBits);
  for (std::size_t i = 0; i < token.count; ++i) {
    const std::uint8_t digit = bytes[at + i];
    out.put(digit <= '9' ? digit - '0' : digit - 'a' + 10u, 4);
  }
}

BitWriter as_text(View bytes, std::size_t from, std::size_t to) {
  const auto tokens = cheapest_tokens(bytes, from, to);
  BitWriter out;
  out.put(static_cast<std::uint32_t>(BlockMode::text), kModeBits);
  for (std::size_t at = from; at < to; at += tokens[at - from].count) put_token(out, tokens[at - from], bytes, at);
  return out;
}

BitWriter as_it_is(View bytes, std::size_t from, std::size_t to) {
  BitWriter out;
  out.put(static_cast<std::uint32_t>(BlockMode::plain), kModeBits);
  for (std::size_t at = from; at < to; ++at) out.put(bytes[at], 8);
  return out;
}

}  // namespace

void BitWriter::put(std::uint32_t value, unsigned count) {
  for (unsigned i = count; i-- > 0; ++bits_) {
    if (bits_ % 8 == 0) bytes_.push_back(0);
    bytes_.back() = static_cast<std::uint8_t>(bytes_.back() | ((value >> i & 1u) << (7 - bits_ % 8)));
  }
}

void BitWriter::append(const BitWriter& other) {
  for (std::size_t i = 0; i < other.bits_; ++i) put(other.bytes_[i / 8] >> (7 - i % 8) & 1u, 1);
}

BitWriter coded_block(std::span<const std::uint8_t> bytes, std::size_t from, std::size_t to) {
  std::array candidates{as_it_is(bytes, from, to), as_differences(bytes, from, to, BlockMode::differences),
                        as_differences(bytes, from, to, BlockMode::second_differences), as_text(bytes, from, to)};
  return *std::min_element(candidates.begin(), candidates.end(),
                           [](const BitWriter& a, const BitWriter& b) { return a.size() < b.size(); });
}

namespace {

/// Of a frame beside its payload: function 16 and block header 15, reply 8, two silent gaps of 3.5 characters.
constexpr std::size_t kFrameOverhead = 30;

constexpr std::size_t kCodedWindowBytes = kWindowBlocks * kCodedBlockBytes;

/// As many blocks in each frame as there is room for. @pre at most kCodedWindowBytes
WindowFrames coded_window(Address bank, std::span<const std::uint8_t> image, std::size_t from, std::size_t to) {
  WindowFrames window{static_cast<Address>(bank + from), image.subspan(from, to - from), true, {}};
  BitWriter code;
  BlockFrame frame;
  std::size_t count = 0;
  const auto close = [&] {
    frame.number = static_cast<std::uint16_t>(frame.number | (count - 1) << 8);
    frame.payload = code.bytes();
    window.frames.push_back(frame);
  };
  for (std::size_t at = from, block = 0; at < to; at += kCodedBlockBytes, ++block) {
    const std::size_t end = std::min(at + kCodedBlockBytes, to);
    const BitWriter next = coded_block(image, at, end);
    const bool full = count == kCodedBlocksInFrame || code.size() + next.size() > 8 * kBlockBytes;
    if (count > 0 && full) {
      close();
      code = {};
      count = 0;
    }
    if (count == 0) frame = {static_cast<std::uint16_t>(block), 0, {}, 0};
    code.append(next);
    frame.blocks |= std::uint64_t{1} << block;
    frame.bytes += end - at;
    ++count;
  }
  close();
  return window;
}

}  // namespace

WindowFrames plain_window(Address address, std::span<const std::uint8_t> bytes) {
  WindowFrames window{address, bytes, false, {}};
  for (std::size_t at = 0, block = 0; at < bytes.size(); at += kBlockBytes, ++block) {
    const auto part = bytes.subspan(at, std::min(kBlockBytes, bytes.size() - at));
    window.frames.push_back(
        {static_cast<std::uint16_t>(block), std::uint64_t{1} << block, {part.begin(), part.end()}, part.size()});
  }
  return window;
}

std::size_t wire_bytes(const WindowFrames& window) {
  std::size_t bytes = 0;
  for (const BlockFrame& frame : window.frames) bytes += frame.payload.size() + kFrameOverhead;
  return bytes;
}

std::vector<WindowFrames> windows_of(Address bank, std::span<const std::uint8_t> image, std::size_t from,
                                     std::size_t to) {
  std::vector<WindowFrames> windows;
  for (std::size_t at = from; at < to; at += kWindowBytes) {
    const std::size_t end = std::min(at + kWindowBytes, to);
    WindowFrames plain = plain_window(static_cast<Address>(bank + at), image.subspan(at, end - at));
    std::vector<WindowFrames> coded;
    std::size_t bytes = 0;
    for (std::size_t part = at; part < end; part += kCodedWindowBytes) {
      coded.push_back(coded_window(bank, image, part, std::min(part + kCodedWindowBytes, end)));
      bytes += wire_bytes(coded.back());
    }
    if (bytes < wire_bytes(plain))
      windows.insert(windows.end(), coded.begin(), coded.end());
    else
      windows.push_back(std::move(plain));
  }
  return windows;
}

}  // namespace ecs::protocol
