// One axis of the virtual machine tool as its builder knows it: the table `[emulator.axis.X]` of the machine file
// (docs/emulator.md). Does not live here: what the axis does (axis_of_machine.hpp).
#pragma once

#include <cstdint>

#include "core/parameters.hpp"
#include "ecs_emulator/drive/slide.hpp"
#include "ecs_emulator/drive/transducer.hpp"

namespace ecs::emulator {

enum class DriveKind : std::uint8_t {
  servo,  ///< the drive of appendix A in its closed loop, step by step (axis_servo.hpp)
  ideal,  ///< follows its command with one lag, to any fineness
};
/// Where the transducer sits.
enum class Feedback : std::uint8_t {
  scale,  ///< on the slide
  motor,  ///< on the screw: play and wind-up stay outside the loop
};

/// Drive, transducer wiring and reference switch of one axis.
struct AxisSettings {
  DriveKind drive = DriveKind::servo;
  Feedback feedback = Feedback::scale;
  double friction_Nm = 0.02538878;  ///< at the motor, Coulomb
  double breakaway_Nm = 0.0;        ///< at standstill, where it is more: stick-slip
  double slip_mm_s = 1.0;           ///< speed over which friction falls from the one to the other; above 0
  SlideSettings slide{};
  TransducerSettings transducer{};
  double dac_um_per_count = 0.1;        ///< what one D/A count moves the axis; the sign is the wiring of the amplifier
  double kv_per_s = 30.0;               ///< gain of the position loop, above 0
  double acceleration_mm_s2 = 500.0;    ///< above 0
  double rapid_mm_min = 10'000.0;       ///< above 0
  double servo_lag_um_per_m_min = 0.0;  ///< how far the axis lags behind a reading taken on the fly
  int count_polarity = 1;               ///< −1: the transducer counts backwards
  // referencing
  DatumKind reference_kind = DatumKind::fanuc;
  Approach reference_direction = Approach::forward;  ///< onto the switch
  double reference_speed_mm_min = 1000.0;            ///< above 0
  double creep_speed_mm_min = 300.0;                 ///< from the switch to the marker; above 0
  double marker_pitch_mm = 10.0;                     ///< one marker a revolution; above 0
  double null_offset_mm = 0.0;                       ///< from the datum marker to the reference position
  double switch_width_mm = 10.0;                     ///< above 0
  int switch_polarity = 1;                           ///< +1: closed while the axis stands on it
};

}  // namespace ecs::emulator
