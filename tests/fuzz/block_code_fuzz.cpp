// libFuzzer over the decoder of coded blocks: any code is decoded within its room or refused, and what was decoded
// comes back when it is coded again.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "protocol/client/block_frames.hpp"

namespace {

constexpr std::size_t kBlock = 120;

void check(bool holds) {
  if (!holds) std::abort();
}

}  // namespace

/// The first byte chooses how much lies before the blocks, the second how long they are.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const std::size_t history = 4 * std::size_t{data[0]}, room = 1 + 8 * std::size_t{data[1]};
  std::vector<std::uint8_t> memory(history + room);
  for (std::size_t i = 0; i < history; ++i) memory[i] = static_cast<std::uint8_t>(i * 7);
  const bool decoded = ecs::decode_blocks({data + 2, size - 2}, memory, history, kBlock);
  for (std::size_t i = 0; i < history; ++i) check(memory[i] == static_cast<std::uint8_t>(i * 7));
  if (!decoded) return 0;
  ecs::protocol::BitWriter code;
  for (std::size_t at = history; at < memory.size(); at += kBlock)
    code.append(ecs::protocol::coded_block(memory, at, std::min(at + kBlock, memory.size())));
  std::vector<std::uint8_t> again = memory;
  std::fill(again.begin() + static_cast<std::ptrdiff_t>(history), again.end(), std::uint8_t{0});
  check(ecs::decode_blocks(code.bytes(), again, history, kBlock));
  check(again == memory);
  return 0;
}
