// The RAM test of power-up: it finds the first bad location and gives every other its content back.
#include <cstdint>

#include "core/address_map.hpp"
#include "tests/support/test.hpp"

using namespace ecs;

namespace {

/// Memory of 4,096 bytes at 0x100000 in which one bit may be stuck.
struct Memory {
  std::vector<std::uint8_t> bytes;
  Address stuck_at = 0;
  std::uint8_t stuck_bit = 0;
  bool stuck_high = false;
  int outside = 0;

  Memory() {
    for (std::uint32_t i = 0; i < 4096; ++i) bytes.push_back(static_cast<std::uint8_t>(i * 37 + 11));
  }
  std::uint8_t read(Address address) { return bytes[place(address)]; }
  void write(Address address, std::uint8_t value) {
    if (stuck_bit != 0 && address == stuck_at)
      value = static_cast<std::uint8_t>(stuck_high ? value | stuck_bit : value & ~stuck_bit);
    bytes[place(address)] = value;
  }

 private:
  std::size_t place(Address address) {
    if (address < 0x100000 || address >= 0x101000) ++outside;
    return (address - 0x100000) % 4096;
  }
};

}  // namespace

TEST_CASE("intact memory passes and keeps its content") {
  Memory memory;
  const auto before = memory.bytes;
  CHECK(!failing_address(memory, 0x100000, 4096));
  CHECK(memory.bytes == before);
  CHECK(memory.outside == 0);
}

TEST_CASE("any stuck bit is found, high or low, with its address, and the rest keeps its content") {
  for (const Address address : {0x100000u, 0x100001u, 0x1007FFu, 0x100FFFu})
    for (int bit = 0; bit < 8; ++bit)
      for (const bool high : {false, true}) {
        Memory memory;
        const auto before = memory.bytes;
        memory.stuck_at = address;
        memory.stuck_bit = static_cast<std::uint8_t>(1 << bit);
        memory.stuck_high = high;
        CHECK(failing_address(memory, 0x100000, 4096) == address);
        for (std::uint32_t i = 0; i < 4096; ++i)
          if (0x100000 + i != address) REQUIRE(memory.bytes[i] == before[i]);
      }
}

TEST_CASE("only the region named is tested") {
  Memory memory;
  memory.stuck_at = 0x100010;
  memory.stuck_bit = 1;
  CHECK(!failing_address(memory, 0x100000, 16));
  CHECK(!failing_address(memory, 0x100011, 100));
  CHECK(!failing_address(memory, 0x100000, 0));
}
