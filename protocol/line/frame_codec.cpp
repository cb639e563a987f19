// libmodbus talks to a descriptor only, so the codec holds a pair of connected sockets: the frame goes in at one end,
// the library works at the other, the reply is taken back. Nothing here waits: every frame is complete.
#include "protocol/line/frame_codec.hpp"

#include <algorithm>
#include <array>

#include <modbus.h>
#include <sys/socket.h>
#include <unistd.h>

namespace ecs::protocol {

std::optional<std::size_t> rtu_request_length(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < 2) return std::nullopt;
  switch (bytes[1]) {
    case 1:
    case 2:
    case 3:
    case 4:
    case 5:
    case 6:
      return 8;
    case 15:
    case 16:
      return bytes.size() < 7 ? std::nullopt : std::optional<std::size_t>(9u + bytes[6]);
    case 17:
      return 4;
    case 22:
      return 10;
    case 23:
      return bytes.size() < 11 ? std::nullopt : std::optional<std::size_t>(13u + bytes[10]);
    default:
      return std::nullopt;
  }
}

TcpCut tcp_request_length(std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kHeader = 6;    // transaction, protocol and length
  constexpr std::size_t kShortest = 2;  // unit and function
  constexpr std::size_t kLongest = 254;
  if (bytes.size() < kHeader) return {};
  const std::size_t rest = static_cast<std::size_t>(bytes[4] << 8 | bytes[5]);
  const bool is_modbus = bytes[2] == 0 && bytes[3] == 0 && rest >= kShortest && rest <= kLongest;
  return {kHeader + rest, !is_modbus};
}

namespace {

constexpr std::size_t kCodecBytes = MODBUS_MAX_ADU_LENGTH;
using Adu = std::array<std::uint8_t, kCodecBytes>;

std::uint16_t word_at(std::span<const std::uint8_t> bytes, std::size_t at) {
  return static_cast<std::uint16_t>(bytes[at] << 8 | bytes[at + 1]);
}

Registers words_at(std::span<const std::uint8_t> bytes, std::size_t at, std::size_t count) {
  Registers words(count);
  for (std::size_t i = 0; i < count; ++i) words[i] = word_at(bytes, at + 2 * i);
  return words;
}

/// The functions of docs/protocol.md; libmodbus itself would answer coils, and its own name to function 17.
bool is_of_protocol(std::uint8_t function) {
  constexpr std::array<std::uint8_t, 6> all{MODBUS_FC_READ_HOLDING_REGISTERS, MODBUS_FC_READ_INPUT_REGISTERS,
                                            MODBUS_FC_WRITE_SINGLE_REGISTER,  MODBUS_FC_WRITE_MULTIPLE_REGISTERS,
                                            MODBUS_FC_MASK_WRITE_REGISTER,    MODBUS_FC_WRITE_AND_READ_REGISTERS};
  return std::find(all.begin(), all.end(), function) != all.end();
}

}  // namespace

struct FrameCodec::Library {
  modbus_t* context = nullptr;
  modbus_mapping_t* mapping = nullptr;
  std::array<int, 2> sockets{-1, -1};
  Framing framing = Framing::rtu;
  int unit = 1;

  Library() = default;
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;
  ~Library() {
    modbus_mapping_free(mapping);
    if (context != nullptr) modbus_free(context);
    for (const int fd : sockets)
      if (fd >= 0) ::close(fd);
  }

  [[nodiscard]] std::size_t pdu_at() const { return framing == Framing::rtu ? 1 : 7; }
  [[nodiscard]] bool setup();
  [[nodiscard]] std::optional<ModbusException> serve(Adu& query, RegisterHandler& handler) const;
  [[nodiscard]] std::optional<ModbusException> serve_read(std::uint16_t first, std::uint16_t count,
                                                          RegisterHandler& handler) const;
  [[nodiscard]] std::optional<ModbusException> serve_mask(std::span<const std::uint8_t> pdu,
                                                          RegisterHandler& handler) const;
  [[nodiscard]] std::optional<ModbusException> serve_write_read(std::span<std::uint8_t> pdu,
                                                                RegisterHandler& handler) const;
  [[nodiscard]] std::vector<std::uint8_t> drained() const;
};

bool FrameCodec::Library::setup() {
  context = framing == Framing::rtu ? modbus_new_rtu("/dev/null", 115200, 'N', 8, 1) : modbus_new_tcp("127.0.0.1", 502);
  mapping = modbus_mapping_new(0, 0, kRegisterSpace, kRegisterSpace);
  if (context == nullptr || mapping == nullptr) return false;
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, sockets.data()) != 0) return false;
  constexpr std::uint32_t kShort_us = 1000;
  return modbus_set_slave(context, unit) == 0 && modbus_set_socket(context, sockets[0]) == 0 &&
         modbus_set_response_timeout(context, 0, kShort_us) == 0 &&
         modbus_set_byte_timeout(context, 0, kShort_us) == 0 &&
         modbus_set_indication_timeout(context, 0, kShort_us) == 0;
}

std::vector<std::uint8_t> FrameCodec::Library::drained() const {
  std::vector<std::uint8_t> bytes(2 * kCodecBytes);
  const auto got = ::recv(sockets[1], bytes.data(), bytes.size(), MSG_DONTWAIT);
  bytes.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
  return bytes;
}

std::optional<ModbusException> FrameCodec::Library::serve_read(std::uint16_t first, std::uint16_t count,
                                                               RegisterHandler& handler) const {
  if (count == 0 || count > kMostRead) return ModbusException::illegal_value;
  if (first + std::uint32_t{count} > kRegisterSpace) return ModbusException::illegal_address;
  const auto values = handler.read(first, count);
  if (!values) return values.error();
  std::copy(values->begin(), values->end(), mapping->tab_registers + first);
  std::copy(values->begin(), values->end(), mapping->tab_input_registers + first);
  return std::nullopt;
}

std::optional<ModbusException> FrameCodec::Library::serve_mask(std::span<const std::uint8_t> pdu,
                                                               RegisterHandler& handler) const {
  const std::uint16_t first = word_at(pdu, 1);
  if (const auto refused = serve_read(first, 1, handler)) return refused;
  const unsigned keep = word_at(pdu, 3);
  const unsigned set = word_at(pdu, 5);
  const auto value = static_cast<std::uint16_t>((mapping->tab_registers[first] & keep) | (set & ~keep));
  const auto done = handler.write(first, std::span(&value, 1));
  return done ? std::nullopt : std::optional(done.error());
}

/// The library writes the request's values into its registers before it reads: where both ranges overlap, the values
/// in the request give way to what the handler answers.
std::optional<ModbusException> FrameCodec::Library::serve_write_read(std::span<std::uint8_t> pdu,
                                                                     RegisterHandler& handler) const {
  const std::uint16_t read_first = word_at(pdu, 1);
  const std::uint16_t read_count = word_at(pdu, 3);
  const std::uint16_t write_first = word_at(pdu, 5);
  const std::uint16_t write_count = word_at(pdu, 7);
  const bool whole = write_count > 0 && write_count <= kMostWriteOfReadWrite && pdu[9] == 2 * write_count;
  if (!whole || read_count == 0 || read_count > kMostRead) return ModbusException::illegal_value;
  if (write_first + std::uint32_t{write_count} > kRegisterSpace) return ModbusException::illegal_address;
  const auto done = handler.write(write_first, words_at(pdu, 10, write_count));
  if (!done) return done.error();
  if (const auto refused = serve_read(read_first, read_count, handler)) return refused;
  for (std::size_t i = 0; i < write_count; ++i) {
    const std::size_t at = write_first + i;
    if (at < read_first || at >= std::size_t{read_first} + read_count) continue;
    pdu[10 + 2 * i] = static_cast<std::uint8_t>(mapping->tab_registers[at] >> 8);
    pdu[11 + 2 * i] = static_cast<std::uint8_t>(mapping->tab_registers[at] & 0xFF);
  }
  return std::nullopt;
}

std::optional<ModbusException> FrameCodec::Library::serve(Adu& query, RegisterHandler& handler) const {
  const std::span<std::uint8_t> pdu = std::span(query).subspan(pdu_at());
  const std::uint16_t first = word_at(pdu, 1);
  const std::uint16_t count = word_at(pdu, 3);
  switch (pdu[0]) {
    case MODBUS_FC_READ_HOLDING_REGISTERS:
    case MODBUS_FC_READ_INPUT_REGISTERS:
      return serve_read(first, count, handler);
    case MODBUS_FC_WRITE_SINGLE_REGISTER: {
      const auto done = handler.write(first, words_at(pdu, 3, 1));
      return done ? std::nullopt : std::optional(done.error());
    }
    case MODBUS_FC_WRITE_MULTIPLE_REGISTERS: {
      if (count == 0 || count > kMostWrite || pdu[5] != 2 * count) return ModbusException::illegal_value;
      const auto done = handler.write(first, words_at(pdu, 6, count));
      return done ? std::nullopt : std::optional(done.error());
    }
    case MODBUS_FC_MASK_WRITE_REGISTER:
      return serve_mask(pdu, handler);
    case MODBUS_FC_WRITE_AND_READ_REGISTERS:
      return serve_write_read(pdu, handler);
    default:
      return std::nullopt;
  }
}

FrameCodec::FrameCodec(std::unique_ptr<Library> library) : library_(std::move(library)) {}
FrameCodec::FrameCodec(FrameCodec&&) noexcept = default;
FrameCodec& FrameCodec::operator=(FrameCodec&&) noexcept = default;
FrameCodec::~FrameCodec() = default;

Result<FrameCodec> FrameCodec::make(Framing framing, int unit) {
  auto library = std::make_unique<Library>();
  library->framing = framing;
  library->unit = unit;
  if (!library->setup())
    return problem(ProblemKind::output, "cannot set up the Modbus server: no memory or no sockets");
  return FrameCodec(std::move(library));
}

bool FrameCodec::is_for_unit(std::span<const std::uint8_t> frame) const {
  const std::size_t at = library_->pdu_at() - 1;
  if (frame.size() <= at) return false;
  const std::uint8_t unit = frame[at];
  const bool any_on_tcp = library_->framing == Framing::tcp && unit == MODBUS_TCP_SLAVE;
  return unit == library_->unit || unit == MODBUS_BROADCAST_ADDRESS || any_on_tcp;
}

std::vector<std::uint8_t> FrameCodec::answer(std::span<const std::uint8_t> frame, RegisterHandler& handler) {
  Adu query{};
  if (frame.size() > query.size() || frame.size() <= library_->pdu_at()) return {};
  std::copy(frame.begin(), frame.end(), query.begin());
  const auto refuse = [&](ModbusException exception) {
    modbus_reply_exception(library_->context, query.data(), static_cast<unsigned>(exception));
    return library_->drained();
  };
  if (!is_for_unit(frame)) {
    if (library_->framing == Framing::rtu) return {};
    return refuse(ModbusException::no_such_unit);
  }
  const bool broadcast = frame[library_->pdu_at() - 1] == MODBUS_BROADCAST_ADDRESS && library_->framing == Framing::rtu;
  if (broadcast) return {};  // what is for everybody acts on nobody
  if (!is_of_protocol(query[library_->pdu_at()])) return refuse(ModbusException::illegal_function);
  if (::send(library_->sockets[1], frame.data(), frame.size(), MSG_DONTWAIT | MSG_NOSIGNAL) < 0) return {};
  const int length = modbus_receive(library_->context, query.data());
  Adu rest{};
  while (::recv(library_->sockets[0], rest.data(), rest.size(), MSG_DONTWAIT) > 0) continue;
  if (length <= 0) return {};
  const auto exception = library_->serve(query, handler);
  if (exception) return refuse(*exception);
  modbus_reply(library_->context, query.data(), length, library_->mapping);
  return library_->drained();
}

}  // namespace ecs::protocol
