#include "ecs_emulator/drive/servo_drive.hpp"

#include "base/units.hpp"

namespace ecs::emulator {
namespace {

/// Below this speed, and held by friction, the motor stands.
constexpr double kStanding_rad_s = 1e-6;

/// q(k) = q(k−1) + T/2 · (f(k) + f(k−1)) (A.2)
double trapezoid(double sum, double before, double now, double step_s) { return sum + 0.5 * step_s * (before + now); }

/// A first order lag by the improved Euler method of A.2.
double lagged(double value, double asked_before, double asked_now, double step_s, double time_s) {
  const double first = (asked_before - value) * step_s / time_s;
  const double second = (asked_now - (value + first)) * step_s / time_s;
  return value + 0.5 * (first + second);
}

}  // namespace

std::int64_t ServoDrive::encoder_pulses() const {
  return static_cast<std::int64_t>(std::floor(angle_rad_ * p_.encoder_pulses_per_rad));
}

double ServoDrive::friction_now(double driving_Nm) const {
  const double speed_rad_s = std::abs(speed_rad_s_);
  const double most_Nm = std::max(p_.friction_Nm, p_.breakaway_Nm);
  if (speed_rad_s <= kStanding_rad_s) return std::clamp(driving_Nm, -most_Nm, most_Nm);
  double size_Nm = p_.friction_Nm;
  if (p_.breakaway_Nm > p_.friction_Nm)  // Stribeck
    size_Nm += (p_.breakaway_Nm - p_.friction_Nm) * std::exp(-speed_rad_s / p_.slip_rad_s);
  return std::copysign(size_Nm, speed_rad_s_);
}

double ServoDrive::acceleration(double current_A, double friction_Nm) const {
  return (p_.torque_Nm_per_A * current_A - friction_Nm) / p_.inertia_kg_m2;
}

void ServoDrive::step(double reference_pulses, double added_V) {
  step_on_counter(std::floor(reference_pulses - angle_rad_ * p_.encoder_pulses_per_rad), added_V);
}

void ServoDrive::stand() {
  error_V_ = integral_Vs_ = asked_A_ = current_A_ = acceleration_rad_s2_ = speed_rad_s_ = 0.0;
}

void ServoDrive::step_on_counter(double counter_pulses, double added_V) {
  dac_V_ = std::clamp(p_.dac_V_per_pulse * counter_pulses, -p_.dac_limit_V, p_.dac_limit_V);
  const double command_V = std::clamp(dac_V_ + added_V, -p_.dac_limit_V, p_.dac_limit_V);

  const double error_V = p_.preamplifier * command_V - tacho_V();
  integral_Vs_ = trapezoid(integral_Vs_, error_V_, error_V, p_.step_s);
  error_V_ = error_V;
  const double asked_A = p_.regulator_gain * (error_V + integral_Vs_ / p_.integral_time_s);
  current_A_ = lagged(current_A_, asked_A_, asked_A, p_.step_s, p_.current_time_s);
  asked_A_ = asked_A;

  const double driving_Nm = p_.torque_Nm_per_A * current_A_;
  const double before_rad_s2 = acceleration_rad_s2_;
  const double before_rad_s = speed_rad_s_;
  acceleration_rad_s2_ = acceleration(current_A_, friction_now(driving_Nm));
  speed_rad_s_ = trapezoid(speed_rad_s_, before_rad_s2, acceleration_rad_s2_, p_.step_s);
  const bool turned = before_rad_s * speed_rad_s_ < 0.0;
  if (turned && std::abs(driving_Nm) <= std::max(p_.friction_Nm, p_.breakaway_Nm)) {  // friction stops it, and no more
    speed_rad_s_ = 0.0;
    acceleration_rad_s2_ = 0.0;
  }
  angle_rad_ = trapezoid(angle_rad_, before_rad_s, speed_rad_s_, p_.step_s);
  ++steps_;
}

namespace {

bool uneven(const TransducerSettings& s) {
  return s.period_mm > 0.0 && (s.offset != 0.0 || s.imbalance != 0.0 || s.quadrature_mrad != 0.0);
}

}  // namespace

PositionTransducer::PositionTransducer(const TransducerSettings& settings, Transducer kind, double resolution_um,
                                       double start_mm, std::uint64_t seed)
    : settings_(settings),
      carrier_(kind == Transducer::resolver && settings.excitation == Excitation::stator),
      counts_per_mm_(1000.0 / resolution_um),
      position_mm_(start_mm),
      random_(seed) {
  since_carrier_s_ = carrier_ ? 1.0 / settings_.carrier_Hz : 0.0;
  follow(start_mm, 0.0);
}

double PositionTransducer::shown_mm(double position_mm) const {
  if (!uneven(settings_)) return position_mm;
  const double angle = kTurn * position_mm / settings_.period_mm;
  const double sine = (1.0 + 0.5 * settings_.imbalance) * std::sin(angle) + settings_.offset;
  const double cosine = (1.0 - 0.5 * settings_.imbalance) * std::cos(angle + settings_.quadrature_mrad * 1e-3);
  const double error = std::remainder(std::atan2(sine, cosine) - angle, kTurn);
  return position_mm + error / kTurn * settings_.period_mm;
}

void PositionTransducer::lose(double moved_mm, double seconds) {
  const double fastest_mm = settings_.fastest_mm_min / 60.0 * seconds;
  if (settings_.fastest_mm_min > 0.0 && seconds > 0.0 && std::abs(moved_mm) > fastest_mm) {
    losing_ += (moved_mm - std::copysign(fastest_mm, moved_mm)) * counts_per_mm_;
    const double whole = std::trunc(losing_);
    lost_ += static_cast<std::int64_t>(whole);
    losing_ -= whole;
  }
  const double before_mm = position_mm_ - settings_.dirt_mm;
  const double after_mm = before_mm + moved_mm;
  if (settings_.dirt_counts == 0 || (before_mm < 0.0) == (after_mm < 0.0)) return;
  const auto count = static_cast<std::int64_t>(random_.uniform() * static_cast<double>(settings_.dirt_counts + 1));
  lost_ += moved_mm > 0.0 ? count : -count;
}

void PositionTransducer::follow(double position_mm, double seconds) {
  lose(position_mm - position_mm_, seconds);
  position_mm_ = position_mm;
  if (carrier_) {
    since_carrier_s_ += seconds;
    if (since_carrier_s_ < 1.0 / settings_.carrier_Hz) return;
    since_carrier_s_ = 0.0;
  }
  const double noise_mm = settings_.noise_um > 0.0 ? settings_.noise_um * 1e-3 * random_.normal() : 0.0;
  counts_ = counts_at(position_mm + noise_mm);
}

std::int64_t PositionTransducer::counts_at(double position_mm) const {
  return static_cast<std::int64_t>(std::floor(shown_mm(position_mm) * counts_per_mm_ + 0.5)) - lost_;
}

}  // namespace ecs::emulator
