// The one register map of the link: where each block lies and how long it is (docs/protocol.md explains it), and what a
// Modbus server asks of the device behind it: registers in, registers out.
// Does not live here: what the fields of a block mean (unit_data.hpp) and their order (unit_registers.cpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <tl/expected.hpp>

namespace ecs::protocol {

/// Raised when a field moves or changes its meaning; the host refuses to talk to another version.
inline constexpr std::uint16_t kProtocolVersion = 3;

/// A run of 16-bit registers. Numbers go high word first: 32 bits = 2 registers, 64 bits = 4. A real number is the
/// IEEE 754 double as 64 bits, always. Text is two characters a register, the first in the high byte, zero-padded.
struct Block {
  std::uint16_t first = 0;
  std::uint16_t count = 0;
  [[nodiscard]] constexpr std::uint32_t end() const { return static_cast<std::uint32_t>(first) + count; }
  [[nodiscard]] constexpr bool contains(std::uint32_t from, std::uint32_t n) const {
    return from >= first && from + n <= end();
  }
  friend constexpr bool operator==(const Block&, const Block&) = default;
};

// Request blocks: written by the host; those below 0x0100 are read back as last written, of those that name a session
// only the echo. Each but `kBlockWrite` begins with the echo cell: one cell for all of them, which comes back as the
// first register of every answer block. A host that writes a new echo and reads an answer in one transaction (function
// 23) can tell a late reply from the one it waits for. Who asks (session (2), challenge (2)) wants an answer that ends
// with a keyed check.
inline constexpr Block kEcho{0x0000, 5};  ///< echo, who asks (4): before a plain answer block; the echo alone will do
inline constexpr Block kReadSelect{0x0010,
                                   8};  ///< echo, address (2), bytes, who asks (4); the first four alone will do
/// echo, who asks (4), number (2), address (2), bytes (2), token (2), coded, keyed check (4)
inline constexpr Block kWindowOpen{0x0020, 18};
/// echo, who asks (4), sequence (2), command, the unit's clock (2) and stops as the host saw them, 8 arguments, keyed
/// check (4)
inline constexpr Block kCommand{0x0038, 23};
/// echo, challenge (2), protocol version, key (4), number (2), time (2), host name (8), check (2)
inline constexpr Block kSessionOpen{0x0050, 22};
inline constexpr Block kEventSelect{0x0068, 3};  ///< echo, number of the first event to read (2)
inline constexpr Block kToken{0x0070, 16};       ///< TCP beyond one computer: the SHA-256 of the token, before all else
inline constexpr Block kBlockWrite{0x0080, 123};  ///< tag, number, keyed check (4), 117 payload registers
inline constexpr Block kCheckSelect{0x0600, 10};  ///< echo, who asks (4), address (2), bytes (2), bytes of a piece
inline constexpr Block kResultSelect{0x0610, 7};  ///< echo, who asks (4), sequence (2)
inline constexpr Block kArmShare{0x0618, 22};     ///< echo, session (2), minutes, the host's share (16), check (2)
inline constexpr Block kArmConfirm{0x0630, 13};   ///< echo, session (2), the host's confirmation (8), check (2)

// Answer blocks: read only; the first register is the echo.
inline constexpr Block kIdentity{0x0100, 54};
inline constexpr Block kVersion{0x0100, 2};  ///< its beginning, which every version has: echo, protocol version
inline constexpr Block kStatus{0x0180, 58};
inline constexpr Block kMonitor{0x0200, 69};
inline constexpr Block kPointers{0x0280, 77};
inline constexpr Block kCommandResult{0x0300, 56};  ///< ends with the keyed check (4)
inline constexpr Block kWindowAck{0x0380, 18};      ///< ends with the keyed check (4)
/// echo, address (2), CRC-32 of the bytes (2), 120 registers of data; behind the data that a host with a key asked for,
/// at most 116 registers, the keyed check (4)
inline constexpr Block kMemory{0x0400, 125};
inline constexpr Block kChecks{0x0480, 125};  ///< echo, a keyed check of each piece (4), up to 30, keyed check (4)
inline constexpr Block kEvents{0x0500, 96};   ///< echo, newest number (2), 3 events of 31 registers
/// The host's own session, how long it is armed, and the unit's clock; ends with the keyed check (4).
inline constexpr Block kSession{0x0580, 24};
/// What a transfer looks at again and again, of one unit at one time; ends with the keyed check (4).
inline constexpr Block kActiveMap{0x05A0, 38};
/// echo, error, s before another code is looked at, the unit's share (16) and confirmation (8), s that the host is
/// armed (2)
inline constexpr Block kArmAnswer{0x05D0, 29};
/// echo, age of the stored state in s (2), rows, X Y Z of their compensation (4 each), wired inputs (2), 17 inputs
inline constexpr Block kInputs{0x0640, 120};
/// echo, tool, its state, offset x y z, squareness C0Y B0Z A0Z (4 each), tools in the table, wires and outputs as bits,
/// battery, its age in s (2), state, value (4) and faults of the deviation
inline constexpr Block kControlLines{0x06C0, 38};
/// echo, X Y Z of what the rotary axes add (4 each), then for two axes: letter, sensed, angle (4), approach
inline constexpr Block kRotary{0x06E8, 27};
inline constexpr std::uint16_t kRegisterSpace = 0x0710;  ///< nothing lies at or above

// The memory window: a stretch of memory is written as up to 64 numbered blocks, then acknowledged all at once.
inline constexpr std::size_t kKeyedCheckRegisters = 4;
inline constexpr std::size_t kBlockHeaderRegisters = 2 + kKeyedCheckRegisters;
inline constexpr std::size_t kBlockBytes = 2 * (kBlockWrite.count - kBlockHeaderRegisters);  ///< 234
inline constexpr std::size_t kWindowBlocks = 64;
inline constexpr std::size_t kWindowBytes = kBlockBytes * kWindowBlocks;  ///< 14,976
/// Of a coded window: a block of memory, and the most blocks of which one frame brings the codes.
inline constexpr std::size_t kCodedBlockBytes = 120;
inline constexpr std::size_t kCodedBlocksInFrame = 16;
inline constexpr std::size_t kMostChecks = (kChecks.count - 1 - kKeyedCheckRegisters) / kKeyedCheckRegisters;  ///< 30
inline constexpr std::size_t kCheckRegisters = 2;  ///< at the end of a request block that has a check
inline constexpr std::size_t kMemoryHeaderRegisters = 5;
inline constexpr std::size_t kMemoryBytes = 2 * (kMemory.count - kMemoryHeaderRegisters);  ///< 240, most in one read
inline constexpr std::size_t kKeyedMemoryBytes = kMemoryBytes - 2 * kKeyedCheckRegisters;  ///< 232, with a keyed check

inline constexpr std::size_t kResultTextBytes = 80;
inline constexpr std::size_t kSerialNumberBytes = 16;
inline constexpr std::size_t kUnitNameBytes = 32;
inline constexpr std::size_t kMachineBytes = 40;
inline constexpr std::size_t kHostNameBytes = 16;
inline constexpr std::size_t kEventTextBytes = 24;
inline constexpr std::size_t kEventsInBlock = 3;
inline constexpr std::size_t kKeptEvents = 64;       ///< by a unit; the oldest gives way
inline constexpr std::size_t kKeptOfStrangers = 16;  ///< of these, of hosts that were not armed

// What one Modbus request can carry (MODBUS Application Protocol V1.1b3, 6.3, 6.12, 6.17).
inline constexpr std::size_t kMostRead = 125;
inline constexpr std::size_t kMostWrite = 123;
inline constexpr std::size_t kMostWriteOfReadWrite = 121;

using Registers = std::vector<std::uint16_t>;

/// MODBUS Application Protocol V1.1b3, section 7.
enum class ModbusException : std::uint8_t {
  illegal_function = 1,
  illegal_address = 2,
  illegal_value = 3,
  device_failure = 4,
  device_busy = 6,
  no_such_unit = 11,  ///< "gateway target device failed to respond"
};

class RegisterHandler {
 public:
  virtual ~RegisterHandler() = default;
  /// The connection that the requests to come arrive on. A TCP connection has a number that no other one ever has; a
  /// serial line is one connection, whoever writes on it. The origin is the peer's address, or the serial line.
  virtual void arrives_on(std::uint64_t /*connection*/, const std::string& /*origin*/) {}
  /// `count` registers from `first` on, or the exception to answer with.
  [[nodiscard]] virtual tl::expected<Registers, ModbusException> read(std::uint16_t first, std::uint16_t count) = 0;
  /// All of the values or none. Never called for a broadcast.
  [[nodiscard]] virtual tl::expected<void, ModbusException> write(std::uint16_t first,
                                                                  std::span<const std::uint16_t> values) = 0;
  /// Who speaks on that connection: a host that only reads gives way to every other one, a host that gave a command in
  /// the last minute only to an armed one.
  enum class Speaks { reader, commander, armed };
  [[nodiscard]] virtual Speaks speaks_on(std::uint64_t /*connection*/) { return Speaks::reader; }
  /// The device has no power: what it was asked last gets no reply.
  [[nodiscard]] virtual bool silent() const { return false; }
};

}  // namespace ecs::protocol
