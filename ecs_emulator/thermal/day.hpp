// The air of the workshop over the day, and bodies that follow it with a lag, in closed form: no state, any time.
// Does not live here: heat that the machine makes itself (heat.hpp), what air does to light (the laser).
#pragma once

#include <array>
#include <cstdint>

#include "ecs_emulator/thermal/air.hpp"

namespace ecs::emulator {

/// `[air]` of the errors file; without it the air stays as `Air` has it.
struct DaySettings {
  double mean_degC = 20.0;
  double swing_degC = 0.0;   ///< half of the difference between the warmest and the coldest hour
  double warmest_h = 15.0;   ///< hour of the day, 0 … 24
  double start_h = 8.0;      ///< hour of the day at which simulated time begins
  double wander_degC = 0.0;  ///< standard deviation of slow changes from day to day (half an hour to six hours long)
  double pressure_hPa = 1013.25;
  double pressure_wander_hPa = 0.0;
  double humidity_pct = 50.0;
  double humidity_wander_pct = 0.0;
};

/// What follows the air with the time constant `lag_s` once it has stood in it long enough:
/// a wave a·cos(ωt + φ) becomes a/√(1+ω²τ²)·cos(ωt + φ − atan ωτ) (first order lag; two lags act one after the other).
class Day {
 public:
  Day() : Day(DaySettings{}, 0) {}
  /// @param seed  of the slow changes
  Day(const DaySettings& settings, std::uint64_t seed);

  /// @param time_s  simulated
  [[nodiscard]] double air_degC(double time_s) const { return following_degC(time_s, 0.0, 0.0); }
  /// A body that follows the air, seen by a sensor that follows the body. @pre lags 0 or more
  [[nodiscard]] double following_degC(double time_s, double body_lag_s, double sensor_lag_s = 0.0) const;
  [[nodiscard]] Air air(double time_s) const;

 private:
  struct Wave {
    double size = 0.0;  ///< amplitude
    double rad_per_s = 0.0;
    double phase_rad = 0.0;
  };
  static constexpr std::size_t kWander = 3;
  using Waves = std::array<Wave, kWander>;
  [[nodiscard]] static Waves wander(double deviation, std::uint64_t seed);
  [[nodiscard]] static double sum(const Waves& waves, double time_s);

  DaySettings settings_;
  std::array<Wave, 1 + kWander> temperature_{};
  Waves pressure_{};
  Waves humidity_{};
};

}  // namespace ecs::emulator
