// The instruments that measure the machine: laser interferometer, electronic level, indicator against a square.
// They see the tool against the workpiece, whatever makes it err, and add their own noise and bad set-up.
// Does not live here: where the machine goes (measurement.hpp), what is done with readings (the host).
#pragma once

#include <optional>
#include <string_view>

#include "core/component.hpp"
#include "ecs_emulator/emulator_settings.hpp"
#include "ecs_emulator/kinematics.hpp"
#include "ecs_emulator/random.hpp"

namespace ecs::emulator {

enum class InstrumentKind : std::uint8_t {
  linear,        ///< laser, linear optics: E along the moving axis
  straightness,  ///< laser, straightness optics: E across the moving axis, plus slope and offset of the set-up
  angular,       ///< laser, angular optics: pitch and yaw
  level,         ///< electronic level: roll
  square,        ///< indicator against a square nulled along another axis: E across the moving axis, slope included
};
[[nodiscard]] std::string_view name_of(InstrumentKind kind);
[[nodiscard]] std::optional<InstrumentKind> instrument_named(std::string_view name);
/// The instrument that measures `sense` along `moving` by default.
[[nodiscard]] InstrumentKind instrument_for(Sense sense, Axis moving);
/// Why this instrument cannot measure that; empty if it can.
[[nodiscard]] std::string_view refusal(InstrumentKind kind, Sense sense, Axis moving);

class Instrument {
 public:
  /// Sets it up: the slope and offset of a straight-edge are drawn here.
  Instrument(InstrumentKind kind, Sense sense, const LaserSettings& settings, Random& random);

  /// What it would show without noise: um, or um/m.
  [[nodiscard]] double value(const ToolPose& pose, double position_mm) const;
  /// Sets the display to zero here.
  void zero(const ToolPose& pose, double position_mm);
  /// Turns the square: the line of the axis it was nulled along rises by `slope_um_per_m`.
  void null_square(double slope_um_per_m) { slope_um_per_m_ = slope_um_per_m; }
  /// One reading, with noise, to the resolution of the display.
  [[nodiscard]] double read(const ToolPose& pose, double position_mm, Random& random) const;

 private:
  [[nodiscard]] double seen(const ToolPose& pose) const;

  InstrumentKind kind_;
  Sense sense_;
  double noise_ = 0.0;
  double resolution_ = 0.0;
  double slope_um_per_m_ = 0.0;
  double offset_ = 0.0;
  double zero_mm_ = 0.0;
};

}  // namespace ecs::emulator
