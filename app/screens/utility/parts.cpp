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

void Prompt::ask(std::string label, Kind kind, const std::string& text,
                 std::function<void(const std::string&)> on_text) {
  label_ = std::move(label);
  kind_ = kind;
  line_.set(text);
  hint_.clear();
  on_text_ = std::move(on_text);
}

bool Prompt::on_key(const Key& key) {
  if (!active()) return false;
  hint_.clear();
  if (key.name == Key::Name::escape) {
    on_text_ = nullptr;
  } else if (key.name == Key::Name::enter) {
    const auto on_text = std::move(on_text_);
    on_text_ = nullptr;
    if (!line_.text().empty()) on_text(line_.text());
  } else if (key.name == Key::Name::tab && kind_ == Kind::path) {
    const PathCompletion completion = completed_path(line_.text());
    line_.set(completion.completed);
    for (const std::string& choice : completion.choices) hint_ += (hint_.empty() ? "" : "  ") + choice;
  } else {
    (void)line_.on_key(key);
  }
  return true;
}

int Prompt::columns(const Area& area) const {
  const int room = area.columns - width_of(label_) - 2;
  return std::max(8, kind_ == Kind::number ? std::min(16, room) : room);
}

void Prompt::draw(Canvas& canvas, const Area& area, int row) const {
  if (!active()) return;
  canvas.fill({area.row + row, area.column, 1, area.columns});
  const int begin = canvas.text(area, row, 0, label_ + " ", Tone::strong);
  line_.draw(canvas, area, row, begin, columns(area), true);
  const std::string hint = !hint_.empty() ? hint_ : "Enter takes it, Esc leaves it";
  const int beside = begin + columns(area) + 2;
  if (kind_ == Kind::number)
    canvas.paragraph({area.row + row, area.column + beside, 1, std::max(0, area.columns - beside)}, 0, hint,
                     Tone::faint);
  if (kind_ == Kind::path && row > 0) {
    canvas.fill({area.row + row - 1, area.column, 1, area.columns});
    canvas.paragraph(area.below(row - 1).top(1), 0, hint_.empty() ? "Tab completes the path; " + hint : hint_,
                     Tone::faint);
  }
}

CellPosition Prompt::cursor(const Area& area, int row) const {
  if (!active()) return {-1, -1};
  return {area.row + row, area.column + width_of(label_) + 1 + line_.cursor_column(columns(area))};
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

}  // namespace ecs::app
