// Rice codes: R. F. Rice, JPL 79-22 (1979). Repeats: J. Ziv, A. Lempel, IEEE IT-23 (1977); their lengths in Elias's
// gamma code, IEEE IT-21 (1975).
#include "core/block_code.hpp"

#include <algorithm>

namespace ecs {
namespace {

using namespace block_code;

/// Bits of a code, high bit first. Beyond its end it reads zeros and is no longer good.
class BitReader {
 public:
  explicit BitReader(ByteView bytes) noexcept : bytes_(bytes) {}
  [[nodiscard]] bool good() const noexcept { return good_; }
  void fail() noexcept { good_ = false; }
  std::uint32_t bits(unsigned count) noexcept {
    std::uint32_t value = 0;
    for (unsigned i = 0; i < count; ++i) value = value << 1 | bit();
    return value;
  }
  std::uint32_t bit() noexcept {
    if (at_ / 8 >= bytes_.size()) good_ = false;
    if (!good_) return 0;
    const std::uint32_t value = (bytes_[at_ / 8] >> (7 - at_ % 8)) & 1u;
    ++at_;
    return value;
  }
  /// Only padding is left.
  [[nodiscard]] bool at_end() noexcept {
    if (bytes_.size() * 8 - at_ >= 16) return false;
    while (at_ < bytes_.size() * 8)
      if (bit() != 0) return false;
    return good_;
  }

 private:
  ByteView bytes_;
  std::size_t at_ = 0;
  bool good_ = true;
};

std::uint16_t rice(BitReader& in, unsigned parameter) noexcept {
  std::uint32_t ones = 0;
  while (ones < kMostUnary && in.bit() != 0) ++ones;
  if (ones == kMostUnary) return static_cast<std::uint16_t>(in.bits(16));
  const std::uint32_t number = ones << parameter | in.bits(parameter);
  if (number > 0xFFFF) in.fail();
  return static_cast<std::uint16_t>(number);
}

/// Elias's gamma code of a number from 1 on.
std::size_t gamma(BitReader& in) noexcept {
  unsigned zeros = 0;
  while (in.good() && in.bit() == 0) ++zeros;
  if (zeros > 15) in.fail();
  return in.good() ? std::size_t{1} << zeros | in.bits(zeros) : 1;
}

void plain(BitReader& in, Bytes memory, std::size_t from) noexcept {
  for (std::size_t at = from; in.good() && at < memory.size(); ++at) memory[at] = static_cast<std::uint8_t>(in.bits(8));
}

void differences(BitReader& in, Bytes memory, std::size_t from, BlockMode mode) noexcept {
  const unsigned parameter = in.bits(kParameterBits);
  if (parameter > kMostParameter) in.fail();
  std::size_t at = from;
  for (; in.good() && at + 1 < memory.size(); at += 2)
    store_big(memory, at, static_cast<std::uint16_t>(expected_word(memory, at, mode) + unfolded(rice(in, parameter))));
  if (at < memory.size()) plain(in, memory, at);
}

void repeat(BitReader& in, Bytes memory, std::size_t& at) noexcept {
  const std::size_t distance = in.bits(kDistanceBits) + 1;
  const std::size_t count = gamma(in) + kLeastRepeat - 1;
  if (distance > at || count > memory.size() - at) in.fail();
  for (std::size_t i = 0; in.good() && i < count; ++i, ++at) memory[at] = memory[at - distance];
}

void digits(BitReader& in, Bytes memory, std::size_t& at) noexcept {
  const std::size_t count = in.bits(kRunBits) + 1;
  if (count > memory.size() - at) in.fail();
  for (std::size_t i = 0; in.good() && i < count; ++i, ++at)
    memory[at] = static_cast<std::uint8_t>("0123456789abcdef"[in.bits(4)]);
}

void text(BitReader& in, Bytes memory, std::size_t from) noexcept {
  for (std::size_t at = from; in.good() && at < memory.size();) {
    if (in.bit() == 0)
      memory[at++] = static_cast<std::uint8_t>(in.bits(8));
    else if (in.bit() == 0)
      repeat(in, memory, at);
    else
      digits(in, memory, at);
  }
}

}  // namespace

std::uint16_t block_code::expected_word(ByteView bytes, std::size_t at, BlockMode mode) noexcept {
  const auto word = [&](std::size_t back) -> unsigned {
    return at >= back ? load_big<std::uint16_t>(bytes, at - back) : 0u;
  };
  if (mode == BlockMode::differences) return static_cast<std::uint16_t>(word(2));
  return static_cast<std::uint16_t>(2 * word(2) - word(4));
}

bool decode_blocks(ByteView code, Bytes memory, std::size_t history, std::size_t block_bytes) noexcept {
  BitReader in(code);
  for (std::size_t from = history; in.good() && from < memory.size(); from += block_bytes) {
    const Bytes so_far = memory.first(std::min(from + block_bytes, memory.size()));
    const auto mode = static_cast<BlockMode>(in.bits(kModeBits));
    if (mode == BlockMode::plain)
      plain(in, so_far, from);
    else if (mode == BlockMode::text)
      text(in, so_far, from);
    else
      differences(in, so_far, from, mode);
  }
  return in.good() && in.at_end();
}

}  // namespace ecs
