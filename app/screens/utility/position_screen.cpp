// SET AXIS POSITION: the axes with what the unit shows for them, live; a position is typed, asked for, set.

#include <fmt/format.h>

#include "app/screens/utility/machine_driver.hpp"
#include "app/screens/utility/parts.hpp"
#include "app/screens/utility/screens.hpp"
#include "commissioning/utility/position_controller.hpp"

namespace ecs::app {
namespace {

constexpr int kPositionAxisRow = 2;
constexpr int kPositionPromptRow = 7;
constexpr const char* kPositionExplained =
    "The unit adds up the counts of an axis's transducer. Here the number it shows for an axis is set to any value, "
    "and it counts on from there. Set an axis to 0, move it by a known distance and compare: a wrong sign is the "
    "wiring or the sign of the position feedback scaling factor, a wrong length its size, a number that does not "
    "change the transducer or its module. Nothing moves by this, and no axis becomes referenced.";

class PositionScreen final : public UtilityScreen<PositionController> {
 public:
  using UtilityScreen::UtilityScreen;

  [[nodiscard]] std::string title() const override { return "SET AXIS POSITION"; }
  void draw_inside(Canvas& canvas, const Area& inside) const override {
    draw_unit_row(canvas, inside, 0, controller_.unit());
    draw_axis_rows(canvas, inside, kPositionAxisRow, controller_.unit(), chosen());
    if (!prompt_.active())
      canvas.text(inside, kPositionPromptRow, 0,
                  controller_.busy() ? "Sending ..."
                  : driver_.running()
                      ? "The emulated machine moves; Esc stops it."
                      : fmt::format("Enter sets what the unit shows for axis {}.", letter_of(chosen())));
    int row = kPositionPromptRow + 2;
    row += canvas.paragraph(inside, row, kPositionExplained, Tone::faint) + 1;
    const auto& done = controller_.done();
    if (!done.empty()) canvas.text(inside, row++, 0, "Set here, newest first (u takes the first back):", Tone::faint);
    for (auto it = done.rbegin(); it != done.rend() && row < inside.rows - 3; ++it)
      canvas.text(inside, row++, 2,
                  fmt::format("{}  {:>13.4f} mm, was {:.4f} mm", letter_of(it->axis), it->after_mm, it->before_mm));
    draw_message(canvas, {inside.row + inside.rows - 2, inside.column, 2, inside.columns}, controller_.message());
  }

  [[nodiscard]] bool advance() override {
    const bool moved = driver_.advance();
    return UtilityScreen::advance() || moved;
  }
  [[nodiscard]] Step leave() override { return driver_.stop() ? stay() : UtilityScreen::leave(); }

  void on_command(const Key& key) override {
    if (choose_axis(place_, key, controller_.unit().axes(), kPositionAxisRow + 2)) return;
    if (key.name == Key::Name::enter && !controller_.busy() && unit_integrates()) type();
    if (is_letter(key, U'j')) driver_.ask(prompt_, controller_.unit().watched, controller_.message());
    if (is_letter(key, U'u') || (key.name == Key::Name::control && key.letter == U'z')) controller_.undo();
  }

  [[nodiscard]] std::vector<KeyHelp> keys() const override {
    if (asking_.active()) return {{"y", "set it"}, {"n", "leave it"}};
    if (prompt_.active()) return prompt_.keys();
    std::vector<KeyHelp> keys{{"Enter", "set the position"}, {"up/down x y z", "axis"}, {"u", "undo"}, {"Esc", "back"}};
    if (MachineDriver::can_drive(controller_.unit().watched)) keys.insert(keys.begin() + 2, MachineDriver::key());
    return keys;
  }

  [[nodiscard]] std::string help() const override {
    return std::string(kPositionExplained) +
           " The unit takes it in integration mode only. u undoes what was set last: the axis is shifted back by the "
           "same amount, also if it has moved since. With the bundled emulator j drives its machine.";
  }

 private:
  [[nodiscard]] Axis chosen() const { return chosen_axis(place_, controller_.unit().axes()); }
  [[nodiscard]] int prompt_row(const Area& /*inside*/) const override { return kPositionPromptRow; }

  void type() {
    const Axis axis = chosen();
    prompt_.ask(fmt::format("New position of {}, mm:", letter_of(axis)), Prompt::Kind::number, "",
                [this, axis](const std::string& typed) {
                  const auto position = PositionController::position_in(typed);
                  if (!position) return position.error().message;
                  asking_.ask(controller_.question(axis, *position),
                              [this, axis, mm = *position] { controller_.set(axis, mm); });
                  return std::string();
                });
  }

  ListPlace place_;
  MachineDriver driver_;
};

}  // namespace

std::unique_ptr<Screen> position_screen(std::shared_ptr<UnitConnection> connection) {
  return std::make_unique<PositionScreen>(std::move(connection));
}

}  // namespace ecs::app
