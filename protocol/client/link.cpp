// One request and its own reply: echo, retries, silence after errors, and the words for each failure.
#include "protocol/client/link.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <modbus.h>

#include "protocol/line/modbus_link.hpp"
#include "protocol/registers/keys.hpp"

namespace ecs::protocol {

namespace {

using Bytes = HostLine::Bytes;
using Clock = HostLine::Clock;

void put_word(Bytes& bytes, std::uint16_t word) {
  bytes.push_back(static_cast<std::uint8_t>(word >> 8));
  bytes.push_back(static_cast<std::uint8_t>(word & 0xFF));
}

void put_words(Bytes& bytes, std::span<const std::uint16_t> words) {
  for (const std::uint16_t word : words) put_word(bytes, word);
}

/// MODBUS Application Protocol V1.1b3, 6.17.
Bytes read_write_request(const Block& request, std::span<const std::uint16_t> values, const Block& answer) {
  Bytes pdu{MODBUS_FC_WRITE_AND_READ_REGISTERS};
  put_words(pdu, std::array{answer.first, answer.count, request.first, static_cast<std::uint16_t>(values.size())});
  pdu.push_back(static_cast<std::uint8_t>(2 * values.size()));
  put_words(pdu, values);
  return pdu;
}

/// MODBUS Application Protocol V1.1b3, 6.12.
Bytes write_request(std::uint16_t first, std::span<const std::uint16_t> values) {
  Bytes pdu{MODBUS_FC_WRITE_MULTIPLE_REGISTERS};
  put_words(pdu, std::array{first, static_cast<std::uint16_t>(values.size())});
  pdu.push_back(static_cast<std::uint8_t>(2 * values.size()));
  put_words(pdu, values);
  return pdu;
}

std::string_view exception_text(unsigned code) {
  switch (code) {
    case MODBUS_EXCEPTION_ILLEGAL_FUNCTION:
      return "it does not know this function; is it a unit of this kind?";
    case MODBUS_EXCEPTION_ILLEGAL_DATA_ADDRESS:
      return "it has no such registers or memory";
    case MODBUS_EXCEPTION_ILLEGAL_DATA_VALUE:
      return "it does not accept a value of the request";
    case MODBUS_EXCEPTION_SLAVE_OR_SERVER_FAILURE:
      return "it failed while carrying out the request";
    case MODBUS_EXCEPTION_SLAVE_OR_SERVER_BUSY:
      return "it is busy";
    case MODBUS_EXCEPTION_GATEWAY_PATH:
    case MODBUS_EXCEPTION_GATEWAY_TARGET:
      return "there is no unit with this number";
    default:
      return "an exception that this program does not know";
  }
}

/// A Modbus problem of one try; `exception` is its code where there is one.
struct Trouble {
  LinkFailure failure = LinkFailure::none;
  unsigned exception = 0;
  bool foreign = false;  ///< with `stale`: its echo is none that this link has sent lately
};

/// Echoes count up; a reply later than this many requests is no longer on its way.
constexpr std::uint16_t kLatestReply = 64;

/// Of the reply to this request, if it is no exception.
std::size_t reply_bytes(const Bytes& pdu) {
  if (pdu[0] == MODBUS_FC_WRITE_MULTIPLE_REGISTERS) return 5;
  return 2 + 2u * (static_cast<std::size_t>(pdu[3]) << 8 | pdu[4]);
}

std::uint16_t random_start() { return static_cast<std::uint16_t>(chance_64()); }

}  // namespace

struct Link::Connection {
  Connection(LinkAddress where, const LinkOptions& options)
      : address(std::move(where)),
        timing(options.timing.value_or(timing_of(address))),
        cancel_flag(options.cancelled),
        line(options.line ? options.line() : std::make_unique<ModbusLink>(address, timing)) {}

  LinkAddress address;
  LinkTiming timing;
  const std::atomic<bool>* cancel_flag;
  bool heeds_cancel = true;
  std::unique_ptr<HostLine> line;
  LinkStatistics statistics;
  LinkFailure failure = LinkFailure::none;
  std::uint16_t echo = random_start();
  bool late_replies_possible = false;  ///< since an error, until a reply with the right echo

  [[nodiscard]] bool cancelled() const {
    return heeds_cancel && cancel_flag != nullptr && cancel_flag->load(std::memory_order_relaxed);
  }
  /// What is done after a cancel, so that nothing stays half done, does not try as long as what was cancelled.
  [[nodiscard]] int tries() const {
    const bool hurried = !heeds_cancel && cancel_flag != nullptr && cancel_flag->load(std::memory_order_relaxed);
    return hurried ? std::min(timing.tries, 2) : timing.tries;
  }
  [[nodiscard]] std::string name() const { return to_text(address); }

  [[nodiscard]] tl::expected<Bytes, Trouble> transact(const Bytes& pdu);
  [[nodiscard]] tl::expected<Registers, Trouble> ask_once(const Block& request, const Registers& values,
                                                          const Block& answer);
  [[nodiscard]] Trouble recover(Trouble trouble);
  [[nodiscard]] tl::unexpected<Problem> fail(const Trouble& trouble, int tries);
  void count(const Trouble& trouble);
};

/// One request and its reply, taken for what it is: nothing here knows whether it is the reply to this request.
tl::expected<Bytes, Trouble> Link::Connection::transact(const Bytes& pdu) {
  const auto listening = [this] { return cancelled(); };
  if (cancelled()) return tl::unexpected(Trouble{LinkFailure::cancelled, 0});
  const auto start = line->now();
  const auto sent = line->send(pdu);
  if (!sent) return tl::unexpected(Trouble{sent.error(), 0});
  statistics.bytes_sent += *sent;
  auto reply = line->receive(reply_bytes(pdu), listening);
  if (!reply) return tl::unexpected(Trouble{reply.error(), 0});
  const double round_trip_ms = std::chrono::duration<double, std::milli>(line->now() - start).count();
  statistics.bytes_received += reply->size() + (address.is_serial() ? 3 : 7);
  ++statistics.replies;
  statistics.total_round_trip_ms += round_trip_ms;
  statistics.worst_round_trip_ms = std::max(statistics.worst_round_trip_ms, round_trip_ms);
  if (reply->size() == 2 && (*reply)[0] == (pdu[0] | 0x80u)) {
    if (late_replies_possible) return tl::unexpected(Trouble{LinkFailure::stale, 0});
    return tl::unexpected(Trouble{LinkFailure::exception, (*reply)[1]});
  }
  if ((*reply)[0] != pdu[0]) return tl::unexpected(Trouble{LinkFailure::stale, 0});
  return std::move(*reply);
}

tl::expected<Registers, Trouble> Link::Connection::ask_once(const Block& request, const Registers& values,
                                                            const Block& answer) {
  ECS_TRY(reply, transact(read_write_request(request, values, answer)));
  const std::size_t bytes = 2u * answer.count;
  if (reply.size() != bytes + 2 || reply[1] != bytes) return tl::unexpected(Trouble{LinkFailure::stale, 0});
  Registers registers(answer.count);
  for (std::size_t i = 0; i < registers.size(); ++i)
    registers[i] = static_cast<std::uint16_t>(reply[2 + 2 * i] << 8 | reply[3 + 2 * i]);
  const auto requests_ago = static_cast<std::uint16_t>(values.front() - registers.front());
  if (requests_ago != 0) return tl::unexpected(Trouble{LinkFailure::stale, 0, requests_ago > kLatestReply});
  late_replies_possible = false;
  return registers;
}

void Link::Connection::count(const Trouble& trouble) {
  if (trouble.failure == LinkFailure::no_answer) ++statistics.timeouts;
  if (trouble.failure == LinkFailure::garbled) ++statistics.crc_errors;
  if (trouble.failure == LinkFailure::stale)
    ++(trouble.foreign ? statistics.foreign_replies : statistics.stale_replies);
  if (trouble.failure == LinkFailure::exception) ++statistics.exceptions;
}

/// After an error the link stays silent until even the slowest reply has come, and is flushed.
Trouble Link::Connection::recover(Trouble trouble) {
  count(trouble);
  const bool is_final = trouble.failure == LinkFailure::exception || trouble.failure == LinkFailure::disconnected;
  if (is_final) return trouble;
  late_replies_possible = true;
  if (trouble.failure == LinkFailure::cancelled) return trouble;
  if (line->stay_quiet(timing.quiet_time, [this] { return cancelled(); })) return trouble;
  return {line->connected() ? LinkFailure::cancelled : LinkFailure::disconnected, 0};
}

tl::unexpected<Problem> Link::Connection::fail(const Trouble& trouble, int tries) {
  failure = trouble.failure;
  const auto say = [&](std::string text) {
    return problem(ProblemKind::link, fmt::format("{}: {}", name(), std::move(text)));
  };
  const auto wait_ms = std::chrono::duration_cast<std::chrono::milliseconds>(timing.response_timeout).count();
  const std::string_view what_to_check =
      address.is_serial() ? "power, cable, baud rate and unit number" : "power and unit number";
  switch (trouble.failure) {
    case LinkFailure::no_answer:
      return say(fmt::format("no answer within {} ms ({} {}); check {}", wait_ms, tries, tries == 1 ? "try" : "tries",
                             what_to_check));
    case LinkFailure::garbled:
      if (!address.is_serial())
        return say(fmt::format("replies that are not answers of a unit ({} {}); check that a unit is at this port",
                               tries, tries == 1 ? "try" : "tries"));
      return say(fmt::format("garbled replies, bad CRC ({} {}); check cable, baud rate, parity and grounding", tries,
                             tries == 1 ? "try" : "tries"));
    case LinkFailure::stale:
      if (trouble.foreign)
        return say(fmt::format(
            "only answers to another host's requests ({} tries); end the other program, or disconnect it", tries));
      return say(fmt::format(
          "only late replies to earlier requests ({} tries); the unit is too slow or two hosts use one link", tries));
    case LinkFailure::exception:
      return say(
          fmt::format("the unit answers exception {}: {}", trouble.exception, exception_text(trouble.exception)));
    case LinkFailure::cancelled:
      return say("cancelled");
    default:
      return say("the connection is lost (port unplugged, or closed by the other end); connect again");
  }
}

Link::Link(std::unique_ptr<Connection> connection) : connection_(std::move(connection)) {}
Link::Link(Link&&) noexcept = default;
Link& Link::operator=(Link&&) noexcept = default;
Link::~Link() = default;

Result<Link> Link::open(const LinkAddress& address, const LinkOptions& options) {
  Link link(std::make_unique<Connection>(address, options));
  ECS_DO(link.reconnect());
  return link;
}

Result<void> Link::reconnect() {
  const auto connected = connection_->line->connect();
  if (connected) return {};
  connection_->failure = connected.error().failure;
  return tl::unexpected(connected.error().problem);
}

Result<Registers> Link::ask(const Block& request, Registers values, const Block& answer) {
  auto& connection = *connection_;
  ++connection.statistics.requests;
  Trouble trouble;
  const int tries = connection.tries();
  for (int tried = 1; tried <= tries; ++tried) {
    if (tried > 1) ++connection.statistics.retries;
    values.front() = ++connection.echo;
    auto reply = connection.ask_once(request, values, answer);
    if (reply) {
      connection.failure = LinkFailure::none;
      return std::move(*reply);
    }
    trouble = connection.recover(reply.error());
    const bool worth_another = trouble.failure == LinkFailure::no_answer || trouble.failure == LinkFailure::garbled ||
                               trouble.failure == LinkFailure::stale;
    if (!worth_another) return connection.fail(trouble, tried);
  }
  return connection.fail(trouble, tries);
}

Result<void> Link::write_once(std::uint16_t first, std::span<const std::uint16_t> values) {
  auto& connection = *connection_;
  ++connection.statistics.requests;
  const auto reply = connection.transact(write_request(first, values));
  if (!reply) return connection.fail(connection.recover(reply.error()), 1);
  Bytes expected{MODBUS_FC_WRITE_MULTIPLE_REGISTERS};
  put_words(expected, std::array{first, static_cast<std::uint16_t>(values.size())});
  if (*reply != expected) return connection.fail(connection.recover({LinkFailure::stale, 0}), 1);
  connection.failure = LinkFailure::none;
  return {};
}

bool Link::pause(std::chrono::nanoseconds span) const {
  constexpr auto kSlice = std::chrono::milliseconds(20);
  const auto until = now() + span;
  while (!cancelled()) {
    const auto time = now();
    if (time >= until) return true;
    connection_->line->sleep_until(std::min<Clock::time_point>(until, time + kSlice));
  }
  return false;
}

Clock::time_point Link::now() const { return connection_->line->now(); }
std::int64_t Link::unix_time_s() const { return connection_->line->unix_time_s(); }
void Link::heed_cancel(bool heed) { connection_->heeds_cancel = heed; }
bool Link::cancelled() const { return connection_->cancelled(); }
bool Link::connected() const { return connection_->line->connected(); }
LinkFailure Link::last_failure() const { return connection_->failure; }
const LinkStatistics& Link::statistics() const { return connection_->statistics; }
const LinkTiming& Link::timing() const { return connection_->timing; }
const LinkAddress& Link::address() const { return connection_->address; }

}  // namespace ecs::protocol
