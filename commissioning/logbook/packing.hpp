// The bytes of a kept file, compressed.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace ecs::commissioning {

inline constexpr std::size_t kLargestKept = 32u << 20;  // of a file that is named by its hash alone

[[nodiscard]] std::string packed(std::string_view content);
/// Nothing where it is not the file of that hash.
[[nodiscard]] std::optional<std::string> unpacked(const std::string& bytes, std::int64_t length,
                                                  const std::string& sha256);

}  // namespace ecs::commissioning
