// Decoded memory in words and as JSON.
#pragma once

#include <string>

#include "base/json_fwd.hpp"
#include "commissioning/memory/decode.hpp"

namespace ecs::commissioning {

[[nodiscard]] Json json_of(const MemoryDump& dump, const DecodedMemory& memory);

/// @param with_bytes  names and meaning beside the bytes of prefix, parameters and directory
[[nodiscard]] std::string text_of(const MemoryDump& dump, const DecodedMemory& memory, bool with_bytes);

}  // namespace ecs::commissioning
