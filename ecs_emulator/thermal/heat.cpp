#include "ecs_emulator/thermal/heat.hpp"

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

ScrewHeat::ScrewHeat(const ScrewSettings& settings, const std::array<double, 2>& travel_mm) : settings_(settings) {
  low_mm_ = std::min(travel_mm[0], settings.fixed_bearing_mm);
  const double length_mm = std::max(travel_mm[1], settings.fixed_bearing_mm) - low_mm_;
  const auto cells = static_cast<std::size_t>(std::max(1.0, std::floor(length_mm / settings.cell_mm)));
  cell_mm_ = std::max(length_mm, settings.cell_mm) / static_cast<double>(cells);
  cells_per_mm_ = 1.0 / cell_mm_;
  kept_ = std::exp(-1.0 / settings.loss_s);
  const double capacity_J_degC = settings.heat_capacity_J_per_m_degC * cell_mm_ * 1e-3;
  degC_per_J_ = -std::expm1(-1.0 / settings.loss_s) * settings.loss_s / capacity_J_degC;
  diffusion_ = settings.diffusivity_mm2_s / (cell_mm_ * cell_mm_);
  rise_degC_.assign(cells, 0.0);
  work_J_.assign(cells, 0.0);
}

void ScrewHeat::step() {
  double before = rise_degC_.front();  // of the cell below, as it was
  for (std::size_t i = 0; i < rise_degC_.size(); ++i) {
    const double here = rise_degC_[i];
    const double above = i + 1 < rise_degC_.size() ? rise_degC_[i + 1] : here;
    rise_degC_[i] = (here + diffusion_ * (before - 2.0 * here + above)) * kept_ + work_J_[i] * degC_per_J_;
    work_J_[i] = 0.0;
    before = here;
  }
}

double ScrewHeat::integral_to(double at_mm) const {
  const double place = std::clamp((at_mm - low_mm_) * cells_per_mm_, 0.0, static_cast<double>(rise_degC_.size()));
  const auto whole = static_cast<std::size_t>(place);
  double sum = 0.0;
  for (std::size_t i = 0; i < whole; ++i) sum += rise_degC_[i];
  if (whole < rise_degC_.size()) sum += rise_degC_[whole] * (place - static_cast<double>(whole));
  return sum * cell_mm_;
}

double ScrewHeat::growth_um(double at_mm, double common_degC) const {
  const double warm_mm_degC = integral_to(at_mm) - integral_to(settings_.fixed_bearing_mm) +
                              (common_degC - 20.0) * (at_mm - settings_.fixed_bearing_mm);
  return settings_.expansion_um_per_m_degC * warm_mm_degC * 1e-3;
}

namespace {

constexpr double kStep_s = 1.0;
constexpr std::uint64_t kSensorStream = 2100;  ///< of random numbers; one for each sensor

/// Part of a difference that a first-order body makes up in one step.
double part_of(double lag_s) { return lag_s > 0.0 ? 1.0 - std::exp(-kStep_s / lag_s) : 1.0; }

double above(const BodySettings& body, const Day& day) {
  return body.start_degC ? *body.start_degC - day.following_degC(0.0, body.lag_s) : 0.0;
}

}  // namespace

Heat::Heat(const HeatSettings& settings, const PerAxis<std::array<double, 2>>& travel_mm, std::uint64_t seed)
    : settings_(settings), day_(settings.air ? Day(*settings.air, seed) : Day()), seed_(seed) {
  for (const ScrewSettings& screw : settings_.screws) screws_.emplace_back(screw, travel_mm[index_of(screw.axis)]);
  column_degC_ = above(settings_.column, day_);
  material_degC_ = above(settings_.material, day_);
  for (std::size_t i = 0; i < settings_.sensors.size(); ++i) {
    shown_degC_.push_back(own_degC(settings_.sensors[i]));
    first_degC_.push_back(degC_at(i, 0.0));
  }
}

double Heat::rpm_at(double time_s) const {
  if (commanded_rpm_) return *commanded_rpm_;
  double rpm = 0.0;
  for (const auto& [from_s, speed_rpm] : settings_.spindle->steps)
    if (from_s <= time_s) rpm = speed_rpm;
  return rpm;
}

void Heat::step() {
  for (ScrewHeat& screw : screws_) screw.step();
  column_degC_ *= 1.0 - part_of(settings_.column.lag_s);
  material_degC_ *= 1.0 - part_of(settings_.material.lag_s);
  if (settings_.spindle) {
    const double towards_degC = settings_.spindle->degC_per_1000_rpm * rpm_at(next_s_ - kStep_s) * 1e-3;
    spindle_degC_ += (towards_degC - spindle_degC_) * part_of(settings_.spindle->lag_s);
  }
  for (std::size_t i = 0; i < shown_degC_.size(); ++i)
    shown_degC_[i] += (own_degC(settings_.sensors[i]) - shown_degC_[i]) * part_of(settings_.sensors[i].lag_s);
  next_s_ += kStep_s;
}

double Heat::lag_of(const SensorSettings& sensor) const {
  switch (sensor.of) {
    case SensorSettings::Of::material:
      return settings_.material.lag_s;
    case SensorSettings::Of::column:
      return settings_.column.lag_s;
    case SensorSettings::Of::spindle:
      return settings_.spindle ? settings_.spindle->lag_s : 0.0;
    case SensorSettings::Of::screw:
      for (const ScrewSettings& screw : settings_.screws)
        if (screw.axis == sensor.axis) return screw.loss_s;
      return 0.0;
    case SensorSettings::Of::air:
      break;
  }
  return 0.0;
}

double Heat::own_degC(const SensorSettings& sensor) const {
  switch (sensor.of) {
    case SensorSettings::Of::material:
      return material_degC_;
    case SensorSettings::Of::column:
      return column_degC_;
    case SensorSettings::Of::spindle:
      return spindle_degC_;
    case SensorSettings::Of::screw:
      for (const ScrewHeat& screw : screws_)
        if (screw.settings().axis == sensor.axis) return screw.rise_degC(sensor.at_mm);
      return 0.0;
    case SensorSettings::Of::air:
      break;
  }
  return 0.0;
}

double Heat::material_degC(double time_s) const {
  return day_.following_degC(time_s, settings_.material.lag_s) + material_degC_;
}

double Heat::degC_at(std::size_t sensor, double time_s) const {
  const SensorSettings& which = settings_.sensors[sensor];
  return day_.following_degC(time_s, lag_of(which)) + own_degC(which);
}

std::vector<NamedTemperature> Heat::readings(double time_s) const {
  std::vector<NamedTemperature> shown;
  for (std::size_t i = 0; i < settings_.sensors.size(); ++i) {
    const SensorSettings& sensor = settings_.sensors[i];
    double degC = day_.following_degC(time_s, lag_of(sensor), sensor.lag_s) + shown_degC_[i] + sensor.offset_degC;
    if (sensor.noise_degC > 0.0) {
      // The same at the same time, whoever looks and how often.
      const auto moment = static_cast<std::uint64_t>(std::llround(time_s * 1e3));
      degC += sensor.noise_degC * Random(seed_of(seed_, kSensorStream + i, moment)).normal();
    }
    if (sensor.resolution_degC > 0.0) {
      const double per_degC = 1.0 / sensor.resolution_degC;
      degC = std::round(degC * per_degC) / per_degC;
    }
    shown.emplace_back(sensor.name, degC);
  }
  return shown;
}

void Heat::add_errors(const Vector3& position_mm, double time_s, ComponentValues& values) const {
  for (const ScrewHeat& screw : screws_) {
    const Axis axis = screw.settings().axis;
    if (!screw.settings().positions) continue;
    values[index_of(curve_of(static_cast<Sense>(index_of(axis)), axis))] +=
        screw.growth_um(position_mm[index_of(axis)], day_.following_degC(time_s, screw.settings().loss_s));
  }
  if (!settings_.spindle) return;
  const SpindleSettings& spindle = *settings_.spindle;
  values[index_of(curve_of(static_cast<Sense>(index_of(spindle.axis)), spindle.axis))] +=
      spindle.growth_um_per_degC * spindle_degC_;
  if (spindle.tilt)
    values[index_of(curve_of(*spindle.tilt, spindle.axis))] += spindle.tilt_um_per_m_degC * spindle_degC_;
}

}  // namespace ecs::emulator
