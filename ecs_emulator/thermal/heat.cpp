#include "ecs_emulator/thermal/heat.hpp"

#include <cmath>

#include "ecs_emulator/random/random.hpp"

namespace ecs::emulator {
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
