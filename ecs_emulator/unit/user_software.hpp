// RUN USER SOFTWARE (thesis 5.4): machine code of a Motorola 68000 in the unit's memory, run by a processor emulation
// beside the unit's own loop. Does not live here: the command that starts it (commands.cpp).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include "core/address_map.hpp"
#include "core/axis.hpp"
#include "ecs_emulator/unit/memory.hpp"

namespace ecs::emulator {

struct Registers68000 {
  std::array<std::uint32_t, 8> d{};
  std::array<std::uint32_t, 8> a{};
  std::uint32_t pc = 0;
  std::uint16_t sr = 0;
};

enum class UserEnd : std::uint8_t {
  running,
  returned,  ///< RTS to where it was called from
  trapped,   ///< an illegal access or an exception: why() says which and where
  too_long,  ///< the instruction limit
};

/// What a program reads at kMachineInputs, 32 bits each: periods of the loop since it began, position of X, Y, Z [um],
/// then one bit per axis that exists.
struct MachineInputs {
  std::uint32_t periods = 0;
  PerAxis<std::int32_t> position_um{};
  std::uint32_t present = 0;
};

class UserSoftware {
 public:
  static constexpr std::uint64_t kInstructionsPer_s = 1'000'000;  ///< a 68000 of about 8 MHz
  static constexpr std::uint64_t kMostInstructions = 60'000'000;  ///< a minute of its time
  /// Where it can lie: inside system RAM, at an even address.
  [[nodiscard]] static bool may_start_at(Address start);

  /// D0 = `argument`, supervisor mode, stack at the top of system RAM with the return address on it.
  /// @pre may_start_at(start)
  UserSoftware(UnitMemory& memory, Address start, std::uint32_t argument);
  ~UserSoftware();

  /// This many microseconds of its time; memory shows what it wrote.
  void step(const MachineInputs& inputs, double period_s);
  /// The host has written into memory meanwhile.
  void host_wrote(Address first, std::uint32_t size);

  [[nodiscard]] UserEnd end() const;
  [[nodiscard]] const std::string& why() const;  ///< one sentence, at most 80 characters
  [[nodiscard]] Registers68000 registers() const;
  [[nodiscard]] std::uint64_t instructions() const;
  /// Leaves the registers at kUserRegisters.
  void keep_registers();

 private:
  struct Processor;
  std::unique_ptr<Processor> processor_;
};

}  // namespace ecs::emulator
