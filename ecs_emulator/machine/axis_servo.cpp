#include "ecs_emulator/machine/axis_servo.hpp"

#include <cmath>
#include <numbers>

namespace ecs::emulator {
namespace {

constexpr double kUsualPitch_mm = 10.0;
constexpr double kSpeedReserve = 1.2;    ///< of the drive above rapid
constexpr double kStandingLags = 2.0;    ///< so many times 1/Kv near the place asked for: it stands
constexpr double kNear_pulses = 1.0;     ///< from the place asked for
constexpr double kStandingPulses = 3.0;  ///< speed that so many pulses in the counter ask for

}  // namespace

ServoParameters servo_parameters_for(const params::MachineAxis& axis, const AxisSettings& settings) {
  ServoParameters p;
  const double regulator = p.regulator_gain * p.tacho_V_s_per_rad;
  p.screw_mm_per_rad = axis.screw_pitch_mm.value_or(kUsualPitch_mm) / (2.0 * std::numbers::pi);
  p.encoder_pulses_per_rad = p.screw_mm_per_rad * 1000.0 / axis.resolution_um;
  const double fastest_rad_s = kSpeedReserve * settings.rapid_mm_min / 60.0 / p.screw_mm_per_rad;
  p.tacho_V_s_per_rad = p.preamplifier * p.dac_limit_V / fastest_rad_s;
  p.regulator_gain = regulator / p.tacho_V_s_per_rad;
  p.dac_V_per_pulse = settings.kv_per_s * p.tacho_V_s_per_rad / (p.preamplifier * p.encoder_pulses_per_rad);
  p.friction_Nm = settings.friction_Nm;
  p.breakaway_Nm = settings.breakaway_Nm;
  p.slip_rad_s = settings.slip_mm_s / p.screw_mm_per_rad;
  return p;
}

AxisServo::AxisServo(const params::MachineAxis& axis, const AxisSettings& settings, double start_mm)
    : feedback_(settings.feedback),
      pulses_per_mm_(1000.0 / axis.resolution_um),
      drive_(servo_parameters_for(axis, settings)),
      slide_(settings.slide, start_mm),
      start_mm_(start_mm),
      standing_s_(kStandingLags / settings.kv_per_s),
      command_mm_(start_mm) {}

void AxisServo::drive_step(double command_mm, double added_pulses, PositionTransducer& transducer) {
  const double asked_pulses = std::floor(command_mm * pulses_per_mm_ + 0.5);
  counter_pulses_ = asked_pulses - static_cast<double>(transducer.counts());
  drive_.step_on_counter(counter_pulses_, added_pulses * drive_.parameters().dac_V_per_pulse);
  slide_.follow(nut_mm());
  transducer.follow(measured_mm(), drive_.parameters().step_s);
}

void AxisServo::step(double command_mm, double added_um, double seconds, PositionTransducer& transducer) {
  const bool same = command_mm == command_mm_ && added_um == added_um_;
  if (at_rest_ && same) return;
  at_rest_ = false;
  if (!same) still_s_ = 0.0;
  const double from_mm = command_mm_;
  command_mm_ = command_mm;
  added_um_ = added_um;
  owed_s_ += seconds;
  const auto steps = static_cast<int>(owed_s_ / drive_.parameters().step_s + 1e-6);
  owed_s_ -= steps * drive_.parameters().step_s;
  const double added_pulses = added_um * 1e-3 * pulses_per_mm_;
  for (int k = 1; k <= steps; ++k)
    drive_step(k == steps ? command_mm : from_mm + (command_mm - from_mm) * k / steps, added_pulses, transducer);
  judge_standing(added_pulses, seconds);
}

void AxisServo::judge_standing(double added_pulses, double seconds) {
  const ServoParameters& p = drive_.parameters();
  const double slow_rad_s = kStandingPulses * p.dac_V_per_pulse * p.preamplifier / p.tacho_V_s_per_rad;
  const bool near = std::abs(counter_pulses_ + added_pulses) <= kNear_pulses;
  const bool slow = std::abs(drive_.speed_rad_s()) <= slow_rad_s;
  still_s_ = near && slow ? still_s_ + seconds : 0.0;
  if (still_s_ < standing_s_) return;
  at_rest_ = true;
  still_s_ = owed_s_ = 0.0;
  drive_.stand();
}

}  // namespace ecs::emulator
