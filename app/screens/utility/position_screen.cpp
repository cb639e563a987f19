#include "app/screens/utility/position_screen.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace ecs::app {
namespace {

constexpr int kPositionAxisRow = 2;
constexpr int kPositionPromptRow = 7;
constexpr const char* kPositionExplained =
    "The unit adds up the counts of an axis's transducer. Here the number it shows for an axis is set to any value, "
    "and "
    "it counts on from there. Set an axis to 0, move it by a known distance and compare: a wrong sign is the wiring or "
    "the sign of the position feedback scaling factor, a wrong length its size, a number that does not change the "
    "transducer or its module. Nothing moves by this, and no axis becomes referenced.";

}  // namespace

Axis PositionScreen::chosen() const {
  const auto axes = controller_.unit().axes();
  if (axes.empty()) return Axis::X;
  return axes[static_cast<std::size_t>(std::clamp(place_.selected, 0, static_cast<int>(axes.size()) - 1))];
}

void PositionScreen::draw(Canvas& canvas, const Area& area) const {
  const Area inside{area.row, area.column + 1, area.rows, area.columns - 2};
  draw_unit_row(canvas, inside, 0, controller_.unit());
  draw_axis_rows(canvas, inside, kPositionAxisRow, controller_.unit(), chosen());
  if (prompt_.active())
    prompt_.draw(canvas, inside, kPositionPromptRow);
  else
    canvas.text(inside, kPositionPromptRow, 0,
                controller_.busy() ? "Sending ..."
                                   : fmt::format("Enter sets what the unit shows for axis {}.", letter_of(chosen())));
  int row = kPositionPromptRow + 2;
  row += canvas.paragraph(inside, row, kPositionExplained, Tone::faint) + 1;
  const auto& done = controller_.done();
  if (!done.empty()) canvas.text(inside, row++, 0, "Set here, newest first (u takes the first back):", Tone::faint);
  for (auto it = done.rbegin(); it != done.rend() && row < inside.rows - 3; ++it)
    canvas.text(inside, row++, 2,
                fmt::format("{}  {:>13.4f} mm, was {:.4f} mm", letter_of(it->axis), it->after_mm, it->before_mm));
  draw_message(canvas, {inside.row + inside.rows - 2, inside.column, 2, inside.columns}, controller_.message());
  asking_.draw(canvas, inside);
}

void PositionScreen::type() {
  const Axis axis = chosen();
  prompt_.ask(fmt::format("New position of {}, mm:", letter_of(axis)), Prompt::Kind::number, "",
              [this, axis](const std::string& typed) {
                const auto position = PositionController::position_in(typed);
                if (!position)
                  controller_.message().say(position.error());
                else
                  asking_.ask(controller_.question(axis, *position),
                              [this, axis, mm = *position] { controller_.set(axis, mm); });
              });
}

Step PositionScreen::on_key(const Key& key) {
  if (asking_.on_key(key) || prompt_.on_key(key)) return stay();
  if (key.name == Key::Name::resized) return stay();
  controller_.message().clear();
  if (key.name == Key::Name::escape || is_letter(key, U'q')) {
    if (!controller_.busy()) return back();
    controller_.cancel();
    return stay();
  }
  const auto axes = controller_.unit().axes();
  if (place_.on_key(key, static_cast<int>(axes.size()))) return stay();
  if (const auto axis = axis_of_key(key))
    for (std::size_t k = 0; k < axes.size(); ++k)
      if (axes[k] == *axis) place_.selected = static_cast<int>(k);
  if (const auto k = axis_clicked(key, kPositionAxisRow + 2, static_cast<int>(axes.size()))) place_.selected = *k;
  if (key.name == Key::Name::enter && !controller_.busy()) type();
  if (is_letter(key, U'u') || (key.name == Key::Name::control && key.letter == U'z')) controller_.undo();
  return stay();
}

std::vector<KeyHelp> PositionScreen::keys() const {
  if (asking_.active()) return {{"y", "set it"}, {"n", "leave it"}};
  if (prompt_.active()) return {{"Enter", "take the number"}, {"Esc", "leave it"}};
  return {{"Enter", "set the position"}, {"up/down x y z", "axis"}, {"u", "undo"}, {"Esc", "back"}};
}

std::string PositionScreen::help() const {
  return std::string(kPositionExplained) +
         " The unit takes it in integration mode only. u undoes what was set last: the axis is shifted back by the "
         "same amount, also if it has moved since.";
}

CellPosition PositionScreen::cursor(const Area& area) const {
  return prompt_.cursor({area.row, area.column + 1, area.rows, area.columns - 2}, kPositionPromptRow);
}

}  // namespace ecs::app
