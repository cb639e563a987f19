#include "protocol/registers/window_block.hpp"

#include <vector>

#include <doctest/doctest.h>

#include "protocol/registers/register_map.hpp"

using namespace ecs::protocol;

TEST_CASE("a window has as many blocks of 240 bytes as its bytes need, the last one shorter") {
  CHECK(blocks_in(0) == 0);
  CHECK(blocks_in(1) == 1);
  CHECK(blocks_in(240) == 1);
  CHECK(blocks_in(241) == 2);
  CHECK(bytes_in_block(241, 0) == 240);
  CHECK(bytes_in_block(241, 1) == 1);
  CHECK(bytes_in_block(241, 2) == 0);
}

TEST_CASE("the bytes of all blocks are the bytes of the window") {
  for (const std::uint32_t length : {1U, 239U, 240U, 1000U, static_cast<std::uint32_t>(kWindowBytes)}) {
    std::size_t sum = 0;
    for (std::size_t number = 0; number < blocks_in(length); ++number) sum += bytes_in_block(length, number);
    CHECK(sum == length);
  }
}

TEST_CASE("the check of a block is the Modbus CRC-16 over session, token, tag, number and payload, high byte first") {
  // of "0123456789AB9", by a program of its own that gives 0x4B37 for "123456789" as the catalogue of CRCs does
  const std::vector<std::uint8_t> payload{'9'};
  CHECK(block_check({0x3839, 0, 0, 0x34353637, false, 0x30313233}, 0x4142, payload) == 0x8101);
}
