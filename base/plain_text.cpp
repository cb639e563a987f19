#include "base/plain_text.hpp"

#include <algorithm>

namespace ecs {

std::optional<const char*> utf16_order(std::string_view bytes) {
  constexpr std::size_t kLooked = 64;
  if (bytes.starts_with("\xFF\xFE")) return "UTF-16LE";
  if (bytes.starts_with("\xFE\xFF")) return "UTF-16BE";
  if (bytes.size() < 4) return std::nullopt;
  std::size_t zeros[2] = {0, 0};
  const std::size_t looked = std::min(bytes.size() & ~std::size_t{1}, kLooked);
  for (std::size_t i = 0; i < looked; ++i)
    if (bytes[i] == '\0') ++zeros[i % 2];
  if (zeros[1] == looked / 2 && zeros[0] == 0) return "UTF-16LE";
  if (zeros[0] == looked / 2 && zeros[1] == 0) return "UTF-16BE";
  return std::nullopt;
}

std::optional<Problem> why_no_text(std::string_view bytes, const std::string& file_name) {
  if (utf16_order(bytes))
    return Problem{ProblemKind::bad_input, "this is UTF-16: save it as UTF-8", file_name, 0, 0, {}};
  const std::size_t at = bytes.find('\0');
  if (at == std::string_view::npos) return std::nullopt;
  const std::string_view before = bytes.substr(0, at);
  const std::size_t line_start = before.rfind('\n') + 1;  // npos + 1 is the beginning
  return Problem{ProblemKind::bad_input,
                 "a NUL byte (0): expected text; the file is damaged, or not of this kind",
                 file_name,
                 static_cast<int>(std::count(before.begin(), before.end(), '\n')) + 1,
                 static_cast<int>(at - line_start) + 1,
                 {}};
}

}  // namespace ecs
