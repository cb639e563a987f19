// One axis in its closed position loop: control's counter, servo drive, slide, transducer, at the step of the drive
// (thesis 3.2 and appendix A, scaled to the axis). Compensation enters at the velocity command.
// Does not live here: the drive's equations (ecs_emulator/drive/servo_drive.hpp), switch and marker
// (axis_of_machine.hpp).
#pragma once

#include "ecs_emulator/drive/servo_drive.hpp"
#include "ecs_emulator/drive/slide.hpp"
#include "ecs_emulator/drive/transducer.hpp"
#include "ecs_emulator/settings/axis.hpp"
#include "params/machine.hpp"

namespace ecs::emulator {

/// The drive of appendix A on the screw of this axis: its position loop has the gain `kv_per_s`, its D/A converter
/// reaches 10 V a fifth above rapid speed, its velocity loop is as fast as that of appendix A.
[[nodiscard]] ServoParameters servo_parameters_for(const params::MachineAxis& axis, const AxisSettings& settings);

class AxisServo {
 public:
  AxisServo(const params::MachineAxis& axis, const AxisSettings& settings, double start_mm);

  /// The command goes evenly to `command_mm` within `seconds`; part of a drive step that is left waits.
  /// @param added_um    compensation, as the distance that its voltage asks for
  /// @param transducer  follows the axis and closes the loop
  void step(double command_mm, double added_um, double seconds, PositionTransducer& transducer);

  /// True place of the slide.
  [[nodiscard]] double position_mm() const { return slide_.position_mm(); }
  /// True place of what the transducer sits on: slide or nut.
  [[nodiscard]] double measured_mm() const { return feedback_ == Feedback::motor ? nut_mm() : slide_.position_mm(); }
  /// Within a pulse of what is asked for, for twice the lag of the loop: held by friction until something else is
  /// asked.
  [[nodiscard]] bool at_rest() const { return at_rest_; }
  [[nodiscard]] const ServoDrive& drive() const { return drive_; }
  /// Asked for less fed back [pulses], as the up-down counter shows it.
  [[nodiscard]] double counter_pulses() const { return counter_pulses_; }

 private:
  void drive_step(double command_mm, double added_pulses, PositionTransducer& transducer);
  void judge_standing(double added_pulses, double seconds);
  [[nodiscard]] double nut_mm() const { return start_mm_ + drive_.nut_mm(); }

  Feedback feedback_;
  double pulses_per_mm_;
  ServoDrive drive_;
  Slide slide_;
  double start_mm_ = 0.0;
  double standing_s_ = 0.0;
  double command_mm_ = 0.0;
  double added_um_ = 0.0;
  double counter_pulses_ = 0.0;
  double owed_s_ = 0.0;
  double still_s_ = 0.0;
  bool at_rest_ = true;
};

}  // namespace ecs::emulator
