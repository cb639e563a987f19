#include "tests/world/forger.hpp"

#include <algorithm>

#include "base/random.hpp"
#include "protocol/registers/unit_registers.hpp"

namespace ecs::world {
namespace {

using namespace std::chrono_literals;
using protocol::Block;
using protocol::Command;
using protocol::CommandCode;
using protocol::Registers;

constexpr std::uint8_t kWriteMany = 16, kWriteAndRead = 23;
constexpr std::size_t kRemembered = 200;
constexpr std::size_t kValuesAt = 10;  ///< of function 23
constexpr std::size_t kSessionsAtOnce = 20;

void put(Bytes& bytes, std::uint16_t word) {
  bytes.push_back(static_cast<std::uint8_t>(word >> 8));
  bytes.push_back(static_cast<std::uint8_t>(word & 0xFF));
}

std::uint16_t first_written(const Bytes& pdu) {
  const std::size_t at = pdu[0] == kWriteAndRead ? 5 : 1;
  return pdu.size() < at + 2 ? 0 : static_cast<std::uint16_t>(pdu[at] << 8 | pdu[at + 1]);
}

/// Without its echo: the same question again.
Bytes question_of(Bytes pdu) {
  if (pdu[0] == kWriteAndRead && pdu.size() >= kValuesAt + 2) pdu[kValuesAt] = pdu[kValuesAt + 1] = 0;
  return pdu;
}

Bytes with_echo_of(const Bytes& request, Bytes reply) {
  if (request[0] != kWriteAndRead || request.size() < kValuesAt + 2 || reply.size() < 4) return reply;
  reply[2] = request[kValuesAt];
  reply[3] = request[kValuesAt + 1];
  return reply;
}

}  // namespace

Forger::Forger(Schedule& schedule, Random& random, Line& line)
    : schedule_(schedule), random_(random), line_(line), number_(line.join(nullptr)) {
  const auto maybe = [&] { return chance(random_, 0.5); };
  hears_ = line.shared() || maybe();
  replays_ = hears_ && maybe();
  changes_ = hears_ && maybe();
  answers_ = hears_ && maybe();
  impersonates_ = hears_ && chance(random_, 0.2);
  guesses_ = chance(random_, 0.3);
  speaks_in_others_place_ = hears_ && maybe();
  often_ = std::array{0.01, 0.05, 0.3}[draw(3)];
  schedule_.after(draw(0ms, 500ms), [this] { act(); });
}

std::uint32_t Forger::draw(std::uint32_t count) { return one_of(random_, count); }
Span Forger::draw(Span from, Span to) {
  return from + Span(static_cast<Span::rep>(uniform(random_) * static_cast<double>((to - from).count())));
}

void Forger::send(const Bytes& pdu, int as, Span later) {
  schedule_.after(later, [this, frame = Line::framed(pdu), as] {
    if (!silent_) line_.send(number_, frame, speaks_in_others_place_ ? as : number_);
  });
}

void Forger::send_block(const Block& block, const Registers& values, const Block& answer, int as, Span later) {
  Bytes pdu{kWriteAndRead};
  for (const std::uint16_t word : {answer.first, answer.count, block.first, static_cast<std::uint16_t>(values.size())})
    put(pdu, word);
  pdu.push_back(static_cast<std::uint8_t>(2 * values.size()));
  for (const std::uint16_t word : values) put(pdu, word);
  send(pdu, as, later);
}

void Forger::hear(int from, int to, const Bytes& frame) {
  if (silent_) return;
  const Bytes pdu = Line::unframed(frame);
  if (pdu.size() < 2 || from == number_ || (!hears_ && to != number_)) return;
  if (from == kUnitEnd) return on_reply(to, pdu);
  asked_[from] = pdu;
  requests_.push_back({from, pdu});
  if (requests_.size() > kRemembered) requests_.pop_front();
  on_request(requests_.back());
}

void Forger::on_reply(int to, const Bytes& pdu) {
  constexpr std::size_t kReplyOfSession = 2 + 2 * protocol::kSession.count;
  if (pdu.size() == kReplyOfSession) {
    const std::uint32_t session = static_cast<std::uint32_t>(pdu[8] << 24 | pdu[9] << 16 | pdu[10] << 8 | pdu[11]);
    (to == number_ ? own_session_ : other_session_) = session;
  }
  const auto asked = asked_.find(to);
  if (asked != asked_.end() && (pdu[0] & 0x80U) == 0) replies_[question_of(asked->second)] = pdu;
}

/// A question heard before, or at least one of its form, has the answer of then, with the echo of now.
Bytes Forger::answer_to(const Bytes& request) {
  if (request[0] == kWriteMany) return {request.begin(), request.begin() + 5};
  auto known = replies_.find(question_of(request));
  if (known == replies_.end())
    known = std::find_if(replies_.begin(), replies_.end(), [&](const auto& reply) {
      return reply.first.size() == request.size() &&
             std::equal(request.begin(), request.begin() + 9, reply.first.begin());
    });
  if (known == replies_.end()) return {};
  Bytes reply = with_echo_of(request, known->second);
  if (chance(random_, 0.3) && reply.size() > 4)
    reply[4 + draw(static_cast<std::uint32_t>(reply.size() - 4))] ^= static_cast<std::uint8_t>(1U << draw(8));
  return reply;
}

Bytes Forger::changed(Bytes pdu) {
  const std::uint16_t first = first_written(pdu);
  if (first == protocol::kCommand.first && pdu.size() >= kValuesAt + 2 * protocol::kCommand.count) {
    constexpr std::size_t kSequenceAt = kValuesAt + 2 * 6 + 1, kCodeAt = kValuesAt + 2 * 7 + 1;
    pdu[kSequenceAt] = static_cast<std::uint8_t>(pdu[kSequenceAt] + 1);
    if (chance(random_, 0.5)) pdu[kCodeAt] = static_cast<std::uint8_t>(1 + draw(17));
  }
  const std::size_t from = pdu[0] == kWriteAndRead ? kValuesAt + 2 : 6;
  for (std::uint32_t left = draw(3); left > 0 && pdu.size() > from; --left)
    pdu[from + draw(static_cast<std::uint32_t>(pdu.size() - from))] ^= static_cast<std::uint8_t>(1U << draw(8));
  return pdu;
}

void Forger::answer(int to, const Bytes& reply) {
  schedule_.after(draw(0ms, 60ms), [this, to, frame = Line::framed(reply)] {
    if (!silent_) line_.send_to_host(to, frame);
  });
}

void Forger::on_request(const Request& request) {
  if (impersonates_ && replies_.count(question_of(request.pdu)) > 0) {
    if (chance(random_, 0.02)) impersonates_ = false;
    line_.withhold_reply_to(request.from);
    return answer(request.from, with_echo_of(request.pdu, replies_[question_of(request.pdu)]));
  }
  if (!chance(random_, often_)) return;
  switch (draw(3)) {
    case 0:
      if (!replays_) return;
      send(chance(random_, 0.5) ? request.pdu : requests_[draw(static_cast<std::uint32_t>(requests_.size()))].pdu,
           request.from, chance(random_, 0.5) ? draw(1ms, 100ms) : draw(1ms, 5s));
      return;
    case 1:
      if (changes_) send(changed(request.pdu), request.from, draw(1ms, 100ms));
      return;
    default:
      if (!answers_) return;
      if (const Bytes reply = answer_to(request.pdu); !reply.empty()) {
        if (chance(random_, 0.7)) line_.withhold_reply_to(request.from);
        answer(request.from, reply);
      }
      return;
  }
}

void Forger::open_session(std::uint16_t version, Span later) {
  protocol::SessionOpen open;
  open.protocol_version = version;
  open.key = random_();
  open.number = static_cast<std::uint32_t>(random_());
  open.host = "forger";
  send_block(protocol::kSessionOpen, registers_of(open, static_cast<std::uint16_t>(random_())), protocol::kSession,
             number_, later);
}

void Forger::open_sessions() {
  for (std::size_t i = 0; i < kSessionsAtOnce; ++i)
    open_session(protocol::kProtocolVersion, static_cast<int>(i) * Span(15ms));
}

/// A code by chance, in its own session or in that of a host.
void Forger::guess() {
  const std::uint32_t session = own_session_ == 0 || chance(random_, 0.3) ? other_session_ : own_session_;
  if (session == 0) return;
  const auto terms = protocol::exchange_terms(std::to_string(draw(1'000'000)), "EMULATOR-1", session, 30);
  const auto echo = static_cast<std::uint16_t>(random_());
  send_block(protocol::kArmShare, registers_of(protocol::ArmShare{session, 30, half_exchange(terms).share}, echo),
             protocol::kArmAnswer, number_);
  protocol::ArmConfirm confirm{session, {}};
  for (auto& byte : confirm.confirmation) byte = static_cast<std::uint8_t>(random_());
  send_block(protocol::kArmConfirm, registers_of(confirm, echo), protocol::kArmAnswer, number_, 40ms);
}

/// With the check of everybody: what switches off is carried out, anything else is not.
void Forger::give_command() {
  Command command;
  command.code = static_cast<CommandCode>(1 + draw(protocol::kCommandCount - 1));
  if (chance(random_, 0.3)) command.code = CommandCode::output_off;
  command.output_um = 50.0;
  command.relay_on = true;
  command.length = 1000;
  command.tool = 1;
  command.asker = {std::array{std::uint32_t{0}, own_session_, other_session_}[draw(3)], 7};
  command.sequence = 1 + draw(200);
  command.clock_ms = static_cast<std::uint32_t>(
      std::chrono::duration_cast<std::chrono::milliseconds>(schedule_.now().time_since_epoch() - 1h).count());
  send_block(protocol::kCommand,
             protocol::sealed(registers_of(command, static_cast<std::uint16_t>(random_())), protocol::Keyed::command,
                              std::nullopt),
             protocol::kCommandResult, number_);
}

/// What it does without having heard anything.
void Forger::act() {
  if (silent_) return;
  switch (draw(6)) {
    case 0:
      open_session(protocol::kProtocolVersion);
      break;
    case 1:
      open_session(2);
      break;
    case 2: {  // blocks of protocol 2, and of nobody
      Bytes pdu{kWriteMany, 0, static_cast<std::uint8_t>(protocol::kBlockWrite.first), 0, 8, 16};
      for (int i = 0; i < 16; ++i) pdu.push_back(static_cast<std::uint8_t>(random_()));
      send(pdu, number_);
      break;
    }
    case 3:
      if (guesses_) guess();
      break;
    case 4:
      give_command();
      break;
    default:
      if (chance(random_, 0.05)) open_sessions();
      break;
  }
  schedule_.after(draw(20ms, 2s), [this] { act(); });
}

}  // namespace ecs::world
