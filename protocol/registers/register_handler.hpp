// What a Modbus server asks of the device behind it: registers in, registers out.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <tl/expected.hpp>

namespace ecs::protocol {

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
  /// serial line is one connection, whoever writes on it.
  virtual void arrives_on(std::uint64_t /*connection*/) {}
  /// `count` registers from `first` on, or the exception to answer with.
  [[nodiscard]] virtual tl::expected<Registers, ModbusException> read(std::uint16_t first, std::uint16_t count) = 0;
  /// All of the values or none. Never called for a broadcast.
  [[nodiscard]] virtual tl::expected<void, ModbusException> write(std::uint16_t first,
                                                                  std::span<const std::uint16_t> values) = 0;
  /// The device has no power: what it was asked last gets no reply.
  [[nodiscard]] virtual bool silent() const { return false; }
};

}  // namespace ecs::protocol
