// Axes, directions and approaches: the smallest words of the core.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace ecs {

/// A linear axis of the machine, and a direction of its right-handed frame.
enum class Axis : std::uint8_t { X = 0, Y = 1, Z = 2 };

inline constexpr std::size_t kAxes = 3;
inline constexpr std::array<Axis, kAxes> kAllAxes{Axis::X, Axis::Y, Axis::Z};

[[nodiscard]] constexpr std::size_t index_of(Axis axis) { return static_cast<std::size_t>(axis); }
[[nodiscard]] constexpr char letter_of(Axis axis) { return static_cast<char>('X' + static_cast<char>(axis)); }
[[nodiscard]] constexpr std::optional<Axis> axis_of(char letter) {
  if (letter < 'X' || letter > 'Z') return std::nullopt;
  return static_cast<Axis>(letter - 'X');
}

/// Direction in which the moving axis last moved; forward = increasing coordinate.
enum class Approach : std::int8_t { reverse = -1, unknown = 0, forward = 1 };

/// One number for each axis, in the order X, Y, Z. The member that uses it names the unit.
template <class T>
using PerAxis = std::array<T, kAxes>;

/// A vector in the machine frame; positions in mm, errors in um.
using Vector3 = PerAxis<double>;

}  // namespace ecs
