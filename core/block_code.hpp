// Coded blocks: the short form in which a memory image travels to the unit. A block is a stretch of the image that is
// decoded after what lies before it, in memory fixed beforehand. Does not live here: the encoder
// (protocol/client/block_frames.hpp), the frames that carry the codes (docs/protocol.md, "coded blocks").
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/bytes.hpp"

namespace ecs {

/// How the bytes of one block are coded. Bits are packed high bit first, blocks follow each other without a gap.
enum class BlockMode : std::uint8_t {
  plain = 0,               ///< every byte as 8 bits
  differences = 1,         ///< 16-bit words: each less the one before it, in Rice codes
  second_differences = 2,  ///< each less the continuation of the two before it, in Rice codes
  text = 3,                ///< literals, repeats of what lies up to 1,024 bytes back, runs of hexadecimal digits
};

namespace block_code {
inline constexpr unsigned kModeBits = 2;
inline constexpr unsigned kParameterBits = 4;   ///< of a Rice code: low bits of a number that follow its unary part
inline constexpr unsigned kMostParameter = 14;  ///< larger ones are not used
inline constexpr unsigned kMostUnary = 20;      ///< this many ones: the number follows in 16 bits
inline constexpr unsigned kDistanceBits = 10;
inline constexpr std::size_t kHistoryBytes = std::size_t{1} << kDistanceBits;
inline constexpr std::size_t kLeastRepeat = 3;
inline constexpr unsigned kRunBits = 6;  ///< hexadecimal digits in a run, less one

/// Differences as numbers without sign: 0, −1, 1, −2 … become 0, 1, 2, 3 …, all modulo 65,536.
[[nodiscard]] constexpr std::uint16_t folded(std::uint16_t difference) noexcept {
  return static_cast<std::uint16_t>((difference << 1) ^ ((difference & 0x8000u) != 0 ? 0xFFFFu : 0u));
}
[[nodiscard]] constexpr std::uint16_t unfolded(std::uint16_t number) noexcept {
  return static_cast<std::uint16_t>((number >> 1) ^ ((number & 1u) != 0 ? 0xFFFFu : 0u));
}

/// What the word at `at` is expected to be, from those before it; words before the first byte count as 0.
[[nodiscard]] std::uint16_t expected_word(ByteView bytes, std::size_t at, BlockMode mode) noexcept;
}  // namespace block_code

/// Decodes blocks that follow each other. Total: any code is accepted as input; takes time in proportion to `memory`.
/// @param code         all of it must be used, but for less than 16 bits of zeros at its end
/// @param memory       first `history` bytes that lie before the blocks in the image, then room for the blocks
/// @param block_bytes  of each block, the last may be shorter; even, above 0
/// @return false: no code that an encoder writes; the room may then hold anything
/// @pre history <= memory.size()
[[nodiscard]] bool decode_blocks(ByteView code, Bytes memory, std::size_t history, std::size_t block_bytes) noexcept;

}  // namespace ecs
