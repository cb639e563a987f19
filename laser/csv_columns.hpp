// The known columns of a measurement CSV: their names, and how one cell enters a reading; words of headings and cells
// that mean something whatever the file. Does not live here: lines, headers and files (measurement_set.cpp).
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/axis.hpp"
#include "laser/measurement_set.hpp"

namespace ecs::laser {

/// The words of a heading in lower case: "Target_mm" and "target (mm)" are target and mm. At least one, perhaps empty.
[[nodiscard]] std::vector<std::string> heading_words(std::string_view heading);

/// "forward", "rev", "+", "down", "1", "zurück", "aller" … in any case; an empty word is unknown. Nothing for others.
[[nodiscard]] std::optional<Approach> approach_named(std::string_view word);

/// An optional number of a reading and the column that holds it.
struct NumberColumn {
  std::string_view name;
  std::optional<double> Reading::*member;
};

inline constexpr std::array<NumberColumn, 6> kNumberColumns{
    {{"time_s", &Reading::time_s},
     {"feed_mm_min", &Reading::feed_mm_min},
     {"load_kg", &Reading::load_kg},
     {"travel_since_reversal_mm", &Reading::travel_since_reversal_mm},
     {"pressure_hPa", &Reading::pressure_hPa},
     {"humidity_pct", &Reading::humidity_pct}}};
inline constexpr std::array<std::string_view, kAxes> kPositionColumns{"x_mm", "y_mm", "z_mm"};
inline constexpr std::array<std::string_view, kAxes> kAngleColumns{"a_deg", "b_deg", "c_deg"};
/// The column of the target of a moving axis.
[[nodiscard]] constexpr std::string_view target_column(Axis axis, bool rotary) {
  return (rotary ? kAngleColumns : kPositionColumns)[index_of(axis)];
}
/// The column of the speed of the moving axis at the moment of the reading, negative in reverse.
[[nodiscard]] constexpr std::string_view speed_column(bool rotary) { return rotary ? "speed_deg_min" : "speed_mm_min"; }
/// How far the reading channel moves while the axis moves by 1: what a delay or lost motion is multiplied by where the
/// reading has waves of its own, for they are then read at another place.
inline constexpr std::string_view kReadingSlopeColumn = "reading_slope";
inline constexpr std::array<std::string_view, 3> kNeededColumns{"axis", "sense", "reading"};
/// Needed and known columns that are neither positions nor optional numbers.
inline constexpr std::array<std::string_view, 6> kOtherColumns{"axis",     "sense", "reading",
                                                               "approach", "run",   "compensated"};

/// The axis that a letter X, Y, Z, A, B, C names.
struct NamedAxis {
  Axis axis = Axis::X;
  bool rotary = false;
};
[[nodiscard]] std::optional<NamedAxis> axis_named(std::string_view letter);

/// A column with a meaning: needed, position, optional number, or a sensor.
[[nodiscard]] bool is_known_column(std::string_view name);

/// Puts a cell of a known column into the reading. An empty optional cell leaves the default.
/// @return empty, or what was expected and found
[[nodiscard]] std::string set_cell(Reading& reading, std::string_view column, std::string_view cell);

}  // namespace ecs::laser
