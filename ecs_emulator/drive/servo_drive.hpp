// The position servo of one axis as thesis 3.2.1 and appendix A describe it: reference pulses, up-down counter, D/A
// converter, tachogenerator, PI regulator, current regulator, motor, friction, screw; and what follows its nut: the
// slide, behind play and wind-up, and the position transducer, from the place where it is to the counts that control
// and unit read. Does not live here: what the transducer sits on and the wires to the unit
// (ecs_emulator/machine/machine_tool.hpp), geometry of the guideway (ecs_emulator/errors/true_errors.hpp), what the
// reference pulses ask for.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/parameters.hpp"
#include "ecs_emulator/random/random.hpp"

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

struct SlideSettings {
  double lost_motion_um = 0.0;     ///< play between nut and slide
  double wind_up_um = 0.0;         ///< how far friction holds the slide back, each way
  double wind_up_length_mm = 1.0;  ///< the wind-up reverses over this travel, exponentially; above 0
};

/// The slide stays within the play of the nut, and hangs back by the wind-up: from one full wind-up to the other it is
/// δ = c·(1 − 2·e^(−u/u₀)), u = travel since the reversal (the friction model of Dahl, 1968, exponent 1).
class Slide {
 public:
  Slide(const SlideSettings& settings, double nut_mm)
      : settings_(settings), nut_mm_(nut_mm), driven_mm_(nut_mm), slide_mm_(nut_mm) {}

  void follow(double nut_mm) {
    const double moved_mm = nut_mm - nut_mm_;
    nut_mm_ = nut_mm;
    if (settings_.wind_up_um > 0.0) {
      const double full_mm = std::copysign(settings_.wind_up_um * 1e-3, moved_mm);
      wind_up_mm_ += (full_mm - wind_up_mm_) * std::min(1.0, std::abs(moved_mm) / settings_.wind_up_length_mm);
    }
    const double play_mm = 0.5e-3 * settings_.lost_motion_um;
    driven_mm_ = std::clamp(driven_mm_, nut_mm - play_mm, nut_mm + play_mm);
    slide_mm_ = driven_mm_ - wind_up_mm_;
  }
  [[nodiscard]] double position_mm() const { return slide_mm_; }

 private:
  SlideSettings settings_;
  double nut_mm_ = 0.0;
  double driven_mm_ = 0.0;
  double wind_up_mm_ = 0.0;
  double slide_mm_ = 0.0;
};

/// How a resolver is fed (thesis 5.2).
enum class Excitation : std::uint8_t {
  rotor,   ///< the amplitudes of the two stator signals are compared: follows at once
  stator,  ///< the phase of the rotor signal is taken once a period of the carrier
};

/// `[emulator.axis.X.transducer]`. Offset, imbalance and quadrature are those of the two signals in quadrature, as a
/// part of their amplitude: they make the subdivision of one period uneven.
struct TransducerSettings {
  double period_mm = 0.0;        ///< of the electrical signal: grating or turn of the resolver; 0: divided perfectly
  double offset = 0.0;           ///< of the sine: an error once a period
  double imbalance = 0.0;        ///< sine less cosine: twice a period
  double quadrature_mrad = 0.0;  ///< off the right angle: twice a period
  Excitation excitation = Excitation::rotor;
  double carrier_Hz = 2500.0;    ///< of a stator-excited resolver
  double noise_um = 0.0;         ///< standard deviation
  double fastest_mm_min = 0.0;   ///< above it counts are lost; 0: never
  double dirt_mm = 0.0;          ///< a dirty place of the scale …
  std::int64_t dirt_counts = 0;  ///< … loses up to this many counts whenever it is passed
};

class PositionTransducer {
 public:
  /// @param resolution_um  of one count; counts change halfway between two of them
  PositionTransducer(const TransducerSettings& settings, Transducer kind, double resolution_um, double start_mm,
                     std::uint64_t seed);

  /// Follows what it sits on for a while.
  void follow(double position_mm, double seconds);

  /// What it shows: counts since it stood at 0, losses included.
  [[nodiscard]] std::int64_t counts() const { return counts_; }
  /// What it showed, or will show, where it stands at `position_mm`, but for its noise.
  [[nodiscard]] std::int64_t counts_at(double position_mm) const;
  /// Counts lost since the machine was last referenced.
  [[nodiscard]] std::int64_t lost() const { return lost_; }
  /// The control counts again from its reference position.
  void referenced() { lost_ = 0; }
  /// Where it says it is, before it is cut into counts: place and error of the subdivision [mm].
  [[nodiscard]] double shown_mm(double position_mm) const;

 private:
  void lose(double moved_mm, double seconds);

  TransducerSettings settings_;
  bool carrier_ = false;
  double counts_per_mm_ = 1000.0;
  double position_mm_ = 0.0;
  double since_carrier_s_ = 0.0;
  std::int64_t counts_ = 0;
  std::int64_t lost_ = 0;
  double losing_ = 0.0;  ///< part of a count not yet lost
  Random random_;
};

}  // namespace ecs::emulator
