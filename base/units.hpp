// Factors between the units of files and our own (µm, mm, µm/m, hPa, s). Positions are mm, errors µm, angles µm/m.
#pragma once

#include <numbers>

namespace ecs {

inline constexpr double kUmPerMm = 1000.0;
inline constexpr double kMmPerM = 1000.0;
inline constexpr double kMmPerInch = 25.4;        ///< exact since 1959
inline constexpr double kRadPerUmPerM = 1e-6;     ///< angles
inline constexpr double kUmPerMPerMrad = 1000.0;  ///< angles: 1 mrad = 1000 µm/m
inline constexpr double kPaPerHPa = 100.0;
inline constexpr double kHPaPerKPa = 10.0;
inline constexpr double kSecondsPerHour = 3600.0;
inline constexpr double kTurn = 2.0 * std::numbers::pi;  ///< one turn in radians

}  // namespace ecs
