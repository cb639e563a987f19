// Where a user's program finds the machine, and leaves its registers (docs/unit.md).
#pragma once

#include "core/address_map.hpp"

namespace ecs {

inline constexpr Region kMachineInputs{0x0E0000, 0x1000, false, "machine inputs"};  ///< for user software alone
inline constexpr Address kUserRegisters = kSystemRam.first;  ///< D0 … D7, A0 … A7, PC, SR, 32 bits each
inline constexpr std::uint32_t kUserRegisterBytes = 72;
inline constexpr Address kUserPrograms = kSystemRam.first + 0x1000;  ///< programs begin here or above

}  // namespace ecs
