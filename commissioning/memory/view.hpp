// Decoded memory in words and as JSON.
#pragma once

#include "base/json_fwd.hpp"
#include "commissioning/memory/decode.hpp"

namespace ecs::commissioning {

/// @param with_bytes  in the text, names and meaning beside the bytes of prefix, parameters and directory
[[nodiscard]] Cell memory_cell(const MemoryDump& dump, const DecodedMemory& memory, bool with_bytes);

}  // namespace ecs::commissioning
