// The position servo of one axis as thesis 3.2.1 and appendix A describe it: reference pulses, up-down counter, D/A
// converter, tachogenerator, PI regulator, current regulator, motor, friction, screw.
// Does not live here: backlash and errors of the slide behind the screw (modules/rig/rig.hpp), what the reference
// pulses ask for.
#pragma once

#include <cstdint>

namespace ecs::emulator {

/// Appendix A. The defaults are its printed values, but for the tachogenerator: with the printed 0.632298 V s/rad the
/// drive stands at its 10 V limit at 20 mm/s; a tenth of it gives the response of figures 3.3 and 3.4.
struct ServoParameters {
  double dac_V_per_pulse = 0.0099734;            ///< Kd
  double dac_limit_V = 10.0;                     ///<
  double preamplifier = 1.0 / 3.0;               ///< K
  double tacho_V_s_per_rad = 0.0632298;          ///< Kw
  double regulator_gain = 30.06;                 ///< Ka
  double integral_time_s = 0.0204;               ///< Ti
  double current_time_s = 0.0003;                ///< Tc
  double torque_Nm_per_A = 0.5;                  ///< Kt
  double inertia_kg_m2 = 0.00023 + 0.000517711;  ///< Jm + J1
  double friction_Nm = 0.02538878;               ///< T1, Coulomb
  double breakaway_Nm = 0.0;                     ///< at standstill, where it is more than T1: the axis sticks and slips
  double slip_rad_s = 1.0;                       ///< speed at which friction has fallen to T1 by a factor e
  double encoder_pulses_per_rad = 636.62;        ///< Ke: 4000 pulses a revolution
  double screw_mm_per_rad = 1.2732395;           ///< Ks: 8 mm pitch; appendix A prints 1.2773
  double step_s = 0.0001;                        ///< of the integration
};

/// One axis; time goes on by `step_s` a step.
class ServoDrive {
 public:
  explicit ServoDrive(const ServoParameters& parameters) : p_(parameters) {}

  /// Fed back by the encoder on its own motor.
  /// @param reference_pulses  asked for so far, whole or not: what is left of a pulse waits
  /// @param added_V           compensation, added to the velocity command (thesis 3.3, strategy 3)
  void step(double reference_pulses, double added_V);
  /// Fed back by any transducer. @param counter_pulses  of the up-down counter: asked for less fed back
  void step_on_counter(double counter_pulses, double added_V);
  /// Friction holds the motor where it is: nothing moves, no current flows.
  void stand();

  [[nodiscard]] double dac_V() const { return dac_V_; }  ///< velocity command of the controller
  [[nodiscard]] double tacho_V() const { return p_.tacho_V_s_per_rad * speed_rad_s_; }
  [[nodiscard]] double current_A() const { return current_A_; }
  [[nodiscard]] double speed_rad_s() const { return speed_rad_s_; }
  [[nodiscard]] double angle_rad() const { return angle_rad_; }
  [[nodiscard]] std::int64_t encoder_pulses() const;
  [[nodiscard]] double nut_mm() const { return angle_rad_ * p_.screw_mm_per_rad; }  ///< of a perfect screw
  [[nodiscard]] double time_s() const { return static_cast<double>(steps_) * p_.step_s; }
  [[nodiscard]] const ServoParameters& parameters() const { return p_; }

 private:
  [[nodiscard]] double acceleration(double current_A, double friction_Nm) const;
  [[nodiscard]] double friction_now(double driving_Nm) const;

  ServoParameters p_;
  double dac_V_ = 0.0;
  double error_V_ = 0.0;  ///< velocity error
  double integral_Vs_ = 0.0;
  double asked_A_ = 0.0;  ///< current command
  double current_A_ = 0.0;
  double acceleration_rad_s2_ = 0.0;
  double speed_rad_s_ = 0.0;
  double angle_rad_ = 0.0;
  std::uint64_t steps_ = 0;
};

}  // namespace ecs::emulator
