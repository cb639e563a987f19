#include "base/numbers.hpp"

#include <charconv>

#include <fmt/format.h>

#include "base/text.hpp"

namespace ecs {

Result<std::uint32_t> whole_number(std::string_view text, std::string_view what) {
  std::string_view digits = trimmed(text);
  const bool hexadecimal = digits.starts_with("0x") || digits.starts_with("0X");
  if (hexadecimal) digits.remove_prefix(2);
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value, hexadecimal ? 16 : 10);
  if (error == std::errc{} && end == digits.data() + digits.size() && !digits.empty()) return value;
  return problem(ProblemKind::usage,
                 fmt::format("{}: expected a whole number such as 4096 or 0x1000, got \"{}\"", what, text));
}

std::string cell_text(const std::optional<double>& value) { return value ? fmt::format("{:.3f}", *value) : "-"; }

}  // namespace ecs
