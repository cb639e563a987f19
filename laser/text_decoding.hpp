// The text of a file as UTF-8, whatever the code page of the PC that wrote it.
// Does not live here: what the text means.
#pragma once

#include <string>
#include <string_view>

#include "base/result.hpp"

namespace ecs::laser {

enum class Encoding {
  automatic,  ///< UTF-16 by its mark or its zero bytes; UTF-8 if it is valid; else GBK if every high byte pairs as
              ///< Chinese text; else Windows-1252
  utf8,
  windows_1252,
  gbk,
  latin1,
  shift_jis,  ///< Japanese; only if asked for, its bytes pass for others
  utf16,      ///< byte order by the mark, else by where the zero bytes stand
};

[[nodiscard]] std::string_view name_of(Encoding encoding);

struct DecodedText {
  std::string text;                    ///< UTF-8 without byte order mark
  Encoding encoding = Encoding::utf8;  ///< what it was taken for; never `automatic`
};

/// Refuses an empty file, binary content (control characters) and bytes that the asked-for encoding lacks.
[[nodiscard]] Result<DecodedText> decoded(std::string_view bytes, const std::string& file_name,
                                          Encoding wanted = Encoding::automatic);

}  // namespace ecs::laser
