// Frames byte by byte: the check, the worked example of the documentation, exceptions, nonsense.
#include <array>

#include <fmt/format.h>
#include <rapidcheck.h>

#include "base/file.hpp"
#include "protocol/line/frame_codec.hpp"
#include "protocol/registers/unit_registers.hpp"
#include "tests/support/test.hpp"
#include "tests/support/unit_model.hpp"

using namespace ecs;
using namespace ecs::protocol;
using FrameBytes = std::vector<std::uint8_t>;

namespace {

struct FrameUnit {
  UnitModel model;
  RegisterServer server{model};
};

std::string hex_of(const FrameBytes& bytes) {
  std::string text;
  for (const auto byte : bytes) text += fmt::format("{}{:02X}", text.empty() ? "" : " ", byte);
  return text;
}

void append_crc(FrameBytes& frame) {
  const auto crc = crc16_of(frame);
  frame.insert(frame.end(), {static_cast<std::uint8_t>(crc & 0xFF), static_cast<std::uint8_t>(crc >> 8)});
}

// The frames of docs/protocol.md; CRCs from pymodbus.utilities.computeCRC.
const FrameBytes kAskIdentity{0x01, 0x17, 0x01, 0x00, 0x00, 0x04, 0x00, 0x00, 0x00, 0x01, 0x02, 0x12, 0x34, 0x9D, 0x1A};
const FrameBytes kIdentityReply{0x01, 0x17, 0x08, 0x12, 0x34, 0x00, 0x03, 0x00, 0x02, 0x00, 0x07, 0x84, 0x83};

}  // namespace

TEST_CASE("the CRC-16 of 123456789 is the published 4B37") {
  const std::string digits = "123456789";
  const FrameBytes bytes(digits.begin(), digits.end());
  CHECK(crc16_of(bytes) == 0x4B37);
}

TEST_CASE_FIXTURE(FrameUnit, "the worked frame of the documentation is what the unit answers, byte for byte") {
  auto codec = FrameCodec::make(Framing::rtu, 1).value();
  CHECK(crc_agrees(kAskIdentity));
  CHECK(codec.answer(kAskIdentity, server) == kIdentityReply);
}

TEST_CASE("the documentation shows the worked frame and every block at its address") {
  const auto document = must(read_file("docs/protocol.md"));
  CHECK(contains(document, hex_of(kAskIdentity)));
  CHECK(contains(document, hex_of(kIdentityReply)));
  for (const Block& block :
       {kEcho,   kReadSelect, kCheckSelect, kWindowOpen, kCommand,   kResultSelect, kSessionOpen,   kEventSelect,
        kToken,  kBlockWrite, kIdentity,    kStatus,     kMonitor,   kPointers,     kCommandResult, kWindowAck,
        kMemory, kChecks,     kSession,     kEvents,     kActiveMap, kArmShare,     kArmConfirm,    kArmAnswer}) {
    const std::string row = fmt::format("| 0x{:04X} | {} |", block.first, block.count);
    CHECK_MESSAGE(contains(document, row), row);
  }
}

TEST_CASE_FIXTURE(FrameUnit, "a frame for another unit gets no reply on RTU and exception 11 on TCP") {
  auto rtu = FrameCodec::make(Framing::rtu, 2).value();
  CHECK(rtu.answer(kAskIdentity, server).empty());
  auto tcp = FrameCodec::make(Framing::tcp, 2).value();
  const FrameBytes request{0xAB, 0xCD, 0, 0, 0, 6, 9, 3, 1, 0, 0, 1};
  CHECK(tcp.answer(request, server) == FrameBytes{0xAB, 0xCD, 0, 0, 0, 3, 9, 0x83, 11});
}

TEST_CASE_FIXTURE(FrameUnit, "requests outside the map get Modbus exceptions, unknown functions exception 1") {
  auto codec = FrameCodec::make(Framing::tcp, 1).value();
  const auto exception_to = [&](FrameBytes pdu) {
    FrameBytes frame{0, 1, 0, 0, 0, static_cast<std::uint8_t>(pdu.size() + 1), 1};
    frame.insert(frame.end(), pdu.begin(), pdu.end());
    const auto reply = codec.answer(frame, server);
    return reply.size() == 9 && reply[7] == (pdu[0] | 0x80) ? reply[8] : 0;
  };
  CHECK(exception_to({3, 0x40, 0, 0, 1}) == 2);                           // far outside
  CHECK(exception_to({3, 0x01, 0x10, 0, 0x36}) == 2);                     // across the end of a block
  CHECK(exception_to({3, 0x01, 0x00, 0, 126}) == 3);                      // too many
  CHECK(exception_to({6, 0x01, 0x00, 0, 1}) == 2);                        // an answer block cannot be written
  CHECK(exception_to({16, 0x00, 0x80, 0, 3, 6, 0, 1, 0, 0, 0, 0}) == 3);  // a block without a window
  CHECK(exception_to({0x2B, 0x0E, 1, 0}) == 1);
  CHECK(exception_to({3, 0x01, 0x00, 0, 1}) == 0);
}

TEST_CASE_FIXTURE(FrameUnit, "every function but 3, 4, 6, 16, 22 and 23 gets exception 1, on RTU and on TCP") {
  auto tcp = FrameCodec::make(Framing::tcp, 1).value();
  auto rtu = FrameCodec::make(Framing::rtu, 1).value();
  for (int function = 0; function < 128; ++function) {
    const bool of_protocol =
        function == 3 || function == 4 || function == 6 || function == 16 || function == 22 || function == 23;
    if (of_protocol) continue;
    CAPTURE(function);
    const auto code = static_cast<std::uint8_t>(function);
    const auto refused = static_cast<std::uint8_t>(code | 0x80);
    CHECK(tcp.answer(FrameBytes{0, 1, 0, 0, 0, 6, 1, code, 0, 0, 0, 1}, server) ==
          FrameBytes{0, 1, 0, 0, 0, 3, 1, refused, 1});
    FrameBytes frame{1, code, 0, 0, 0, 1};
    append_crc(frame);
    const auto reply = rtu.answer(frame, server);
    REQUIRE(reply.size() == 5);
    CHECK(crc_agrees(reply));
    CHECK(FrameBytes(reply.begin(), reply.begin() + 3) == FrameBytes{1, refused, 1});
  }
}

TEST_CASE_FIXTURE(FrameUnit, "function 23 whose ranges overlap reads what the unit answers") {
  auto codec = FrameCodec::make(Framing::tcp, 1).value();
  // writes echo 5 at 0x0000 and reads 0x0000..1 in the same request
  const FrameBytes request{0, 1, 0, 0, 0, 13, 1, 23, 0, 0, 0, 2, 0, 0, 0, 1, 2, 0, 5};
  CHECK(codec.answer(request, server) == FrameBytes{0, 1, 0, 0, 0, 7, 1, 23, 4, 0, 5, 0, 0});
}

TEST_CASE_FIXTURE(FrameUnit, "no frame, however wrong, disturbs the next good one") {
  auto rtu = FrameCodec::make(Framing::rtu, 1).value();
  auto tcp = FrameCodec::make(Framing::tcp, 1).value();
  const FrameBytes good_tcp{0, 7, 0, 0, 0, 6, 1, 3, 1, 1, 0, 1};
  const FrameBytes good_tcp_reply{0, 7, 0, 0, 0, 5, 1, 3, 2, 0, 3};
  CHECK(rc::check([&] {
    auto pdu = *rc::gen::resize(240, rc::gen::arbitrary<FrameBytes>());
    const auto function = *rc::gen::element<std::uint8_t>(1, 3, 4, 6, 8, 15, 16, 17, 22, 23, 43, 65);
    pdu.insert(pdu.begin(), function);
    FrameBytes frame{1};
    frame.insert(frame.end(), pdu.begin(), pdu.end());
    append_crc(frame);
    const auto reply = rtu.answer(frame, server);
    RC_ASSERT(reply.empty() || crc_agrees(reply));
    RC_ASSERT(rtu.answer(kAskIdentity, server) == kIdentityReply);
    FrameBytes wrapped{0, 1, 0, 0, 0, static_cast<std::uint8_t>(pdu.size() + 1), 1};
    wrapped.insert(wrapped.end(), pdu.begin(), pdu.end());
    (void)tcp.answer(wrapped, server);
    RC_ASSERT(tcp.answer(good_tcp, server) == good_tcp_reply);
  }));
  CHECK(std::all_of(model.bank_a.begin(), model.bank_a.end(), [](auto byte) { return byte == 0; }));
}

TEST_CASE_FIXTURE(FrameUnit, "function 22 changes the bits of one register that its mask names") {
  auto codec = FrameCodec::make(Framing::tcp, 1).value();
  REQUIRE(server.write(kEcho.first, std::array<std::uint16_t, 1>{0x1234}).has_value());
  const FrameBytes masked{0, 9, 0, 0, 0, 8, 1, 22, 0, 0, 0xFF, 0xF0, 0xAA, 0xA5};
  CHECK(codec.answer(masked, server) == masked);
  CHECK(server.read(kEcho.first, 1).value() == Registers{0x1235});
  const FrameBytes nowhere{0, 9, 0, 0, 0, 8, 1, 22, 0xFF, 0, 0xFF, 0xF0, 0xAA, 0xA5};
  CHECK(codec.answer(nowhere, server) == FrameBytes{0, 9, 0, 0, 0, 3, 1, 0x80 | 22, 2});
}

TEST_CASE("the length of a request is known as soon as its header is") {
  CHECK_FALSE(rtu_request_length(FrameBytes{1}).has_value());
  CHECK(rtu_request_length(FrameBytes{1, 3}) == 8);
  CHECK(rtu_request_length(kAskIdentity) == kAskIdentity.size());
  CHECK_FALSE(rtu_request_length(FrameBytes{1, 16, 0, 0, 0, 1}).has_value());
  CHECK(rtu_request_length(FrameBytes{1, 16, 0, 0, 0, 1, 2}) == 11);
  CHECK_FALSE(rtu_request_length(FrameBytes{1, 0x41, 0, 0, 0, 0, 0, 0}).has_value());
  CHECK(rtu_request_length(FrameBytes{1, 17}) == 4);
  CHECK(rtu_request_length(FrameBytes{1, 22}) == 10);
  CHECK(tcp_request_length(FrameBytes{0, 1, 0, 0, 0, 6}).length == 12);
  CHECK(tcp_request_length(FrameBytes{0, 1, 0, 9, 0, 6}).broken);
  CHECK(tcp_request_length(FrameBytes{0, 1, 0, 0, 9, 6}).broken);
}

TEST_CASE_FIXTURE(FrameUnit, "a broadcast acts on nothing and gets no reply") {
  auto codec = FrameCodec::make(Framing::rtu, 1).value();
  RegisterHost host(server);
  const Registers words = host.sealed_registers(host.next({.code = CommandCode::begin_staging}));
  FrameBytes frame{0x00,
                   0x10,
                   0x00,
                   static_cast<std::uint8_t>(kCommand.first),
                   0x00,
                   static_cast<std::uint8_t>(words.size()),
                   static_cast<std::uint8_t>(2 * words.size())};
  for (const auto word : words) {
    frame.push_back(static_cast<std::uint8_t>(word >> 8));
    frame.push_back(static_cast<std::uint8_t>(word & 0xFF));
  }
  append_crc(frame);
  CHECK(codec.answer(frame, server).empty());
  CHECK(model.commands_begun == 0);
  frame[0] = 1;  // the same to this unit alone
  const auto own_crc = crc16_of(std::span(frame).first(frame.size() - 2));
  frame[frame.size() - 2] = static_cast<std::uint8_t>(own_crc & 0xFF);
  frame[frame.size() - 1] = static_cast<std::uint8_t>(own_crc >> 8);
  CHECK(!codec.answer(frame, server).empty());
  CHECK(model.commands_begun == 1);
}
