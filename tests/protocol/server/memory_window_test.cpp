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
const std::optional<Secret> kKey = Secret{1, 2, 3};

struct StagedWindow {
  StagedWindow() { window.stage_under(kStagingToken); }
  UnitModel model;
  MemoryWindow window{model};
};

Registers block_of(const WindowOpen& window, std::uint16_t number, const std::vector<std::uint8_t>& image,
                   const std::optional<Secret>& key = kKey) {
  const auto part = std::span(image).subspan(number * kBlockBytes, bytes_in_block(window.length, number));
  return block_registers(key, window, number, part);
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
      RC_ASSERT(window.take(block_of(open, n, image), kKey));
    }
    RC_ASSERT(window.ack().crc == crc32_of(image));
    RC_ASSERT(std::equal(image.begin(), image.end(), model.bank_a.begin() + 100));
    RC_ASSERT(model.bank_a[99] == 0);
    RC_ASSERT(std::all_of(model.bank_a.begin() + 100 + length, model.bank_a.end(), [](auto b) { return b == 0; }));
  }));
}

TEST_CASE_FIXTURE(StagedWindow, "a block that is not intact, of another window or beyond its end is not taken") {
  const auto image = noise_image(1000);
  WindowOpen open{5, kBankA.first, 1000, kStagingToken};
  window.open(open);
  CHECK_FALSE(window.take(block_of({6, kBankA.first, 1000, kStagingToken}, 0, image), kKey));
  auto cut = block_of(open, 0, image);
  cut.pop_back();
  CHECK_FALSE(window.take(cut, kKey));
  CHECK_FALSE(window.take(block_registers(kKey, open, 5, {}), kKey));
  CHECK(window.ack().error == UnitError::none);
  const auto closes = [&](const Registers& block) {
    ++open.number;
    window.open(open);
    CHECK_FALSE(window.take(block, kKey));
  };
  const auto next = [&](WindowOpen of) {
    ++of.number;
    return of;
  };
  auto flipped = block_of(next(open), 0, image);
  flipped[50] ^= 0x0100;
  closes(flipped);
  auto moved = block_of(next(open), 0, image);
  moved[1] = 1;
  closes(moved);
  closes(block_of(next(open), 0, image, Secret{}));
  CHECK(window.ack().error == UnitError::check_mismatch);
  CHECK(window.ack().received == 0);
  CHECK(std::all_of(model.bank_a.begin(), model.bank_a.end(), [](auto b) { return b == 0; }));
}

TEST_CASE_FIXTURE(StagedWindow, "the same number again keeps what has arrived, a new one starts afresh") {
  const auto image = noise_image(1000);
  const WindowOpen open{5, kBankA.first, 1000, kStagingToken};
  window.open(open);
  CHECK(window.take(block_of(open, 2, image), kKey));
  window.open(open);
  CHECK(window.ack().received == 0b100);
  window.open({6, kBankA.first, 1000, kStagingToken});
  CHECK(window.ack().received == 0);
}

TEST_CASE_FIXTURE(StagedWindow, "a window onto memory that may not be written stays closed and says why") {
  const auto image = noise_image(1000);
  window.open({5, 0x900000, 1000});
  CHECK(window.ack().error == UnitError::address_unknown);
  CHECK_FALSE(window.take(block_of({5, 0x900000, 1000}, 0, image), kKey));
  model.mode = UnitMode::compensating;
  window.open({6, kBankA.first, 1000, kStagingToken});
  CHECK(window.ack().error == UnitError::not_in_integration_mode);
  model.mode = UnitMode::integration;
  window.open({7, kBankA.first, kWindowBytes + 1, kStagingToken});
  CHECK(window.ack().error == UnitError::bad_argument);
}

TEST_CASE_FIXTURE(StagedWindow, "a wrong check of a block closes the window, and what came before stays in memory") {
  const auto image = noise_image(1000);
  const WindowOpen open{5, kBankA.first, 1000, kStagingToken};
  window.open(open);
  CHECK(window.take(block_of(open, 0, image), kKey));
  auto wrong = block_of(open, 1, image);
  wrong[2] ^= 1;
  CHECK_FALSE(window.take(wrong, kKey));
  CHECK(window.ack().error == UnitError::check_mismatch);
  CHECK(window.ack().received == 0);
  CHECK_FALSE(window.take(block_of(open, 1, image), kKey));
  window.open(open);  // the same window again changes nothing
  CHECK(window.ack().error == UnitError::check_mismatch);
  const WindowOpen next{6, kBankA.first, 1000, kStagingToken};
  window.open(next);
  CHECK(window.take(block_of(next, 1, image), kKey));
  CHECK(std::equal(image.begin(), image.begin() + 2 * kBlockBytes, model.bank_a.begin()));
}

TEST_CASE("only the connection that opened a window fills it, and a host that connects again goes on where it was") {
  UnitModel model;
  RegisterServer server(model);
  server.arrives_on(1, "");
  RegisterHost host(server);
  const auto token = host.give({.code = CommandCode::begin_staging}).token;
  const auto image = noise_image(1000);
  const WindowOpen open{5, kBankA.first, 1000, token, false, {host.session(), 1}};
  const auto opened = [&](std::uint64_t connection) {
    server.arrives_on(connection, "");
    return host.open(open);
  };
  const auto taken = [&](std::uint64_t connection, std::uint16_t number) {
    server.arrives_on(connection, "");
    return server.write(kBlockWrite.first, block_of(open, number, image, host.key())).has_value();
  };
  CHECK(opened(1).error == UnitError::none);
  CHECK(taken(1, 0));
  CHECK_FALSE(taken(2, 1));
  server.arrives_on(2, "");
  for (std::uint16_t check = 0; check < 100; ++check) {
    auto guessed = block_of(open, 1, image, host.key());
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
  CHECK(window.take(block_of(open, 0, image), kKey));
  window.stage_under(kStagingToken + 1);
  CHECK_FALSE(window.take(block_of(open, 1, image), kKey));
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

TEST_CASE("a window belongs to a session that the unit knows, and its numbers rise") {
  UnitModel model;
  RegisterServer server(model);
  RegisterHost host(server);
  const auto token = host.give({.code = CommandCode::begin_staging}).token;
  const auto error_of = [&](std::uint32_t session, std::uint32_t number) {
    return host.open({number, kBankA.first, 1000, token, false, {session, 1}}).error;
  };
  CHECK(error_of(host.session(), 5) == UnitError::none);
  CHECK(error_of(host.session() + 1, 6) == UnitError::session_unknown);
  CHECK(error_of(0, 6) == UnitError::session_unknown);
  CHECK(error_of(host.session(), 5) == UnitError::none);  // the one that is open
  CHECK(error_of(host.session(), 6) == UnitError::none);
  CHECK(error_of(host.session(), 5) == UnitError::token_expired);
}

namespace {

Registers coded_frame(const WindowOpen& window, std::uint16_t number, const std::vector<std::uint8_t>& code) {
  return block_registers(kKey, window, number, code);
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
  CHECK_FALSE(window.take(second, kKey));  // what it is decoded after is not there
  CHECK(window.ack().received == 0);
  CHECK(window.take(coded_frame(open, 0 | 1 << 8, first.bytes()), kKey));
  CHECK(window.ack().received == 0b11);
  CHECK(window.take(second, kKey));
  CHECK(window.take(second, kKey));
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
  CHECK_FALSE(window.take(coded_frame(open, 0 | 1 << 8, code), kKey));   // two blocks announced, one there
  CHECK_FALSE(window.take(coded_frame(open, 2, code), kKey));            // beyond the window
  CHECK_FALSE(window.take(coded_frame(open, 0 | 16 << 8, code), kKey));  // more blocks than a frame may bring
  CHECK_FALSE(window.take(coded_frame(open, 0, {0xFF, 0xFF, 0xFF, 0xFF}), kKey));
  CHECK_FALSE(window.take(coded_frame(open, 0, {}), kKey));
  CHECK(std::all_of(model.bank_a.begin(), model.bank_a.end(), [](auto byte) { return byte == 0; }));
  CHECK(window.take(coded_frame(open, 0, code), kKey));
}

TEST_CASE_FIXTURE(StagedWindow, "a coded window lies in axis memory and holds at most 64 short blocks") {
  window.open({5, kBankA.first, 64 * 120 + 1, kStagingToken, true});
  CHECK(window.ack().error == UnitError::bad_argument);
  window.open({6, kSystemRam.first, 120, 0, true});
  CHECK(window.ack().error == UnitError::bad_argument);
  window.open({7, kBankB.first, 64 * 120, kStagingToken, true});
  CHECK(window.ack().error == UnitError::none);
}
