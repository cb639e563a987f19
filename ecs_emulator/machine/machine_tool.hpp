// The machine tool: axes under a CNC that moves them along a path, as it stands at one instant. Of one axis: its closed
// position loop (control's counter, servo drive, slide, transducer, at the step of the drive: thesis 3.2 and appendix
// A, scaled to the axis; compensation enters at the velocity command), its marker and reference switch, and the wires
// to the unit. Does not live here: the drive's equations (ecs_emulator/drive/servo_drive.hpp), the machine's errors
// (ecs_emulator/errors/true_errors.hpp), who tells it to move (ecs_emulator/workshop/workshop.hpp).
#pragma once

#include <cstdint>
#include <optional>

#include "core/axis.hpp"
#include "ecs_emulator/drive/servo_drive.hpp"
#include "ecs_emulator/errors/true_errors.hpp"
#include "ecs_emulator/machine/path.hpp"
#include "ecs_emulator/settings/emulator.hpp"
#include "params/machine.hpp"

namespace ecs::emulator {

/// From the axis to the unit.
struct AxisSignals {
  std::int64_t counts = 0;         ///< transducer position since the machine was switched on
  bool switch_closed = false;      ///< reference switch
  bool marker = false;             ///< the transducer's marker passed since the last period
  std::int64_t marker_counts = 0;  ///< where, latched by the axis module
  bool transducer_ok = true;       ///< false: signal lost
};

/// From the unit to the axis.
struct AxisDrive {
  std::int32_t dac_counts = 0;
  bool relay_closed = false;
};

using Signals = PerAxis<AxisSignals>;
using Drives = PerAxis<AxisDrive>;

/// From a rotary axis to the unit: its transducer is absolute.
struct RotarySignals {
  std::int64_t counts = 0;
  bool transducer_ok = true;  ///< false: signal lost
};
/// Of A, B, C; nothing: not wired to a unit.
using RotaryWires = PerAxis<std::optional<RotarySignals>>;

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
  /// A burst of noise on the transducer's wires: this many counts too many from now on.
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

/// A rotary axis: it turns evenly to its command, and is there at once.
class RotaryOfMachine {
 public:
  explicit RotaryOfMachine(const params::MachineRotaryAxis& facts);

  void turn_to(double target_deg) { target_deg_ = target_deg; }
  void stop() { target_deg_ = angle_deg_; }
  void step(double period_s);
  [[nodiscard]] double angle_deg() const { return angle_deg_; }
  [[nodiscard]] Approach approach() const { return approach_; }
  [[nodiscard]] bool arrived() const { return angle_deg_ == target_deg_; }
  /// Nothing where the machine file gives no resolution.
  [[nodiscard]] std::optional<RotarySignals> signals() const;
  void lose_transducer(bool lost) { transducer_lost_ = lost; }

 private:
  params::MachineRotaryAxis facts_;
  double angle_deg_ = 0.0;
  double target_deg_ = 0.0;
  Approach approach_ = Approach::forward;  ///< as after referencing
  bool transducer_lost_ = false;
};

/// How far beyond its travel an axis can go before its buffers.
inline constexpr double kOvertravel_mm = 25.0;
/// No control feeds slower.
inline constexpr double kSlowestFeed_mm_min = 1.0;

class MachineTool {
 public:
  explicit MachineTool(const WorkshopMachine& description);

  /// Starts a straight move of all axes to `target_mm`, from the commanded position.
  /// @param feed_mm_min  along the path; 0: rapid
  void move_to(const Vector3& target_mm, double feed_mm_min);
  /// Appends to the path; see Path. Axes that this machine lacks stay at 0.
  void follow(std::span<const PathPiece> pieces) { path_.add(pieces); }
  /// Turns the rotary axes that this machine has, beside the path.
  void turn_to(const Vector3& angle_deg);
  /// Path and rotary axes are at their end (the linear axes may still be catching up).
  [[nodiscard]] bool arrived() const;
  /// Arrived, and nothing moves any more.
  [[nodiscard]] bool settled() const;
  /// Arrived, and no axis further than `window_mm` from its command, apart from what compensation adds.
  [[nodiscard]] bool in_position(double window_mm) const;
  /// Brakes no matter where: the command stays where it is.
  void stop();

  void step(const Drives& drives, double period_s);
  /// @pre settled(); see AxisOfMachine::rest()
  void rest(const Drives& drives);

  [[nodiscard]] Signals signals() const;
  [[nodiscard]] RotaryWires rotary_wires() const;
  [[nodiscard]] RotaryState rotary_state() const;
  /// @param axis  0, 1, 2: A, B, C. @pre the machine has it
  [[nodiscard]] RotaryOfMachine& rotary(std::size_t axis) { return *rotary_[axis]; }
  /// As its errors see it: carriages at their true places.
  [[nodiscard]] MachineState state() const;
  [[nodiscard]] const Vector3& command_mm() const { return path_.command_mm(); }
  [[nodiscard]] const Path& path() const { return path_; }
  [[nodiscard]] bool has(Axis axis) const { return chain_.has(axis); }
  [[nodiscard]] const Chain& chain() const { return chain_; }
  /// @pre has(axis)
  [[nodiscard]] AxisOfMachine& axis(Axis axis) { return *axes_[index_of(axis)]; }
  [[nodiscard]] const AxisOfMachine& axis(Axis axis) const { return *axes_[index_of(axis)]; }
  [[nodiscard]] PerAxis<std::array<double, 2>> travel_mm() const;
  [[nodiscard]] Vector3 datum_mm() const;
  [[nodiscard]] double time_s() const { return time_s_; }
  /// Time passes while everything stands still.
  void wait(double seconds) { time_s_ += seconds; }
  void set_clock(double time_s) { time_s_ = time_s; }
  void load(double load_kg) { load_kg_ = load_kg; }

 private:
  Chain chain_;
  PerAxis<std::optional<AxisOfMachine>> axes_{};
  PerAxis<std::optional<RotaryOfMachine>> rotary_{};
  Path path_;
  double load_kg_ = 0.0;
  double time_s_ = 0.0;
};

/// Where an axis stands when the machine is switched on: on the approach side of its reference switch, clear of it.
[[nodiscard]] double start_position_mm(const params::MachineAxis& axis, const AxisSettings& settings);

}  // namespace ecs::emulator
