// The unit's side of a bulk write.
#include "protocol/server/memory_window.hpp"

#include <doctest/doctest.h>
#include <rapidcheck.h>

#include "base/file.hpp"
#include "protocol/registers/unit_registers.hpp"
#include "protocol/registers/window_block.hpp"
#include "tests/support/unit_model.hpp"

using namespace ecs;
using namespace ecs::protocol;

namespace {

Registers block_of(const WindowOpen& window, std::uint16_t number, const std::vector<std::uint8_t>& image) {
  const auto part = std::span(image).subspan(number * kBlockBytes, bytes_in_block(window.length, number));
  Registers registers{window.tag, number, block_check(window.tag, number, part)};
  const auto payload = packed(part);
  registers.insert(registers.end(), payload.begin(), payload.end());
  return registers;
}

}  // namespace

TEST_CASE("blocks in any order, some twice, give the memory that was sent") {
  CHECK(rc::check([] {
    const auto length = *rc::gen::inRange<std::uint32_t>(1, kWindowBytes + 1);
    const auto image = noise_image(length, length);
    UnitModel model;
    MemoryWindow window(model);
    const WindowOpen open{5, kBankA.first + 100, length};
    window.open(open);
    std::vector<std::uint16_t> order;
    for (std::uint16_t n = 0; n < blocks_in(length); ++n) order.insert(order.end(), n % 3 == 0 ? 2 : 1, n);
    std::shuffle(order.begin(), order.end(), std::mt19937(length));
    for (const auto n : order) {
      RC_ASSERT(window.ack().crc == 0 || window.ack().crc == crc32_of(image));
      RC_ASSERT(window.take(block_of(open, n, image)));
    }
    RC_ASSERT(window.ack().crc == crc32_of(image));
    RC_ASSERT(std::equal(image.begin(), image.end(), model.bank_a.begin() + 100));
    RC_ASSERT(model.bank_a[99] == 0);
    RC_ASSERT(std::all_of(model.bank_a.begin() + 100 + length, model.bank_a.end(), [](auto b) { return b == 0; }));
  }));
}

TEST_CASE("a block that is not intact, of another window or beyond its end is not taken") {
  UnitModel model;
  MemoryWindow window(model);
  const auto image = noise_image(1000);
  const WindowOpen open{5, kBankA.first, 1000};
  window.open(open);
  auto flipped = block_of(open, 0, image);
  flipped[50] ^= 0x0100;
  CHECK_FALSE(window.take(flipped));
  auto moved = block_of(open, 0, image);
  moved[1] = 1;
  CHECK_FALSE(window.take(moved));
  CHECK_FALSE(window.take(block_of({6, kBankA.first, 1000}, 0, image)));
  auto cut = block_of(open, 0, image);
  cut.pop_back();
  CHECK_FALSE(window.take(cut));
  Registers beyond{5, 5, block_check(5, 5, {})};
  CHECK_FALSE(window.take(beyond));
  CHECK(window.ack().received == 0);
  CHECK(std::all_of(model.bank_a.begin(), model.bank_a.end(), [](auto b) { return b == 0; }));
}

TEST_CASE("the same tag again keeps what has arrived, a new tag starts afresh") {
  UnitModel model;
  MemoryWindow window(model);
  const auto image = noise_image(1000);
  const WindowOpen open{5, kBankA.first, 1000};
  window.open(open);
  CHECK(window.take(block_of(open, 2, image)));
  window.open(open);
  CHECK(window.ack().received == 0b100);
  window.open({6, kBankA.first, 1000});
  CHECK(window.ack().received == 0);
}

TEST_CASE("a window onto memory that may not be written stays closed and says why") {
  UnitModel model;
  MemoryWindow window(model);
  const auto image = noise_image(1000);
  window.open({5, 0x900000, 1000});
  CHECK(window.ack().error == UnitError::address_unknown);
  CHECK_FALSE(window.take(block_of({5, 0x900000, 1000}, 0, image)));
  model.mode = UnitMode::compensating;
  window.open({6, kBankA.first, 1000});
  CHECK(window.ack().error == UnitError::not_in_integration_mode);
  model.mode = UnitMode::integration;
  window.open({7, kBankA.first, kWindowBytes + 1});
  CHECK(window.ack().error == UnitError::bad_argument);
}

TEST_CASE("a window that was closed takes nothing more and says that nothing is staged") {
  UnitModel model;
  RegisterServer server(model);
  const auto image = noise_image(1000);
  const WindowOpen open{5, kBankA.first, 1000};
  REQUIRE(server.write(kWindowOpen.first, registers_of(open, 1)).has_value());
  REQUIRE(server.write(kBlockWrite.first, block_of(open, 0, image)).has_value());
  Command begin;
  begin.code = CommandCode::begin_staging;
  begin.sequence = 9;
  REQUIRE(server.write(kCommand.first, registers_of(begin, 2)).has_value());
  CHECK_FALSE(server.write(kBlockWrite.first, block_of(open, 1, image)).has_value());
  const auto ack = server.read(kWindowAck.first, kWindowAck.count).and_then([](const Registers& block) {
    return tl::expected<WindowAck, ModbusException>(window_ack_in(block).value());
  });
  REQUIRE(ack.has_value());
  CHECK(ack->error == UnitError::no_staging);
  CHECK(ack->received == 0);
}

TEST_CASE("a command acts only as a whole block, and a late repeat of an earlier one does nothing") {
  UnitModel model;
  RegisterServer server(model);
  const auto give = [&](std::uint16_t sequence, CommandCode code) {
    Command command;
    command.sequence = sequence;
    command.code = code;
    CHECK(server.write(kCommand.first, registers_of(command, 0)).has_value());
  };
  give(11, CommandCode::output_compensation);
  give(12, CommandCode::output_off);
  CHECK(model.log == std::vector{CommandCode::output_compensation, CommandCode::output_off});
  const std::uint16_t again = 13;
  CHECK(server.write(kCommand.first + 1, std::span(&again, 1)).has_value());
  CHECK(server.write(kCommand.first, std::vector<std::uint16_t>{0, 14, 4}).has_value());
  give(11, CommandCode::output_compensation);  // a retry that another host's order has overtaken
  CHECK(model.log.size() == 2);
  give(15, CommandCode::clear_fault);
  CHECK(model.log.size() == 3);
}
