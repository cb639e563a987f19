// The formats of measurement files that the program knows.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "laser/import/format.hpp"

namespace ecs::laser {

/// In the order of messages and documentation; the first is the measurement CSV, the last are
/// read by a mapping only.
[[nodiscard]] std::span<const FileFormat* const> file_formats();

/// Nothing if no format has this id.
[[nodiscard]] const FileFormat* file_format(std::string_view id);

/// The format by content, the extension only where the content leaves a choice; nothing if no format fits.
/// @param text  decoded, or the bytes of a binary file
[[nodiscard]] const FileFormat* recognised_format(std::string_view text, const std::string& file_name);

/// The format that writes files of this extension (".rtl", any case); the measurement CSV for any other.
[[nodiscard]] const FileFormat& format_written_as(std::string_view extension);

}  // namespace ecs::laser
