// What the screens of ECS UTILITY share: the unit's state and its axes in rows, a question with what follows from it, a
// line to type into, the emulated machine driven.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/screens/files/prompt.hpp"
#include "app/ui/screen.hpp"
#include "app/ui/widgets.hpp"
#include "commissioning/link/unit_connection.hpp"
#include "commissioning/utility/unit_view.hpp"

namespace ecs::app {

/// Why there is no answer, over two rows; else the unit's name, mode and fault on one.
void draw_unit_row(Canvas& canvas, const Area& area, int row, const UnitView& unit);

/// Heading and a row for each axis: position, speed, referenced, switch, marker, relay; `chosen` is marked.
/// @return rows used
int draw_axis_rows(Canvas& canvas, const Area& area, int row, const UnitView& unit, std::optional<Axis> chosen);

/// Which of `count` axes was clicked whose first stands on this row of the canvas.
[[nodiscard]] std::optional<int> axis_clicked(const Key& key, int first_row, int count);

/// Chooses one of the axes by arrow, letter or click. @return whether the key was for it
bool choose_axis(ListPlace& place, const Key& key, const std::vector<Axis>& axes, int first_row);
[[nodiscard]] Axis chosen_axis(const ListPlace& place, const std::vector<Axis>& axes);

/// The axis that a letter names, "x" or "X".
[[nodiscard]] std::optional<Axis> axis_of_key(const Key& key);

/// A screen over a controller, with a prompt and a question over its picture.
template <class Controller>
class UtilityScreen : public Screen {
 public:
  UtilityScreen() = default;
  explicit UtilityScreen(std::shared_ptr<UnitConnection> connection) : controller_(std::move(connection)) {}

  [[nodiscard]] bool advance() override {
    const bool looked = prompt_.advance();
    return controller_.advance() || looked;
  }
  [[nodiscard]] bool typing() const override { return prompt_.active(); }
  void draw(Canvas& canvas, const Area& area) const final {
    const Area inside = area.between_margins();
    draw_inside(canvas, inside);
    prompt_.draw(canvas, inside, prompt_row(inside));
    draw_question(canvas, inside, asking_);
  }
  [[nodiscard]] CellPosition cursor(const Area& area) const override {
    const Area inside = area.between_margins();
    return prompt_.cursor(inside, prompt_row(inside));
  }
  [[nodiscard]] Step on_key(const Key& key) final {
    if (answers(asking_, key) || prompt_.on_key(key) || key.name == Key::Name::resized) return stay();
    controller_.message().clear();
    if (key.name == Key::Name::escape || is_letter(key, U'q')) return leave();
    on_command(key);
    return stay();
  }

 protected:
  virtual void draw_inside(Canvas& canvas, const Area& inside) const = 0;
  virtual void on_command(const Key& key) = 0;
  [[nodiscard]] virtual int prompt_row(const Area& inside) const { return inside.rows - 1; }
  /// Back; what is under way is given up first.
  [[nodiscard]] virtual Step leave() {
    if (!controller_.busy()) return back();
    if constexpr (requires(Controller & c) { c.cancel(); }) controller_.cancel();
    return stay();
  }
  /// Whether the unit does now what needs integration mode; the message says why not.
  [[nodiscard]] bool unit_integrates() {
    const std::string why = controller_.unit().refusal();
    if (!why.empty()) controller_.message().say(why, Tone::warning);
    return why.empty();
  }
  /// Asks for a file, and again before one is overwritten.
  void ask_where_to_save(const std::string& proposed) {
    prompt_.ask("Save as:", Prompt::Kind::path, proposed, [this](const std::string& path) {
      if constexpr (requires(Controller & c) { c.save(path); }) {
        if (!file_is_there(path)) return controller_.save(path);
        asking_.ask(
            {"Overwrite " + path + "?", "The file exists. Its contents will be overwritten.", "overwrite", "keep it"},
            [this, path] { controller_.save(path); });
      }
    });
  }

  Controller controller_;
  Prompt prompt_;
  Asking asking_;
};

/// The emulated machine driven from a screen: to a place, by a block, by a part program.
class MachineDriver {
 public:
  /// Whether there is a machine to drive: the bundled emulator's.
  [[nodiscard]] static bool can_drive(const WatchedUnit& unit) { return unit.emulator && !unit.workshop.empty(); }
  [[nodiscard]] static KeyHelp key() { return {"j", "jog, or run a program"}; }
  /// Asks where to go; of a real unit it says that its own control moves it.
  /// @param prompt, message  outlive this
  void ask(Prompt& prompt, const WatchedUnit& unit, Message& message);
  [[nodiscard]] bool running() const { return task_.running(); }
  /// Stops the machine. @return whether it moved
  bool stop();
  [[nodiscard]] bool advance() { return task_.advance() || task_.running(); }

 private:
  TaskRunner task_;
};

/// A screen of axes, one of them chosen, on which the emulated machine can be driven as well.
template <class Controller>
class DrivingScreen : public UtilityScreen<Controller> {
 public:
  using UtilityScreen<Controller>::UtilityScreen;

  [[nodiscard]] bool advance() override {
    const bool moved = driver_.advance();
    return UtilityScreen<Controller>::advance() || moved;
  }

 protected:
  [[nodiscard]] Step leave() override { return driver_.stop() ? stay() : UtilityScreen<Controller>::leave(); }
  void ask_to_drive() { driver_.ask(this->prompt_, this->controller_.unit().watched, this->controller_.message()); }
  [[nodiscard]] Axis chosen() const { return chosen_axis(place_, this->controller_.unit().axes()); }
  /// With the key that drives, where there is an emulated machine. @param at  its place among them
  [[nodiscard]] std::vector<KeyHelp> with_driver(std::vector<KeyHelp> keys, std::ptrdiff_t at) const {
    if (MachineDriver::can_drive(this->controller_.unit().watched))
      keys.insert(keys.begin() + at, MachineDriver::key());
    return keys;
  }
  /// While the machine's control is to reference an axis.
  [[nodiscard]] std::vector<KeyHelp> keys_while_referencing() const {
    std::vector<KeyHelp> keys{{"Esc", "give up"}};
    if (this->controller_.emulator()) keys.insert(keys.begin(), {"g", "reference the emulated machine"});
    return with_driver(keys, static_cast<std::ptrdiff_t>(keys.size()));
  }
  /// What a person does now.
  [[nodiscard]] std::string call_to_reference(Axis axis) const {
    return fmt::format(
        "REFERENCE AXIS {} NOW{}.", letter_of(axis),
        this->controller_.emulator() ? ": g lets the emulated machine do it" : ", at the machine's own control");
  }

  ListPlace place_;
  MachineDriver driver_;
};

}  // namespace ecs::app
