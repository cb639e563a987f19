// The words of an enumeration, said once: the word of a value and the value of a word.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace ecs {

/// In the order of the enumeration, whose values count from 0:
///     constexpr WordTable<Wheel, 2> kWheels{{"front", "rear"}};
template <class Enum, std::size_t N>
struct WordTable {
  std::array<std::string_view, N> words;

  /// "unknown" for a number that is none of the values.
  [[nodiscard]] constexpr std::string_view of(Enum value) const noexcept {
    const auto i = static_cast<std::size_t>(value);
    return i < N ? words[i] : std::string_view("unknown");
  }
  /// Nothing for a word that is none of these.
  [[nodiscard]] constexpr std::optional<Enum> value_of(std::string_view word) const noexcept {
    for (std::size_t i = 0; i < N; ++i)
      if (words[i] == word) return static_cast<Enum>(i);
    return std::nullopt;
  }
  /// "front, rear"
  [[nodiscard]] std::string listed() const {
    std::string all;
    for (const std::string_view word : words) all.append(all.empty() ? "" : ", ").append(word);
    return all;
  }
};

}  // namespace ecs
