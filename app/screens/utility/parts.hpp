// What the screens of ECS UTILITY share: the unit's state and its axes in rows; the emulated machine driven.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "app/screens/files/keyed_screen.hpp"
#include "app/ui/screen.hpp"
#include "app/ui/widgets.hpp"
#include "commissioning/link/unit_connection.hpp"
#include "commissioning/utility/unit_view.hpp"
#include "params/position_unit.hpp"

namespace ecs::app {

/// The axis that a letter names, "x" or "X".
[[nodiscard]] std::optional<Axis> axis_of_key(const Key& key);

/// The emulated machine driven from a screen: to a place, by a block, by a part program.
class MachineDriver {
 public:
  /// Asks where to go; of a real unit it says that its own control moves it.
  /// What the machine refuses stays open for correction.
  /// @param prompt, message  outlive this
  void ask(Prompt& prompt, const WatchedUnit& unit, Message& message);
  /// Whether there is a machine to drive: the bundled emulator's.
  [[nodiscard]] static bool can_drive(const WatchedUnit& unit) { return unit.emulator && !unit.workshop.empty(); }
  [[nodiscard]] bool running() const { return task_.running(); }
  /// Stops the machine. @return whether it moved
  bool stop();
  [[nodiscard]] bool advance() { return task_.advance() || task_.running(); }

 private:
  void ask(Prompt& prompt, const std::string& workshop, Message& message, const std::string& text);
  TaskRunner task_;
};

/// A screen of the unit's axes, one of them chosen, on which the emulated machine can be driven as well.
class AxesScreen : public KeyedScreen {
 protected:
  static constexpr int kAxesRow = 2;  ///< their heading
  static constexpr int kCallRow = 7;  ///< below them
  explicit AxesScreen(std::shared_ptr<UnitConnection> connection)
      : connection_(connection), watching_(std::move(connection)) {
    (void)unit_.look(*connection_);
    times_lost_ = unit_.watched.times_lost;
  }

  [[nodiscard]] bool look() override;
  /// The unit restarted, or its link was lost since the last look.
  virtual void restarted() {}
  virtual void lost() {}
  [[nodiscard]] Step leave() override;
  [[nodiscard]] bool busy() const { return task_.running(); }
  [[nodiscard]] Axis chosen() const;
  /// By arrow, letter or click. @return whether the key was for it
  bool choose_axis(const Key& key);
  /// Which of the axes was clicked.
  [[nodiscard]] std::optional<int> axis_clicked(const Key& key) const;
  /// Whether the unit does now what needs integration mode; the message says why not.
  [[nodiscard]] bool unit_integrates();
  /// The key that drives the machine, named where there is one.
  [[nodiscard]] KeyRow drive_row();
  /// In which positions are shown.
  [[nodiscard]] const params::PositionUnit& shown_in() const {
    return params::position_unit(unit_.watched.measurement_system);
  }
  /// Why there is no answer, over two rows; else the unit's name, mode and fault on one.
  void draw_unit_row(Canvas& canvas, const Area& area) const;
  /// Heading and a row for each axis: position, speed, referenced, switch, marker, relay; `chosen` is marked.
  void draw_axis_rows(Canvas& canvas, const Area& area, Axis chosen) const;

  std::shared_ptr<UnitConnection> connection_;
  UnitConnection::Watching watching_;
  UnitView unit_;
  ListPlace place_;
  MachineDriver driver_;
  TaskRunner task_;  ///< the work on the unit

 private:
  int restarts_ = 0;
  std::uint64_t times_lost_ = 0;  ///< links
};

}  // namespace ecs::app
