// libFuzzer over the unit's end of the link: frames and registers of all kinds, sound and not, from a host that is
// armed or not. Nothing of what is not armed reaches memory or machine, every answer block can be read, no frame is too
// long.
#include <algorithm>

#include "protocol/line/frame_codec.hpp"
#include "protocol/registers/unit_registers.hpp"
#include "tests/fuzz/fuzzed_bytes.hpp"
#include "tests/support/unit_model.hpp"

namespace {

using namespace ecs;
using namespace ecs::protocol;
using fuzz::check;
using fuzz::FuzzedBytes;

constexpr std::size_t kLongestFrame = 260;  // Modbus TCP
const std::string kCode = "271828";

struct Bench {
  UnitModel model;
  RegisterServer server;
  RegisterHost host;
  std::uint32_t token = 0;
  WindowOpen window;
  explicit Bench(bool needs_code) : server(model, {needs_code ? kCode : std::string(), true}), host(server) {}
};

FrameCodec& codec(Framing framing) {
  static FrameCodec rtu = FrameCodec::make(Framing::rtu, 1).value();
  static FrameCodec tcp = FrameCodec::make(Framing::tcp, 1).value();
  return framing == Framing::rtu ? rtu : tcp;
}

void send_rtu(Bench& bench, std::vector<std::uint8_t> frame, bool sealed) {
  if (sealed) {
    const std::uint16_t crc = crc16_of(frame);
    frame.push_back(static_cast<std::uint8_t>(crc & 0xFF));
    frame.push_back(static_cast<std::uint8_t>(crc >> 8));
  }
  check(codec(Framing::rtu).answer(frame, bench.server).size() <= kLongestFrame);
}

void send_tcp(Bench& bench, const std::vector<std::uint8_t>& pdu, bool sealed) {
  std::vector<std::uint8_t> frame{0, 1, 0, 0, 0, static_cast<std::uint8_t>(pdu.size() + 1), 1};
  if (!sealed) frame.clear();
  frame.insert(frame.end(), pdu.begin(), pdu.end());
  const TcpCut cut = tcp_request_length(frame);
  check(cut.broken || cut.length <= kLongestFrame);
  if (!cut.broken && cut.length > 0 && cut.length <= frame.size())
    check(codec(Framing::tcp).answer(std::span(frame).first(cut.length), bench.server).size() <= kLongestFrame);
}

Command command_in(FuzzedBytes& input) {
  Command command;
  command.code = static_cast<CommandCode>(input.byte() % (kCommandCount + 1));
  command.axis = static_cast<Axis>(input.byte() % 3);
  command.output_um = input.byte();
  command.relay_on = (input.byte() & 1) != 0;
  command.staging_from = static_cast<StagingFrom>(input.byte() % 3);
  command.address = input.number();
  command.length = input.number();
  return command;
}

void give(Bench& bench, FuzzedBytes& input) {
  Command command = command_in(input);
  command.token = (input.byte() & 1) != 0 ? bench.token : input.number();
  if ((input.byte() & 0x0F) == 0) (void)bench.host.arm("wrong");
  if (command.code == CommandCode::commit_staged && (input.byte() & 1) != 0) {
    command.length %= UnitModel::kSize;
    const auto& spare = bench.model.active == Bank::A ? bench.model.bank_b : bench.model.bank_a;
    command.digest = short_digest(digest_of(std::span(spare).first(command.length)));
  }
  const CommandResult result = bench.host.give(command);
  if (command.code == CommandCode::begin_staging && result.state == CommandState::done) bench.token = result.token;
}

void open_window(Bench& bench, FuzzedBytes& input) {
  const std::uint32_t number = bench.window.number + input.byte() % 3;
  const Address address = (input.byte() & 1) != 0 ? kBankA.first + input.word() : input.number();
  bench.window = {
      number, address, input.word() % 16'000u, bench.token, (input.byte() & 1) != 0, {bench.host.session(), 1}};
  if ((input.byte() & 7) == 0) bench.window.token = input.number();
  (void)bench.host.open(bench.window);
}

void send_block(Bench& bench, FuzzedBytes& input) {
  const std::uint16_t number = input.word();
  const auto payload = input.bytes(input.byte() % (kBlockBytes + 1));
  const auto key = (input.byte() & 3) == 0 ? std::nullopt : bench.host.key();
  const Registers block = block_registers(key, bench.window, number, payload);
  (void)bench.server.write(kBlockWrite.first, block);
}

void step(Bench& bench, FuzzedBytes& input) {
  const std::uint8_t kind = input.byte();
  const bool sealed = (kind & 0x10) != 0;
  switch (kind & 7) {
    case 0:
      return send_rtu(bench, input.bytes(input.byte()), sealed);
    case 1:
      return send_tcp(bench, input.bytes(input.byte()), sealed);
    case 2:
      return give(bench, input);
    case 3:
      return open_window(bench, input);
    case 4:
      return send_block(bench, input);
    case 5: {
      const std::uint16_t first = input.word() % kRegisterSpace;
      (void)bench.server.write(first, input.words(1 + input.byte() % kMostWrite));
      return;
    }
    case 6: {
      const std::uint16_t first = input.word() % kRegisterSpace;
      const std::uint16_t count = 1 + input.byte() % kMostRead;
      const auto read = bench.server.read(first, count);
      check(!read || read->size() == count);
      return;
    }
    default:
      bench.model.unit_clock.ms += input.number();
      bench.model.unit_clock.starts += (kind & 0x60) == 0 ? 1 : 0;
  }
}

bool stops_only(const std::vector<CommandCode>& log) {
  return std::all_of(log.begin(), log.end(), [](CommandCode code) {
    return switches_off(code) || code == CommandCode::abandon_staged || !needs_arming(code);
  });
}

}  // namespace

/// The first byte says whether the unit shows a code that the host does not know.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzedBytes input(data, size);
  const bool needs_code = (input.byte() & 1) != 0;
  Bench bench(needs_code);
  std::fill(bench.model.bank_a.begin(), bench.model.bank_a.end(), std::uint8_t{0x5A});
  bench.model.active = Bank::A;
  bench.model.image_length = 1000;
  const auto a = bench.model.bank_a, b = bench.model.bank_b;
  while (input.any()) step(bench, input);
  for (const Block& block : {kIdentity, kStatus, kMonitor, kPointers, kCommandResult, kWindowAck, kSession, kEvents,
                             kActiveMap, kArmAnswer}) {
    const auto read = bench.server.read(block.first, block.count);
    check(read && read->size() == block.count);
  }
  if (!needs_code) return 0;
  check(stops_only(bench.model.log));
  check(bench.model.commits == 0 && bench.model.bank_a == a && bench.model.bank_b == b);
  return 0;
}
