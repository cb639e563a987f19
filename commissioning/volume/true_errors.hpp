// The true errors of an emulated machine, for a volume: what its errors file says, as the program `ecs-emulator`
// evaluates it. The machine that hides errors computes them with code of its own, so the file is not read here.
#pragma once

#include <filesystem>
#include <string>

#include "base/result.hpp"
#include "params/machine.hpp"
#include "volume/volume.hpp"

namespace ecs::commissioning {

struct TrueErrors {
  volume::ErrorSource source;
  std::string left_out;  ///< what the errors file holds beside them, in words; empty: nothing
};

/// The machine as the emulator has it: cold, unloaded, nothing of what does not repeat.
/// @param errors_file   errors file of the emulator (docs/emulator.md)
/// @param machine_file  that of its machine; empty: one is made of the parameters and the travels
/// @param machine       its errors are replaced; the rest says which machine
/// `bad_input` with the words of the emulator where it refuses the file, a component that is no function of its own
/// axis included; `output` where the program is missing.
[[nodiscard]] Result<TrueErrors> true_errors(const std::string& errors_file, const std::string& machine_file,
                                             const volume::CompensatedMachine& machine);

/// The true errors of the rotary axes of the same machine: location errors, and error motions every half degree.
[[nodiscard]] Result<volume::RotaryErrors> true_rotary_errors(const std::string& errors_file,
                                                              const std::string& machine_file,
                                                              const volume::RotaryAxes& rotary);

}  // namespace ecs::commissioning
