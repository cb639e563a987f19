// The file that stands for the lithium battery: axis memory and commit records survive in it (thesis 5.2).
// Does not live here: the memory itself (memory.hpp).
#pragma once

#include <filesystem>

#include "base/result.hpp"
#include "ecs_emulator/unit/memory.hpp"

namespace ecs::emulator {

/// Brings the content of the file into the memory. A file that does not exist leaves it empty (a new battery). A file
/// that is none of ours, or of a rack with another number of modules, is a `bad_input` problem.
[[nodiscard]] Result<void> restore(UnitMemory& memory, const std::filesystem::path& path);

/// Writes the file, whole or not at all.
[[nodiscard]] Result<void> keep(UnitMemory& memory, const std::filesystem::path& path);

}  // namespace ecs::emulator
