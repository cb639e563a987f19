#include "ecs_emulator/thermal/day.hpp"

#include <algorithm>
#include <cmath>

#include "base/units.hpp"
#include "ecs_emulator/random/random.hpp"

namespace ecs::emulator {
namespace {

constexpr double kDay_s = 86'400.0;
constexpr double kHour_s = 3'600.0;
constexpr double kShortest_s = 1'800.0;
constexpr double kLongest_s = 21'600.0;
constexpr std::uint64_t kTemperature = 2000, kPressure = 2001, kHumidity = 2002;  ///< streams of random numbers

}  // namespace

/// Waves of equal size, one in each third of the range of periods: their mean square is the square of the deviation.
Day::Waves Day::wander(double deviation, std::uint64_t seed) {
  Random random(seed);
  Waves waves{};
  double longer = 0.0;
  for (Wave& wave : waves) {
    const double place = (longer + random.uniform()) / static_cast<double>(kWander);
    const double period_s = kShortest_s * std::pow(kLongest_s / kShortest_s, place);
    wave = {deviation * std::sqrt(2.0 / static_cast<double>(kWander)), kTurn / period_s, kTurn * random.uniform()};
    longer += 1.0;
  }
  return waves;
}

double Day::sum(const Waves& waves, double time_s) {
  double value = 0.0;
  for (const Wave& wave : waves) value += wave.size * std::cos(wave.rad_per_s * time_s + wave.phase_rad);
  return value;
}

Day::Day(const DaySettings& settings, std::uint64_t seed) : settings_(settings) {
  temperature_[0] = {settings.swing_degC, kTurn / kDay_s,
                     kTurn * (settings.start_h - settings.warmest_h) * kHour_s / kDay_s};
  const Waves slow = wander(settings.wander_degC, seed_of(seed, kTemperature, 0));
  std::copy(slow.begin(), slow.end(), temperature_.begin() + 1);
  pressure_ = wander(settings.pressure_wander_hPa, seed_of(seed, kPressure, 0));
  humidity_ = wander(settings.humidity_wander_pct, seed_of(seed, kHumidity, 0));
}

double Day::following_degC(double time_s, double body_lag_s, double sensor_lag_s) const {
  double value = settings_.mean_degC;
  for (const Wave& wave : temperature_) {
    if (wave.size == 0.0) continue;
    double size = wave.size;
    double phase_rad = wave.phase_rad;
    for (const double lag_s : {body_lag_s, sensor_lag_s}) {
      size /= std::hypot(1.0, wave.rad_per_s * lag_s);
      phase_rad -= std::atan(wave.rad_per_s * lag_s);
    }
    value += size * std::cos(wave.rad_per_s * time_s + phase_rad);
  }
  return value;
}

Air Day::air(double time_s) const {
  return {air_degC(time_s), settings_.pressure_hPa + sum(pressure_, time_s),
          std::clamp(settings_.humidity_pct + sum(humidity_, time_s), 0.0, 100.0)};
}

}  // namespace ecs::emulator
