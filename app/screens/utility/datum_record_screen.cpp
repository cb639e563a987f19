#include "app/screens/utility/datum_record_screen.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/screens/utility/datum_view_screen.hpp"

namespace ecs::app {
namespace {

constexpr int kDatumRecordAxisRow = 2;
constexpr int kProgressRow = 7;
constexpr const char* kDatumRecordExplained =
    "Ten seconds of one axis are recorded: speed, reference switch and marker. The unit only watches: the machine must "
    "be referenced by its own control while the bar runs, from some travel away from the switch and slowly enough that "
    "switch and marker come within the ten seconds. The graph opens by itself; the datuming parameters are read off "
    "there.";

}  // namespace

Axis DatumRecordScreen::chosen() const {
  const auto axes = controller_.unit().axes();
  if (axes.empty()) return Axis::X;
  return axes[static_cast<std::size_t>(std::clamp(place_.selected, 0, static_cast<int>(axes.size()) - 1))];
}

void DatumRecordScreen::draw(Canvas& canvas, const Area& area) const {
  const Area inside{area.row, area.column + 1, area.rows, area.columns - 2};
  draw_unit_row(canvas, inside, 0, controller_.unit());
  const bool busy = controller_.busy();
  draw_axis_rows(canvas, inside, kDatumRecordAxisRow, controller_.unit(), busy ? controller_.axis() : chosen());
  const char axis = letter_of(busy ? controller_.axis() : chosen());
  int row = kProgressRow + 2;
  if (controller_.phase() == DatumRecordController::Phase::recording) {
    draw_progress(canvas, inside, kProgressRow, fmt::format("recording axis {}", axis), controller_.part(),
                  controller_.seconds_left());
    canvas.text(inside, kProgressRow + 1, 0,
                fmt::format("so far: switch {}, marker {}", controller_.switch_seen() ? "reached" : "not reached",
                            controller_.marker_seen() ? "seen" : "not seen"));
    row += canvas.paragraph(inside, row + 1,
                            controller_.referencing() ? std::string("The emulated machine is being referenced ...")
                            : controller_.emulator()
                                ? fmt::format("REFERENCE AXIS {} NOW: g lets the emulated machine do it.", axis)
                                : fmt::format("REFERENCE AXIS {} NOW, at the machine's own control.", axis),
                            Tone::warning) +
           2;
  } else if (controller_.phase() == DatumRecordController::Phase::starting) {
    canvas.text(inside, kProgressRow, 0, "Sending ...");
  } else if (busy) {
    draw_progress(canvas, inside, kProgressRow, "fetching the record", controller_.part(), controller_.seconds_left());
  } else {
    canvas.text(inside, kProgressRow, 0, fmt::format("Enter records axis {}.", axis));
  }
  canvas.paragraph(inside, row + 1, kDatumRecordExplained, Tone::faint);
  draw_message(canvas, {inside.row + inside.rows - 2, inside.column, 2, inside.columns}, controller_.message());
  asking_.draw(canvas, inside);
}

Step DatumRecordScreen::on_key(const Key& key) {
  if (asking_.on_key(key) || key.name == Key::Name::resized) return stay();
  controller_.message().clear();
  if (key.name == Key::Name::escape || is_letter(key, U'q')) {
    if (!controller_.busy()) return back();
    controller_.cancel();
    return stay();
  }
  if (is_letter(key, U'g')) controller_.reference();
  if (controller_.busy()) return stay();
  const auto axes = controller_.unit().axes();
  if (place_.on_key(key, static_cast<int>(axes.size()))) return stay();
  if (const auto axis = axis_of_key(key))
    for (std::size_t k = 0; k < axes.size(); ++k)
      if (axes[k] == *axis) place_.selected = static_cast<int>(k);
  if (const auto k = axis_clicked(key, kDatumRecordAxisRow + 2, static_cast<int>(axes.size()))) place_.selected = *k;
  if (key.name == Key::Name::enter)
    asking_.ask(controller_.question(chosen()), [this, axis = chosen()] { controller_.start(axis); });
  return stay();
}

std::unique_ptr<Screen> DatumRecordScreen::opens_by_itself() {
  auto record = controller_.take();
  return record ? std::make_unique<DatumViewScreen>(std::move(*record)) : nullptr;
}

std::vector<KeyHelp> DatumRecordScreen::keys() const {
  if (asking_.active()) return {{"y", "record"}, {"n", "not now"}};
  if (controller_.busy()) {
    std::vector<KeyHelp> keys{{"Esc", "give up"}};
    if (controller_.emulator()) keys.insert(keys.begin(), {"g", "reference the emulated machine"});
    return keys;
  }
  return {{"Enter", "record"}, {"up/down x y z", "axis"}, {"Esc", "back"}};
}

std::string DatumRecordScreen::help() const { return kDatumRecordExplained; }

}  // namespace ecs::app
