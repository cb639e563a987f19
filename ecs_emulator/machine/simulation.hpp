// Machine and unit in one simulated time, held to the wall clock where wanted: the tick that joins them, and motions
// run to their end. Does not live here: what the person in the workshop does (ecs_emulator/instruments/measurement.hpp,
// ecs_emulator/workshop/procedures.hpp).
#pragma once

#include <cstdint>
#include <ctime>
#include <functional>
#include <optional>

#include "ecs_emulator/errors/kinematics.hpp"
#include "ecs_emulator/errors/true_errors.hpp"
#include "ecs_emulator/machine/machine_tool.hpp"
#include "ecs_emulator/random/random.hpp"
#include "ecs_emulator/thermal/heat.hpp"

namespace ecs::emulator {

/// What became of the periods so far.
struct RealTimeRecord {
  std::uint64_t periods = 0;
  std::uint64_t missed = 0;    ///< started a whole period or more after they were due
  double worst_late_us = 0.0;  ///< of any period
  bool fifo = false;           ///< the system gave this process a real-time priority
};

class RealTime {
 public:
  /// Asks the system for a real-time priority; goes on without where it is refused.
  RealTime();

  /// Returns when the next period is due. After a stop of more than a quarter of a second, time starts again: the
  /// periods left out count as missed.
  void wait(double period_s);

  /// The next period is due already, or long past.
  [[nodiscard]] bool is_behind(double period_s) const;

  [[nodiscard]] const RealTimeRecord& record() const { return record_; }

 private:
  timespec due_{};
  RealTimeRecord record_;
};

/// What the wires from the control say; nothing: there is no such wire.
struct ControlWires {
  std::optional<std::uint16_t> tool;   ///< number of the tool in the spindle; 0: none
  std::optional<bool> power_on;        ///< the control is ready: its drives have power, its position loops are closed
  std::optional<double> deviation_um;  ///< of an instrument that stays on the machine, ten times a second
  friend bool operator==(const ControlWires&, const ControlWires&) = default;
};

/// Whatever stands between the machine's transducers and its drives.
class Compensator {
 public:
  virtual ~Compensator() = default;
  /// One period of its loop.
  [[nodiscard]] virtual Drives tick(const Signals& signals) = 0;
  [[nodiscard]] virtual double period_s() const = 0;
  /// It has live inputs, or rows that follow them: sense() is wanted.
  [[nodiscard]] virtual bool senses() const { return false; }
  /// @param shown    by the machine's sensors now
  /// @param seconds  of the workshop's clock since the last time, 0 while that stands still
  virtual void sense(const std::vector<NamedTemperature>& /*shown*/, double /*seconds*/) {}
  /// The wires from the control, when they are connected and whenever one changes.
  virtual void control(const ControlWires& /*wires*/) {}
  /// Before every period, where a rotary axis of the machine is wired.
  virtual void turned(const RotaryWires& /*wires*/) {}
  /// Nothing of it waits for time to pass: periods in which nothing moves may be left out.
  [[nodiscard]] virtual bool quiet() const = 0;
};

class Simulation {
 public:
  /// @param seed  of everything random
  Simulation(const WorkshopMachine& description, TrueErrors errors, std::uint64_t seed);

  /// The unit at the machine; null: none. It must outlive the simulation or be taken away.
  void attach(Compensator* unit) {
    unit_ = unit;
    if (unit_ != nullptr) unit_->control(wires_);
  }
  /// Called every few milliseconds of real time while something runs; false gives it up.
  void on_pause(std::function<bool()> pause) { pause_ = std::move(pause); }

  /// From now on every period takes the time that it stands for, and no time is left out.
  void run_in_real_time() { real_time_.emplace(); }
  [[nodiscard]] const std::optional<RealTime>& real_time() const { return real_time_; }
  /// Periods that run in real time are late.
  [[nodiscard]] bool is_behind() const { return real_time_ && real_time_->is_behind(period_s()); }

  /// One period of the unit's loop.
  void tick();
  /// The same while nobody works at the machine: the workshop's clock stands still, so that what is measured later
  /// does not depend on how long the machine was left alone.
  void idle_tick();
  /// Idle until nothing moves any more, at most two seconds.
  void come_to_rest();
  [[nodiscard]] double period_s() const { return unit_ == nullptr ? kPeriodAlone_s : unit_->period_s(); }

  /// A straight move to its end, then until nothing moves any more. `each` is called after every tick.
  /// @return false: given up
  [[nodiscard]] bool move_to(const Vector3& target_mm, double feed_mm_min, const std::function<void()>& each = {});
  /// Ticks while `going`; `each` is called after every one. @return false: given up, the machine stopped
  [[nodiscard]] bool run_while(const std::function<bool()>& going, const std::function<void()>& each = {});
  /// Time passes: ticks until all stands and the unit waits for nothing, the rest at once.
  [[nodiscard]] bool dwell(double seconds, const std::function<void()>& each = {});
  /// Ticks without skipping.
  [[nodiscard]] bool run_for(double seconds);

  /// Tool against workpiece as the machine stands now. The difference of true position and command is inside.
  /// @param scatter  with what does not repeat; else the systematic part alone
  [[nodiscard]] ToolPose tool_now(bool scatter);
  /// The same for a state and a target.
  [[nodiscard]] ToolPose tool_at(const MachineState& state, const Vector3& target_mm, bool scatter);
  /// The same with rotary axes at their angles, in the frame of the workpiece, without scatter.
  /// @param tool_offset_mm  from the point at which the curves count, all angles 0. @pre the machine has rotary axes
  [[nodiscard]] TurningPose turned_tool(const Vector3& tool_offset_mm) const;

  /// In the magazine; 0, none, always is.
  [[nodiscard]] bool has_tool(std::uint16_t number) const;
  /// The control puts this tool into the spindle; 0: none. @pre has_tool(number)
  void change_tool(std::uint16_t number);
  [[nodiscard]] std::uint16_t tool() const { return tool_; }
  /// The control's "power on": without it the drives stand still, and its place is lost.
  void switch_control(bool on);
  [[nodiscard]] bool control_on() const { return control_on_; }
  /// The instrument that shows a deviation gives no signal any more.
  void lose_deviation(bool lost) { deviation_fails_ = lost; }

  [[nodiscard]] MachineTool& machine() { return machine_; }
  [[nodiscard]] const MachineTool& machine() const { return machine_; }
  [[nodiscard]] const TrueErrors& errors() const { return errors_; }
  [[nodiscard]] const WorkshopMachine& description() const { return description_; }
  /// Of the workshop, now; where the errors file says nothing of it: 20 °C, 1013.25 hPa, 50 %.
  [[nodiscard]] Air air() const { return heat_.air(machine_.time_s()); }
  /// Of the scale or workpiece that is measured, now [°C].
  [[nodiscard]] double material_degC() const { return heat_.material_degC(machine_.time_s()); }
  /// What all sensors show; `time_s` is now, or a fraction of a period before.
  [[nodiscard]] std::vector<NamedTemperature> sensors_degC(double time_s) const;
  [[nodiscard]] const Heat& heat() const { return heat_; }
  /// The speed that the CNC gives the spindle, from the next second on.
  void spindle(double rpm) { heat_.spindle(rpm); }
  [[nodiscard]] Random& random() { return random_; }
  /// Of the rotary axes, as the latest readings of a ball left them: none moves otherwise.
  [[nodiscard]] RotaryState& rotary() { return rotary_; }
  [[nodiscard]] const Drives& drives() const { return drives_; }
  [[nodiscard]] std::uint64_t ticks() const { return ticks_; }

 private:
  static constexpr double kPeriodAlone_s = 0.001;
  [[nodiscard]] bool pause();
  /// Machine and unit by a period, whatever the clock says.
  void step();
  void sense();
  void pass(double seconds);
  void rewire();
  [[nodiscard]] Vector3 carriages_mm() const;
  [[nodiscard]] bool at_rest() const;
  [[nodiscard]] bool settle(double limit_s, double& used_s, const std::function<void()>& each = {});

  /// What does not repeat belongs to a stop: an axis keeps it until it moves again.
  void draw_scatter(const MachineState& state, const Vector3& target_mm);

  struct Stop {
    double target_mm = 0.0;
    std::uint64_t pass = 0;
  };

  WorkshopMachine description_;
  MachineTool machine_;
  TrueErrors errors_;
  Heat heat_;
  ChainGeometry geometry_;
  std::uint64_t seed_;
  Random random_;
  RotaryState rotary_;
  PerAxis<std::optional<Stop>> stops_{};
  ComponentValues stop_scatter_{};
  std::uint16_t tool_ = 0;
  bool control_on_ = true;
  bool deviation_fails_ = false;
  double shown_um_ = 0.0, deviation_at_mm_ = 0.0;  ///< by the instrument for the deviation, and where its axis stood
  int still_looks_ = 0;
  ControlWires wires_{};
  Compensator* unit_ = nullptr;
  std::function<bool()> pause_;
  std::optional<RealTime> real_time_;
  Drives drives_{};
  std::uint64_t ticks_ = 0;
  int steady_ticks_ = 0;  ///< periods since a drive signal last changed
  double next_pause_s_ = 0.0;
  double sensed_s_ = 0.0;  ///< of the workshop's clock, when the unit's inputs were read last
};

}  // namespace ecs::emulator
