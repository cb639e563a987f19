// One axis of the machine: its drive, marker and reference switch, and the wires to the unit.
// Does not live here: the closed loop of the drive (axis_servo.hpp), the path of several axes (machine_tool.hpp).
#pragma once

#include <optional>

#include "ecs_emulator/machine/axis_servo.hpp"
#include "ecs_emulator/machine/axis_signals.hpp"

namespace ecs::emulator {

class AxisOfMachine {
 public:
  /// @param seed  of what the transducer does at random
  AxisOfMachine(const params::MachineAxis& axis, const AxisSettings& settings, double start_mm, std::uint64_t seed);

  /// One period: the drive follows the command, and the voltage of the unit.
  void step(double command_mm, const AxisDrive& drive, double period_s);

  /// Where the carriage stands.
  [[nodiscard]] double position_mm() const { return position_mm_; }
  /// Where it would stand without compensation.
  [[nodiscard]] double servo_mm() const { return position_mm_ - compensation_um_ * 1e-3; }
  /// What the compensation moves it: asked for by the unit, after the lag of the position loop.
  [[nodiscard]] double compensation_um() const { return compensation_um_; }
  [[nodiscard]] Approach approach() const { return approach_; }
  [[nodiscard]] double travel_since_reversal_mm() const { return travel_mm_; }
  /// Counts the reversals.
  [[nodiscard]] std::uint64_t pass() const { return pass_; }
  /// Standing on the command, and the compensation no longer moves.
  [[nodiscard]] bool settled(double command_mm) const;

  /// Takes away the last nanometre of an ideal drive: what is settled stands exactly, however long it is left alone.
  void rest(double command_mm, const AxisDrive& drive);
  /// The control has found its reference position: what the transducer lost before no longer counts.
  void referenced();

  [[nodiscard]] AxisSignals signals() const;
  /// As the switch shows it.
  [[nodiscard]] bool on_switch() const;
  /// The marker that the axis passed in the last period, as its wire shows it [mm].
  [[nodiscard]] std::optional<double> marker_mm() const { return marker_mm_; }

  void lose_transducer(bool lost) { transducer_lost_ = lost; }
  /// The reference switch hangs: it shows the axis on it (true) or off it wherever the axis is; nothing: it works.
  void hang_switch(std::optional<bool> shows) { switch_hangs_ = shows; }
  /// The wire of the marker is broken.
  void lose_marker(bool lost) { marker_lost_ = lost; }
  /// A burst of noise on the transducer's wires: so many counts too many from now on.
  void miscount(std::int64_t counts) { miscounted_ += counts; }

  /// Machine coordinates of the marker that the controller's reference sequence ends at, and of the switch.
  [[nodiscard]] double datum_marker_mm() const;
  [[nodiscard]] std::array<double, 2> switch_mm() const;
  [[nodiscard]] const AxisSettings& settings() const { return settings_; }
  [[nodiscard]] const params::MachineAxis& facts() const { return facts_; }
  /// The closed loop; nothing where the drive is ideal.
  [[nodiscard]] const std::optional<AxisServo>& servo() const { return servo_; }

 private:
  [[nodiscard]] std::int64_t wired(std::int64_t counts) const;
  [[nodiscard]] double measured_mm() const { return servo_ ? servo_->measured_mm() : position_mm_; }
  [[nodiscard]] double asked_um(const AxisDrive& drive) const;
  void drive_to(double command_mm, double asked_um, double period_s);
  void watch_direction(double command_mm);
  [[nodiscard]] double turn_mm() const;
  void watch_marker(double from_mm, double to_mm);

  params::MachineAxis facts_;
  AxisSettings settings_;
  std::optional<AxisServo> servo_;
  PositionTransducer transducer_;
  double command_mm_ = 0.0;
  double position_mm_ = 0.0;
  double ideal_mm_ = 0.0;               ///< of an ideal drive, without compensation
  double extreme_mm_ = 0.0;             ///< reached since the last reversal
  Approach asked_ = Approach::forward;  ///< direction in which the command last moved
  double compensation_um_ = 0.0;
  double change_um_ = 0.0;  ///< of the compensation, in the last period
  Approach approach_ = Approach::forward;
  double travel_mm_ = 0.0;
  std::uint64_t pass_ = 0;
  std::optional<double> marker_mm_;
  bool transducer_lost_ = false;
  bool marker_lost_ = false;
  std::optional<bool> switch_hangs_;
  std::int64_t miscounted_ = 0;
};

}  // namespace ecs::emulator
