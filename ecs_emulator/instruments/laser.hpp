// The instruments that measure the machine: laser interferometer, electronic level, indicator against a square.
// They see the tool against the workpiece, whatever makes it err, and add their own noise and bad set-up.
// Does not live here: where the machine goes (measurement.hpp), what is done with readings (the host).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>

#include "core/axis.hpp"
#include "ecs_emulator/errors/kinematics.hpp"
#include "ecs_emulator/random/random.hpp"
#include "ecs_emulator/settings/emulator.hpp"
#include "ecs_emulator/thermal/heat.hpp"

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
/// It measures against a square or a straight edge, which has errors of its own.
[[nodiscard]] constexpr bool has_artefact(InstrumentKind kind) {
  return kind == InstrumentKind::straightness || kind == InstrumentKind::square;
}
/// Why this instrument cannot measure that; empty if it can.
[[nodiscard]] std::string_view refusal(InstrumentKind kind, Sense sense, Axis moving);

/// What an instrument has before it at one instant.
struct Sight {
  ToolPose pose;           ///< tool against workpiece, actual − target
  double target_mm = 0.0;  ///< of the moving axis
  double time_s = 0.0;
  double stood_s = 1e9;  ///< since the machine last moved
  Air air;
  double material_degC = 20.0;  ///< of the scale or workpiece
};

class Instrument {
 public:
  virtual ~Instrument() = default;
  Instrument(const Instrument&) = delete;
  Instrument& operator=(const Instrument&) = delete;

  /// Sets the display to zero here (that of straightness optics keeps the offset of its set-up).
  virtual void zero(const Sight& sight) = 0;
  /// Turns the square: the line of the axis it was nulled along rises by `slope_um_per_m`.
  virtual void null_square(double /*slope_um_per_m*/) {}
  /// One reading, um or um/m, with noise, to the resolution of the display. @pre calls in the order of time
  [[nodiscard]] double read(const Sight& sight, Random& random);

 protected:
  Instrument(double noise, double resolution) : noise_(noise), resolution_(resolution) {}
  /// What it would show without white noise.
  [[nodiscard]] virtual double shown(const Sight& sight, Random& random) = 0;
  /// Standard deviation of the white noise.
  [[nodiscard]] virtual double noise(const Sight& /*sight*/) const { return noise_; }

 private:
  double noise_;
  double resolution_;
};

/// Sets it up; slope and offset of a straight-edge are drawn here.
/// @pre refusal(kind, sense, moving) is empty
[[nodiscard]] std::unique_ptr<Instrument> set_up(InstrumentKind kind, Sense sense, Axis moving,
                                                 const LaserSettings& settings, Random& random);

}  // namespace ecs::emulator
