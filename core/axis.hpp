// Axes, directions and approaches, the smallest words of the core, and the 21 geometric error components of three
// linear axes by their ISO 230-1:2012 names: second letter = sense of the error, third = moving axis. Units: um for
// E[XYZ]., um/m for E[ABC]. and squareness.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace ecs {

/// A linear axis of the machine, and a direction of its right-handed frame.
enum class Axis : std::uint8_t { X = 0, Y = 1, Z = 2 };

inline constexpr std::size_t kAxes = 3;
inline constexpr std::array<Axis, kAxes> kAllAxes{Axis::X, Axis::Y, Axis::Z};

[[nodiscard]] constexpr std::size_t index_of(Axis axis) { return static_cast<std::size_t>(axis); }
[[nodiscard]] constexpr char letter_of(Axis axis) { return static_cast<char>('X' + static_cast<char>(axis)); }
/// x, y, z.
[[nodiscard]] constexpr char small_letter_of(Axis a) { return static_cast<char>(letter_of(a) - 'X' + 'x'); }
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

/// The order is that of the memory image (core/memory_image.hpp): do not reorder.
enum class Component : std::uint8_t {
  EXX,
  EYX,
  EZX,
  EAX,
  EBX,
  ECX,  //
  EXY,
  EYY,
  EZY,
  EAY,
  EBY,
  ECY,  //
  EXZ,
  EYZ,
  EZZ,
  EAZ,
  EBZ,
  ECZ,  //
  C0Y,
  B0Z,
  A0Z  ///< squareness: one constant for the whole axis
};

inline constexpr std::size_t kCurves = 18;      ///< components that vary with position
inline constexpr std::size_t kComponents = 21;  ///< the curves and the three squareness values

/// What an error does to the tool: a translation along X, Y, Z [um] or a rotation A, B, C about them [um/m].
enum class Sense : std::uint8_t { EX, EY, EZ, EA, EB, EC };

inline constexpr std::array<std::string_view, kComponents> kComponentNames{
    "EXX", "EYX", "EZX", "EAX", "EBX", "ECX", "EXY", "EYY", "EZY", "EAY", "EBY",
    "ECY", "EXZ", "EYZ", "EZZ", "EAZ", "EBZ", "ECZ", "C0Y", "B0Z", "A0Z"};
inline constexpr std::array<std::string_view, 6> kSenseNames{"EX", "EY", "EZ", "EA", "EB", "EC"};

[[nodiscard]] constexpr std::size_t index_of(Component c) { return static_cast<std::size_t>(c); }
[[nodiscard]] constexpr std::string_view name_of(Component c) { return kComponentNames[index_of(c)]; }
[[nodiscard]] constexpr std::string_view name_of(Sense s) { return kSenseNames[static_cast<std::size_t>(s)]; }

[[nodiscard]] constexpr bool is_squareness(Component c) { return index_of(c) >= kCurves; }

/// @pre !is_squareness(c)
[[nodiscard]] constexpr Axis moving_axis(Component c) { return static_cast<Axis>(index_of(c) / 6); }
/// @pre !is_squareness(c)
[[nodiscard]] constexpr Sense sense_of(Component c) { return static_cast<Sense>(index_of(c) % 6); }

[[nodiscard]] constexpr bool is_rotation(Sense s) { return s >= Sense::EA; }
/// Rotation curve (EA., EB., EC.): its values are um/m.
[[nodiscard]] constexpr bool is_angular(Component c) { return !is_squareness(c) && is_rotation(sense_of(c)); }
/// Positioning curve (EXX, EYY, EZZ).
[[nodiscard]] constexpr bool is_positioning(Component c) {
  return !is_squareness(c) && static_cast<std::size_t>(sense_of(c)) == index_of(moving_axis(c));
}
/// Straightness curve (EYX, EZX, EXY, …).
[[nodiscard]] constexpr bool is_straightness(Component c) {
  return !is_squareness(c) && !is_angular(c) && !is_positioning(c);
}
[[nodiscard]] constexpr std::string_view unit_of(Component c) {
  return is_squareness(c) || is_angular(c) ? "um/m" : "um";
}

/// The direction of a translation, or the direction about which a rotation turns.
[[nodiscard]] constexpr Axis direction_of(Sense s) { return static_cast<Axis>(static_cast<std::size_t>(s) % 3); }

[[nodiscard]] constexpr Component curve_of(Sense s, Axis moving) {
  return static_cast<Component>(index_of(moving) * 6 + static_cast<std::size_t>(s));
}

/// EXX, EYY, EZZ.
[[nodiscard]] constexpr Component positioning_curve(Axis a) { return curve_of(static_cast<Sense>(a), a); }

/// "ECX" → ECX; anything but the 21 names (upper case) → nothing.
[[nodiscard]] constexpr std::optional<Component> component_of(std::string_view name) {
  for (std::size_t i = 0; i < kComponents; ++i)
    if (kComponentNames[i] == name) return static_cast<Component>(i);
  return std::nullopt;
}
[[nodiscard]] constexpr std::optional<Sense> sense_named(std::string_view name) {
  for (std::size_t i = 0; i < kSenseNames.size(); ++i)
    if (kSenseNames[i] == name) return static_cast<Sense>(i);
  return std::nullopt;
}

}  // namespace ecs
