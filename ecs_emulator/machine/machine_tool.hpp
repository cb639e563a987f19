// The machine tool: axes under a CNC that moves them along a path, as it stands at one instant.
// Does not live here: its errors (ecs_emulator/errors/true_errors.hpp), the unit (ecs_emulator/unit/unit.hpp), who
// tells it to move (ecs_emulator/workshop/workshop.hpp).
#pragma once

#include "ecs_emulator/errors/true_errors.hpp"
#include "ecs_emulator/machine/axis_of_machine.hpp"
#include "ecs_emulator/machine/path.hpp"
#include "ecs_emulator/settings/emulator.hpp"

namespace ecs::emulator {

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
  /// The path is at its end (the axes may still be catching up).
  [[nodiscard]] bool arrived() const { return path_.done(); }
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
  Path path_;
  double load_kg_ = 0.0;
  double time_s_ = 0.0;
};

/// Where an axis stands when the machine is switched on: on the approach side of its reference switch, clear of it.
[[nodiscard]] double start_position_mm(const params::MachineAxis& axis, const AxisSettings& settings);

}  // namespace ecs::emulator
