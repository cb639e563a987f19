// One axis of the machine: position loop, transducer, marker and reference switch.
// Does not live here: the path that several axes take together (machine_tool.hpp).
#pragma once

#include <optional>

#include "ecs_emulator/axis_signals.hpp"
#include "ecs_emulator/emulator_settings.hpp"

namespace ecs::emulator {

class AxisOfMachine {
 public:
  AxisOfMachine(const params::MachineAxis& axis, const AxisSettings& settings, double start_mm);

  /// One period: the position loop follows the command; the compensation adds to it with the same lag.
  void step(double command_mm, const AxisDrive& drive, double period_s);

  /// Where the carriage stands: command and compensation after their lag.
  [[nodiscard]] double position_mm() const { return servo_mm_ + compensation_um_ * 1e-3; }
  /// Where it would stand without compensation.
  [[nodiscard]] double servo_mm() const { return servo_mm_; }
  [[nodiscard]] double compensation_um() const { return compensation_um_; }
  [[nodiscard]] Approach approach() const { return approach_; }
  [[nodiscard]] double travel_since_reversal_mm() const { return travel_mm_; }
  /// Counts the reversals.
  [[nodiscard]] std::uint64_t pass() const { return pass_; }
  /// Standing on the command, and the compensation no longer moves.
  [[nodiscard]] bool settled(double command_mm) const;

  /// Takes away the last nanometre: what is settled stands exactly, however long it is left alone.
  void rest(double command_mm, const AxisDrive& drive);

  [[nodiscard]] AxisSignals signals() const;
  [[nodiscard]] bool on_switch() const;
  /// The marker that the axis passed in the last period, if any [mm].
  [[nodiscard]] std::optional<double> marker_mm() const { return marker_mm_; }

  void lose_transducer(bool lost) { transducer_lost_ = lost; }
  /// A burst of noise on the transducer's wires: so many counts too many from now on.
  void miscount(std::int64_t counts) { miscounted_ += counts; }

  /// Machine coordinates of the marker that the controller's reference sequence ends at, and of the switch.
  [[nodiscard]] double datum_marker_mm() const;
  [[nodiscard]] std::array<double, 2> switch_mm() const;
  [[nodiscard]] const AxisSettings& settings() const { return settings_; }
  [[nodiscard]] const params::MachineAxis& facts() const { return facts_; }

 private:
  [[nodiscard]] std::int64_t counts_at(double position_mm) const;
  [[nodiscard]] double asked_um(const AxisDrive& drive) const;
  void follow(double command_mm, double part);
  void watch_marker(double from_mm, double to_mm);

  params::MachineAxis facts_;
  AxisSettings settings_;
  double servo_mm_ = 0.0;
  double compensation_um_ = 0.0;
  double change_um_ = 0.0;  ///< of the compensation, in the last period
  Approach approach_ = Approach::forward;
  double travel_mm_ = 0.0;
  std::uint64_t pass_ = 0;
  std::optional<double> marker_mm_;
  bool transducer_lost_ = false;
  std::int64_t miscounted_ = 0;
};

}  // namespace ecs::emulator
