// Units that measurement files come in, and what they are in ours. Does not live here: which column has which unit.
#pragma once

#include <numbers>
#include <optional>
#include <string>
#include <string_view>

namespace ecs::laser {

/// What a unit measures; the unit used inside is named after it.
enum class UnitKind {
  length,       ///< mm
  angle,        ///< um/m
  temperature,  ///< degC
  pressure,     ///< hPa
  time,         ///< s
};

/// inside = value · factor + offset
struct Unit {
  std::string_view name;
  UnitKind kind = UnitKind::length;
  double factor = 1.0;
  double offset = 0.0;
};

/// 1 degree in um/m, the unit of angles.
inline constexpr double kUmPerMPerDegree = 1e6 * std::numbers::pi / 180.0;

/// "mm", "in", "um", "mrad", "arcsec", "degF", "kPa", …; upper and lower case alike. Nothing for other words.
[[nodiscard]] std::optional<Unit> unit_named(std::string_view name);

/// All names, separated by blanks, for messages.
[[nodiscard]] std::string unit_names();

/// A number as users' programs write it: `number_in`, with a decimal comma, or with thousands apart, "1.200,5", "1
/// 200.5".
[[nodiscard]] std::optional<double> number_or_comma(std::string_view text);

}  // namespace ecs::laser
