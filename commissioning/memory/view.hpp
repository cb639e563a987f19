// Decoded memory in words and as JSON; a file of a unit's state by what it is.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/json_fwd.hpp"
#include "commissioning/memory/decode.hpp"
#include "commissioning/unit/status.hpp"

namespace ecs::commissioning {

/// @param with_bytes  in the text, names and meaning beside the bytes of prefix, parameters and directory
[[nodiscard]] Cell memory_cell(const MemoryDump& dump, const DecodedMemory& memory, bool with_bytes);

/// A status file, or a memory dump with what it says.
struct StatusFile {
  std::string name;
  std::optional<StatusSnapshot> snapshot;  ///< a dump may have none
  std::vector<std::string> memory;         ///< lines of a dump; empty: a status file
};
/// By its first bytes: a status file (JSON), else a memory dump.
[[nodiscard]] Result<StatusFile> read_status_file(const std::string& path);

}  // namespace ecs::commissioning
