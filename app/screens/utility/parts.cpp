#include "app/screens/utility/parts.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "core/fault.hpp"

namespace ecs::app {

void draw_unit_row(Canvas& canvas, const Area& area, int row, const UnitView& unit) {
  if (!unit.watched.problem.empty()) {
    const std::string age = unit.sample ? " (" + age_text(std::max(1.0, unit.age_s)) + ")" : "";
    canvas.paragraph(area.below(row).top(2), 0, fmt::format("NO ANSWER{}: {}", age, unit.watched.problem), Tone::bad);
    return;
  }
  if (!unit.sample) {
    canvas.text(area, row, 0, "Opening the link to the unit ...", Tone::warning);
    return;
  }
  const std::string name = unit.watched.identity ? "unit " + unit.watched.identity->serial_number : "the unit";
  const std::string mode = fmt::format("{}, {}", name, ecs::name_of(unit.sample->mode));
  if (unit.sample->fault == Fault::none)
    canvas.text(area, row, 0, mode, Tone::strong);
  else
    canvas.paragraph(area.below(row).top(2), 0,
                     fmt::format("{}, fault: {}", mode, ecs::text_of(unit.sample->fault).meaning), Tone::bad);
  if (unit.age_s >= 1.5) canvas.text_right(area, row, age_text(unit.age_s), Tone::warning);
}

int draw_axis_rows(Canvas& canvas, const Area& area, int row, const UnitView& unit, std::optional<Axis> chosen) {
  canvas.text(area, row, 0,
              fmt::format("  {:<4} {:>13} {:>10}  {:<11}{:<8}{:<8}{}", "axis", "position mm", "mm/min", "referenced",
                          "switch", "marker", "relay"),
              Tone::faint);
  int r = row;
  for (const Axis a : unit.axes()) {
    ++r;
    const bool here = chosen && a == *chosen;
    const protocol::AxisSample* s = unit.axis(a);
    if (here) canvas.fill({area.row + r, area.column, 1, area.columns}, U' ', Tone::selected);
    canvas.text(area, r, 0,
                s == nullptr ? fmt::format("{} {:<4} {:>13}", here ? ">" : " ", letter_of(a), "not seen yet")
                             : fmt::format("{} {:<4} {:>13.4f} {:>10.1f}  {:<11}{:<8}{:<8}{}", here ? ">" : " ",
                                           letter_of(a), s->position_mm, s->speed_mm_min, s->referenced ? "yes" : "no",
                                           s->switch_active ? "on" : "off", s->marker ? "seen" : "-",
                                           s->relay_closed ? "CLOSED" : "open"),
                here ? Tone::selected : (unit.fresh ? Tone::plain : Tone::faint));
  }
  return r - row + 1;
}

std::optional<int> axis_clicked(const Key& key, int first_row, int count) {
  const int k = key.row - first_row;
  if (key.name != Key::Name::mouse || k < 0 || k >= count) return std::nullopt;
  return k;
}

bool choose_axis(ListPlace& place, const Key& key, const std::vector<Axis>& axes, int first_row) {
  const int count = static_cast<int>(axes.size());
  if (place.on_key(key, count)) return true;
  const auto letter = axis_of_key(key);
  const auto named = letter ? std::find(axes.begin(), axes.end(), *letter) : axes.end();
  const auto clicked = axis_clicked(key, first_row, count);
  if (named != axes.end()) place.selected = static_cast<int>(named - axes.begin());
  if (clicked) place.selected = *clicked;
  return named != axes.end() || clicked;
}

Axis chosen_axis(const ListPlace& place, const std::vector<Axis>& axes) {
  if (axes.empty()) return Axis::X;
  return axes[static_cast<std::size_t>(std::clamp(place.selected, 0, static_cast<int>(axes.size()) - 1))];
}

std::optional<Axis> axis_of_key(const Key& key) {
  for (const Axis a : kAllAxes)
    if (is_letter(key, static_cast<char32_t>(letter_of(a))) || is_letter(key, static_cast<char32_t>(letter_of(a) + 32)))
      return a;
  return std::nullopt;
}

void MachineDriver::ask(Prompt& prompt, const WatchedUnit& unit, Message& message) {
  if (!can_drive(unit)) {
    message.say("This is a real unit: move the axes at the machine's own control.", Tone::warning);
    return;
  }
  if (task_.running()) {
    message.say("The emulated machine moves: Esc stops it.", Tone::warning);
    return;
  }
  prompt.ask(
      "Drive to:", Prompt::Kind::text, "",
      [this, workshop = unit.workshop, &message](const std::string& typed) {
        const auto request = drive_request(typed);
        if (!request) return request.error().message;
        drive_machine(task_, workshop, *request, message);
        return std::string();
      },
      "X-100 F2000 (machine mm), G01 X-100, or a program's file");
}

bool MachineDriver::stop() {
  const bool moved = task_.running();
  task_.cancel();
  return moved;
}

}  // namespace ecs::app
