// The proving ground's words for physical causes: what an effect of docs/physics.md, "The effect library" is, where it
// sits, how large it is. Does not live here: what it adds to a reading (ecs_emulator/hidden_cases/contribution.hpp).
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/axis.hpp"
#include "core/component.hpp"

namespace ecs::emulator {

enum class EffectKind : std::uint8_t {
  offset,
  scale,
  progressive,
  cyclic,
  backlash,
  reversal_curve,
  step,
  sag,
  angular,
  squareness,
  measurement_line,
  thermal_scale,
  thermal_drift,
  warm_up,
  time_drift,
  air_refraction,
  dead_path,
  cosine,
  servo_lag,
  load,
  reversal_spike,
  map_polarity,
  map_gain,
  map_shift,
  map_direction_swap,
};
inline constexpr std::size_t kEffectKinds = 25;
inline constexpr std::array<std::string_view, kEffectKinds> kEffectNames{
    "offset",           "scale",         "progressive",   "cyclic",    "backlash",
    "reversal_curve",   "step",          "sag",           "angular",   "squareness",
    "measurement_line", "thermal_scale", "thermal_drift", "warm_up",   "time_drift",
    "air_refraction",   "dead_path",     "cosine",        "servo_lag", "load",
    "reversal_spike",   "map_polarity",  "map_gain",      "map_shift", "map_direction_swap"};
[[nodiscard]] constexpr std::string_view name_of(EffectKind kind) {
  return kEffectNames[static_cast<std::size_t>(kind)];
}
[[nodiscard]] std::optional<EffectKind> effect_kind_named(std::string_view name);

/// A smooth curve over a travel: Legendre polynomials of degree 2, 3, …; a mean and a slope where the effect keeps
/// them.
struct SmoothCurve {
  double from_mm = 0.0;
  double to_mm = 1.0;
  double mean = 0.0;
  double slope = 0.0;         ///< over half the range
  std::vector<double> waves;  ///< of degree 2, 3, …
  [[nodiscard]] bool empty() const { return waves.empty() && mean == 0.0 && slope == 0.0; }
};
/// Beyond the range the end value holds.
[[nodiscard]] double value_at(const SmoothCurve& curve, double p_mm);
/// Legendre polynomial of `degree` at `place` in −1 … 1.
[[nodiscard]] double legendre(std::size_t degree, double place);

/// An effect at its place. Parameters bear the names of docs/physics.md; curves have a shape instead.
struct PlacedEffect {
  EffectKind kind = EffectKind::offset;
  std::optional<Axis> axis;
  std::optional<Sense> sense;
  std::optional<Component> code;
  Approach approach = Approach::unknown;  ///< unknown: both
  std::string sensor;                     ///< column of the sensor of a thermal drift
  std::map<std::string, double, std::less<>> parameters;
  SmoothCurve curve;
  [[nodiscard]] double parameter(std::string_view name) const;  ///< 0 where there is none
};

/// "cyclic:X:EX", "angular:X:ECX", "map_polarity:X" (all curves of X), "map_polarity" (the whole map).
[[nodiscard]] std::string place_of(const PlacedEffect& effect);
/// The same with a contribution `factor` times as large. @pre not a fault of the map; a cosine keeps its sign
[[nodiscard]] PlacedEffect scaled(PlacedEffect effect, double factor);

[[nodiscard]] constexpr bool is_map_fault(EffectKind kind) { return kind >= EffectKind::map_polarity; }
/// Acts only while its own axis is the one that moves.
[[nodiscard]] constexpr bool is_of_approach(EffectKind kind) {
  return kind == EffectKind::backlash || kind == EffectKind::reversal_curve || kind == EffectKind::servo_lag ||
         kind == EffectKind::reversal_spike;
}
/// Its size is a matter of nature, not of choice: noise and map are made to fit it.
[[nodiscard]] constexpr bool has_natural_size(EffectKind kind) {
  return kind == EffectKind::air_refraction || kind == EffectKind::dead_path;
}

}  // namespace ecs::emulator
