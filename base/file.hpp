// Files whole or not at all: read in one piece; written beside, flushed, checked, then renamed over the old one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "base/result.hpp"

namespace ecs {

/// The whole file. A directory, of which files are named, a missing or unreadable file, above 256 MiB: `bad_input`.
[[nodiscard]] Result<std::string> read_file(const std::filesystem::path& path);

/// Where a name leads: the target of a symbolic link, also one that does not exist yet; any other name, and a link that
/// leads nowhere at all (a ring of links), as it is.
[[nodiscard]] std::filesystem::path led_to(const std::filesystem::path& path);

/// Replaces `path` by `content`: the old file stays whole until the new one is safely on disc. A symbolic link stays a
/// link, its target is replaced and keeps its mode, or is made; a device or FIFO is written into. `output` problem if
/// not possible.
[[nodiscard]] Result<void> write_file(const std::filesystem::path& path, std::string_view content);

/// SHA-256 as 64 hexadecimal digits.
[[nodiscard]] std::string sha256_hex(std::string_view content);

/// CRC-32 (IEEE 802.3, as zlib and the unit's block check).
[[nodiscard]] std::uint32_t crc32_of(std::span<const std::uint8_t> bytes);

/// Folder for state that outlives a run (the bundled emulator's battery memory, stored links):
/// $ECS_STATE_DIR, else $XDG_STATE_HOME/ecs, else $HOME/.local/state/ecs. Created if missing.
[[nodiscard]] Result<std::filesystem::path> state_folder();

}  // namespace ecs
