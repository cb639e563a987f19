// The unit's side of a bulk write.
#include <rapidcheck.h>

#include "base/file.hpp"
#include "base/random.hpp"
#include "protocol/client/block_frames.hpp"
#include "protocol/registers/unit_registers.hpp"
#include "protocol/server/register_server.hpp"
#include "tests/support/test.hpp"
#include "tests/support/unit_model.hpp"

using namespace ecs;
using namespace ecs::protocol;

namespace {

constexpr std::uint32_t kStagingToken = 0xA1B2C3D4;

struct StagedWindow {
  StagedWindow() { window.stage_under(kStagingToken); }
  UnitModel model;
  MemoryWindow window{model};
};

Registers block_of(const WindowOpen& window, std::uint16_t number, const std::vector<std::uint8_t>& image) {
  const auto part = std::span(image).subspan(number * kBlockBytes, bytes_in_block(window.length, number));
  Registers registers{window.tag, number, block_check(window, number, part)};
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
    window.stage_under(kStagingToken);
    const WindowOpen open{5, kBankA.first + 100, length, kStagingToken};
    window.open(open);
    std::vector<std::uint16_t> order;
    for (std::size_t n = 0; n < blocks_in(length); ++n)
      order.insert(order.end(), n % 3 == 0 ? 2 : 1, static_cast<std::uint16_t>(n));
    std::mt19937 random(length);
    shuffle(order, random);
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

TEST_CASE_FIXTURE(StagedWindow, "a block that is not intact, of another window or beyond its end is not taken") {
  const auto image = noise_image(1000);
  const WindowOpen open{5, kBankA.first, 1000, kStagingToken};
  window.open(open);
  auto flipped = block_of(open, 0, image);
  flipped[50] ^= 0x0100;
  CHECK_FALSE(window.take(flipped));
  auto moved = block_of(open, 0, image);
  moved[1] = 1;
  CHECK_FALSE(window.take(moved));
  CHECK_FALSE(window.take(block_of({6, kBankA.first, 1000, kStagingToken}, 0, image)));
  auto cut = block_of(open, 0, image);
  cut.pop_back();
  CHECK_FALSE(window.take(cut));
  Registers beyond{5, 5, block_check(open, 5, {})};
  CHECK_FALSE(window.take(beyond));
  CHECK(window.ack().received == 0);
  CHECK(std::all_of(model.bank_a.begin(), model.bank_a.end(), [](auto b) { return b == 0; }));
}

TEST_CASE_FIXTURE(StagedWindow, "the same tag again keeps what has arrived, a new tag starts afresh") {
  const auto image = noise_image(1000);
  const WindowOpen open{5, kBankA.first, 1000, kStagingToken};
  window.open(open);
  CHECK(window.take(block_of(open, 2, image)));
  window.open(open);
  CHECK(window.ack().received == 0b100);
  window.open({6, kBankA.first, 1000, kStagingToken});
  CHECK(window.ack().received == 0);
}

TEST_CASE_FIXTURE(StagedWindow, "a window onto memory that may not be written stays closed and says why") {
  const auto image = noise_image(1000);
  window.open({5, 0x900000, 1000});
  CHECK(window.ack().error == UnitError::address_unknown);
  CHECK_FALSE(window.take(block_of({5, 0x900000, 1000}, 0, image)));
  model.mode = UnitMode::compensating;
  window.open({6, kBankA.first, 1000, kStagingToken});
  CHECK(window.ack().error == UnitError::not_in_integration_mode);
  model.mode = UnitMode::integration;
  window.open({7, kBankA.first, kWindowBytes + 1, kStagingToken});
  CHECK(window.ack().error == UnitError::bad_argument);
}

TEST_CASE_FIXTURE(StagedWindow,
                  "the third wrong check of a block closes the window, and what came before stays in memory") {
  const auto image = noise_image(1000);
  const WindowOpen open{5, kBankA.first, 1000, kStagingToken};
  window.open(open);
  auto wrong = block_of(open, 1, image);
  wrong[2] ^= 1;
  CHECK_FALSE(window.take(wrong));
  CHECK(window.take(block_of(open, 0, image)));
  CHECK_FALSE(window.take(wrong));
  CHECK(window.ack().error == UnitError::none);
  CHECK_FALSE(window.take(wrong));
  CHECK(window.ack().error == UnitError::check_mismatch);
  CHECK(window.ack().received == 0);
  CHECK_FALSE(window.take(block_of(open, 1, image)));
  window.open(open);  // the same window again changes nothing
  CHECK(window.ack().error == UnitError::check_mismatch);
  const WindowOpen next{6, kBankA.first, 1000, kStagingToken};
  window.open(next);
  CHECK(window.take(block_of(next, 1, image)));
  CHECK(std::equal(image.begin(), image.begin() + 2 * kBlockBytes, model.bank_a.begin()));
}

TEST_CASE("only the connection that opened a window fills it, and a host that connects again goes on where it was") {
  UnitModel model;
  RegisterServer server(model);
  server.arrives_on(1);
  RegisterHost host(server);
  const auto token = host.give({.code = CommandCode::begin_staging}).token;
  const auto image = noise_image(1000);
  const WindowOpen open{5, kBankA.first, 1000, token, false, host.session()};
  const auto opened = [&](std::uint64_t connection) {
    server.arrives_on(connection);
    REQUIRE(server.write(kWindowOpen.first, registers_of(open, 1)).has_value());
    return value_in<WindowAck>(server.read(kWindowAck.first, kWindowAck.count).value()).value();
  };
  const auto taken = [&](std::uint64_t connection, std::uint16_t number) {
    server.arrives_on(connection);
    return server.write(kBlockWrite.first, block_of(open, number, image)).has_value();
  };
  CHECK(opened(1).error == UnitError::none);
  CHECK(taken(1, 0));
  CHECK_FALSE(taken(2, 1));  // its check is right: somebody has found it
  server.arrives_on(2);
  for (std::uint16_t check = 0; check < 100; ++check) {
    auto guessed = block_of(open, 1, image);
    guessed[2] = check;
    CHECK_FALSE(server.write(kBlockWrite.first, guessed).has_value());
  }
  CHECK(taken(1, 1));  // what came elsewhere closes nothing
  const WindowAck again = opened(3);
  CHECK(again.error == UnitError::none);
  CHECK(again.received == 0b11);
  CHECK_FALSE(taken(1, 2));
  CHECK(taken(3, 2));
}

TEST_CASE("axis memory takes a block only under the token of the staging that goes on") {
  UnitModel model;
  MemoryWindow window(model);
  const auto image = noise_image(1000);
  window.open({5, kBankA.first, 1000, kStagingToken});
  CHECK(window.ack().error == UnitError::token_expired);
  window.stage_under(kStagingToken);
  const WindowOpen open{6, kBankA.first, 1000, kStagingToken};
  window.open(open);
  CHECK(window.take(block_of(open, 0, image)));
  CHECK_FALSE(window.take(block_of({6, kBankA.first, 1000, kStagingToken + 1}, 1, image)));
  window.stage_under(kStagingToken + 1);
  CHECK_FALSE(window.take(block_of(open, 1, image)));
  CHECK(window.ack().error == UnitError::token_expired);
  CHECK(window.ack().received == 0);
  window.open({7, kBankA.first, 1000, 0});
  CHECK(window.ack().error == UnitError::token_expired);
}

TEST_CASE("a staging ends with the next one, with its commit and when it is abandoned, and with it its token") {
  UnitModel model;
  RegisterServer server(model);
  RegisterHost host(server);
  const std::uint32_t first = host.give({.code = CommandCode::begin_staging}).token;
  const std::uint32_t second = host.give({.code = CommandCode::begin_staging}).token;
  CHECK(first != 0);
  CHECK(second != 0);
  CHECK(first != second);
  for (const CommandCode code : {CommandCode::commit_staged, CommandCode::abandon_staged}) {
    CHECK(host.give({.code = code, .length = 4, .token = first}).error == UnitError::token_expired);
    CHECK(host.give({.code = code, .length = 4}).error == UnitError::token_expired);
  }
  CHECK(model.log == std::vector{CommandCode::begin_staging, CommandCode::begin_staging});
  CHECK(host.give({.code = CommandCode::commit_staged, .length = 4, .token = second}).error ==
        UnitError::check_mismatch);
  CHECK(host.give({.code = CommandCode::abandon_staged, .token = second}).state == CommandState::done);
  CHECK(host.give({.code = CommandCode::commit_staged, .token = second}).error == UnitError::no_staging);
}

TEST_CASE("a window belongs to a session that the unit knows") {
  UnitModel model;
  RegisterServer server(model);
  RegisterHost host(server);
  const auto token = host.give({.code = CommandCode::begin_staging}).token;
  const auto error_of = [&](std::uint32_t session) {
    const WindowOpen open{5, kBankA.first, 1000, token, false, session};
    REQUIRE(server.write(kWindowOpen.first, registers_of(open, 1)).has_value());
    return value_in<WindowAck>(server.read(kWindowAck.first, kWindowAck.count).value()).value().error;
  };
  CHECK(error_of(host.session()) == UnitError::none);
  CHECK(error_of(host.session() + 1) == UnitError::session_unknown);
  CHECK(error_of(0) == UnitError::session_unknown);
}

namespace {

/// A frame of a coded window as the host makes it.
Registers coded_frame(const WindowOpen& window, std::uint16_t number, const std::vector<std::uint8_t>& code) {
  const auto payload = packed(code);
  Registers registers{window.tag, number, block_check(window, number, unpacked(payload, 2 * payload.size()))};
  registers.insert(registers.end(), payload.begin(), payload.end());
  return registers;
}

std::vector<std::uint8_t> smooth_image() {
  std::vector<std::uint8_t> image(1000);
  for (std::size_t i = 0; i < image.size(); i += 2) store_big(image, i, static_cast<std::uint16_t>(3 * i));
  return image;
}

}  // namespace

TEST_CASE("coded frames give the memory that was sent, in their order only") {
  const auto image = smooth_image();
  UnitModel model;
  MemoryWindow window(model);
  window.stage_under(kStagingToken);
  const WindowOpen open{5, kBankA.first, 1000, kStagingToken, true};
  window.open(open);
  BitWriter first = coded_block(image, 0, 120);
  first.append(coded_block(image, 120, 240));
  BitWriter rest;
  for (std::size_t at = 240; at < 1000; at += 120)
    rest.append(coded_block(image, at, std::min<std::size_t>(at + 120, 1000)));
  const Registers second = coded_frame(open, 2 | 6 << 8, rest.bytes());
  CHECK_FALSE(window.take(second));  // what it is decoded after is not there
  CHECK(window.ack().received == 0);
  CHECK(window.take(coded_frame(open, 0 | 1 << 8, first.bytes())));
  CHECK(window.ack().received == 0b11);
  CHECK(window.take(second));
  CHECK(window.take(second));
  CHECK(window.ack().crc == crc32_of(image));
  CHECK(std::equal(image.begin(), image.end(), model.bank_a.begin()));
}

TEST_CASE("a coded frame that makes no sense is refused without a write") {
  const auto image = smooth_image();
  UnitModel model;
  MemoryWindow window(model);
  window.stage_under(kStagingToken);
  const WindowOpen open{5, kBankA.first, 240, kStagingToken, true};
  window.open(open);
  const auto code = coded_block(image, 0, 120).bytes();
  CHECK_FALSE(window.take(coded_frame(open, 0 | 1 << 8, code)));   // two blocks announced, one there
  CHECK_FALSE(window.take(coded_frame(open, 2, code)));            // beyond the window
  CHECK_FALSE(window.take(coded_frame(open, 0 | 16 << 8, code)));  // more blocks than a frame may bring
  CHECK_FALSE(window.take(coded_frame(open, 0, {0xFF, 0xFF, 0xFF, 0xFF})));
  CHECK_FALSE(window.take(coded_frame(open, 0, {})));
  auto flipped = coded_frame(open, 0, code);
  flipped[4] ^= 1;
  CHECK_FALSE(window.take(flipped));
  CHECK(std::all_of(model.bank_a.begin(), model.bank_a.end(), [](auto byte) { return byte == 0; }));
  CHECK(window.take(coded_frame(open, 0, code)));
}

TEST_CASE_FIXTURE(StagedWindow, "a coded window lies in axis memory and holds at most 64 short blocks") {
  window.open({5, kBankA.first, 64 * 120 + 1, kStagingToken, true});
  CHECK(window.ack().error == UnitError::bad_argument);
  window.open({6, kSystemRam.first, 120, 0, true});
  CHECK(window.ack().error == UnitError::bad_argument);
  window.open({7, kBankB.first, 64 * 120, kStagingToken, true});
  CHECK(window.ack().error == UnitError::none);
}
