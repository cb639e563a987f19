#include "commissioning/maps/declared_zero.hpp"

#include <fmt/format.h>

#include "base/text.hpp"

namespace ecs::commissioning {

Result<laser::DeclaredZero> declared_zero_in(const std::string& word) {
  const std::size_t sign = word.find('=');
  const auto component = component_of(trimmed(std::string_view(word).substr(0, sign)));
  const std::string reason = sign == std::string::npos ? "" : std::string(trimmed(word.substr(sign + 1)));
  if (!component || reason.empty())
    return problem(
        ProblemKind::usage,
        fmt::format("--zero: expected CODE=\"reason\", as in EBY=\"too small to measure\", got \"{}\"", word));
  return laser::DeclaredZero{*component, reason};
}

}  // namespace ecs::commissioning
