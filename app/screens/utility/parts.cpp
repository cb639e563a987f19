#include "app/screens/utility/parts.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "core/fault.hpp"
#include "core/mode_word.hpp"

namespace ecs::app {
namespace {

constexpr double kPromptly_s = 3.0;  ///< a refusal that comes later finds the user at something else

}  // namespace

std::optional<Axis> axis_of_key(const Key& key) {
  for (const Axis a : kAllAxes)
    if (is_letter(key, static_cast<char32_t>(letter_of(a))) || is_letter(key, static_cast<char32_t>(letter_of(a) + 32)))
      return a;
  return std::nullopt;
}

void MachineDriver::ask(Prompt& prompt, const WatchedUnit& unit, Message& message) {
  if (!can_drive(unit))
    return message.say("Only the machine of the bundled emulator can be driven here. Move the axes at the control.",
                       Tone::warning);
  if (task_.running()) return message.say("The emulated machine is moving: press Esc to stop.", Tone::warning);
  ask(prompt, unit.workshop, message, "");
}

void MachineDriver::ask(Prompt& prompt, const std::string& workshop, Message& message, const std::string& text) {
  prompt.ask(
      "Drive to:", Prompt::Kind::text, text,
      [this, &prompt, workshop, &message](const std::string& typed) {
        const auto request = drive_request(typed);
        if (!request) return request.error().message;
        const auto failed = [this, &prompt, workshop, &message, typed](const Problem& why) {
          if (prompt.active() || task_.seconds() > kPromptly_s) return message.say(why);
          ask(prompt, workshop, message, typed);
          prompt.refuse(to_text(why));
        };
        drive_machine(task_, workshop, *request, message, failed);
        return std::string();
      },
      "X-100 F2000 (machine mm), G01 X-100, or a program's file");
}

bool MachineDriver::stop() {
  const bool moved = task_.running();
  task_.cancel();
  return moved;
}

bool AxesScreen::look() {
  bool changed = unit_.look(*connection_);
  if (std::exchange(times_lost_, unit_.watched.times_lost) != unit_.watched.times_lost) lost();
  if (std::exchange(restarts_, unit_.restarts) != unit_.restarts) restarted();
  changed = driver_.advance() || changed;
  return task_.advance() || changed;
}

Step AxesScreen::leave() {
  if (driver_.stop()) return stay();
  if (!busy()) return back();
  task_.cancel();
  return stay();
}

Axis AxesScreen::chosen() const {
  const auto axes = unit_.axes();
  if (axes.empty()) return Axis::X;
  return axes[static_cast<std::size_t>(std::clamp(place_.selected, 0, static_cast<int>(axes.size()) - 1))];
}

bool AxesScreen::choose_axis(const Key& key) {
  const auto axes = unit_.axes();
  if (place_.on_key(key, static_cast<int>(axes.size()))) return true;
  const auto letter = axis_of_key(key);
  const auto named = letter ? std::find(axes.begin(), axes.end(), *letter) : axes.end();
  const auto clicked = axis_clicked(key);
  if (named != axes.end()) place_.selected = static_cast<int>(named - axes.begin());
  if (clicked) place_.selected = *clicked;
  return named != axes.end() || clicked;
}

std::optional<int> AxesScreen::axis_clicked(const Key& key) const {
  const int k = key.row - (kAxesRow + 2);  // below the line above every screen, and the heading
  if (key.name != Key::Name::mouse || k < 0 || k >= static_cast<int>(unit_.axes().size())) return std::nullopt;
  return k;
}

bool AxesScreen::unit_integrates() {
  const std::string why = unit_.refusal();
  if (!why.empty()) message_.say(why, Tone::warning);
  return why.empty();
}

KeyRow AxesScreen::drive_row() {
  return {"j", "jog, or run a program", [this] { driver_.ask(prompt_, unit_.watched, message_); },
          [this] { return MachineDriver::can_drive(unit_.watched); }, true};
}

void AxesScreen::draw_unit_row(Canvas& canvas, const Area& area) const {
  if (!unit_.watched.problem.empty()) {
    const std::string age = unit_.sample ? " (" + age_text(std::max(1.0, unit_.age_s)) + ")" : "";
    canvas.paragraph(area.top(2), 0, fmt::format("NO ANSWER{}: {}", age, unit_.watched.problem), Tone::bad);
    return;
  }
  if (!unit_.sample) {
    canvas.text(area, 0, 0, "Opening the link to the unit ...", Tone::warning);
    return;
  }
  const std::string name = unit_.watched.identity ? "unit " + unit_.watched.identity->serial_number : "the unit";
  const std::string mode = fmt::format("{}, {}", name, word_of(unit_.sample->mode));
  if (unit_.sample->fault == Fault::none)
    canvas.text(area, 0, 0, mode, Tone::strong);
  else
    canvas.paragraph(area.top(2), 0, fmt::format("{}, fault: {}", mode, ecs::text_of(unit_.sample->fault).meaning),
                     Tone::bad);
  if (unit_.age_s >= 1.5) canvas.text_right(area, 0, age_text(unit_.age_s), Tone::warning);
}

void AxesScreen::draw_axis_rows(Canvas& canvas, const Area& area, Axis chosen) const {
  canvas.text(
      area, kAxesRow, 0,
      fmt::format("  {:<4} {:>13} {:>10}  {:<11}{:<8}{:<8}{}", "axis", fmt::format("position {}", shown_in().length),
                  shown_in().speed, "referenced", "switch", "marker", "relay"),
      Tone::faint);
  int r = kAxesRow;
  for (const Axis a : unit_.axes()) {
    ++r;
    const bool here = a == chosen;
    const protocol::AxisSample* s = unit_.axis(a);
    if (here) canvas.fill({area.row + r, area.column, 1, area.columns}, U' ', Tone::selected);
    canvas.text(
        area, r, 0,
        fmt::format("{} {:<4} ", here ? ">" : " ", letter_of(a)) +
            (s == nullptr ? fmt::format("{:>13}", "not seen yet")
                          : fmt::format("{:>13} {:>10}  {:<11}{:<8}{:<8}{}", shown_in().position(s->position_mm),
                                        shown_in().speed_of(s->speed_mm_min), s->referenced ? "yes" : "no",
                                        s->switch_active ? "on" : "off", s->marker ? "seen" : "-",
                                        s->relay_closed ? "CLOSED" : "open")),
        here ? Tone::selected : (unit_.fresh ? Tone::plain : Tone::faint));
  }
}

}  // namespace ecs::app
