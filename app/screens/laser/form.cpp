#include "app/screens/laser/form.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.hpp"

namespace ecs::app {

LaserForm::LaserForm(std::string title, std::vector<LaserField> fields, Take take)
    : title_(std::move(title)), fields_(std::move(fields)), take_(std::move(take)) {
  for (const LaserField& field : fields_) lines_.emplace_back(field.value);
}

void LaserForm::go_to(const std::string& field) {
  for (std::size_t k = 0; k < fields_.size(); ++k)
    if (fields_[k].name == field) place_.selected = static_cast<int>(k);
}

LaserForm::Layout LaserForm::layout(const Area& area) const {
  constexpr int kHelpRows = 3;
  Layout out;
  const int columns = std::min(area.columns, std::max(60, area.columns - 8));
  out.fields = std::clamp(static_cast<int>(fields_.size()), 1, std::max(1, area.rows - kHelpRows - 2));
  const int rows = std::min(area.rows, out.fields + kHelpRows + 2);
  out.box = {area.row + (area.rows - rows) / 2, area.column + (area.columns - columns) / 2, rows, columns};
  out.inside = {out.box.row + 1, out.box.column + 1, std::max(0, rows - 2), std::max(0, columns - 2)};
  for (const LaserField& field : fields_) out.names = std::max(out.names, width_of(field.name));
  out.names = std::min(out.names + 4, out.inside.columns / 2);
  out.values = std::max(1, out.inside.columns - out.names - 1);
  return out;
}

void LaserForm::draw(Canvas& canvas, const Area& area) const {
  if (files_.active()) return files_.draw(canvas, area, 0);
  const Layout at = layout(area);
  canvas.fill(at.box);
  canvas.frame(at.box, title_, Tone::strong);
  const int count = static_cast<int>(fields_.size());
  place_.first = std::clamp(place_.first, std::max(0, place_.selected - at.fields + 1), place_.selected);
  for (int r = 0; r < std::min(at.fields, count - place_.first); ++r) {
    const auto k = static_cast<std::size_t>(place_.first + r);
    const bool here = place_.first + r == place_.selected;
    canvas.text(at.inside, r, 0, here ? ">" : " ", Tone::strong);
    canvas.text({at.inside.row, at.inside.column, at.inside.rows, at.names - 1}, r, 2, fields_[k].name,
                here ? Tone::strong : Tone::plain);
    lines_[k].draw(canvas, at.inside, r, at.names, at.values, here);
  }
  if (place_.first > 0) canvas.put(at.box.row + 1, at.box.column + at.box.columns - 1, U'↑', Tone::strong);
  if (place_.first + at.fields < count)
    canvas.put(at.box.row + at.fields, at.box.column + at.box.columns - 1, U'↓', Tone::strong);
  const LaserField& field = fields_[static_cast<std::size_t>(place_.selected)];
  std::string hint = hint_.empty() ? field.help : hint_;
  if (hint_.empty() && !field.choices.empty()) hint += " (Space or a letter chooses)";
  if (hint_.empty() && field.path) hint += " (Tab chooses or completes)";
  const Area help{at.inside.row + at.fields, at.inside.column + 1, std::max(0, at.inside.rows - at.fields - 1),
                  at.inside.columns - 2};
  canvas.paragraph(help, 0, hint, refused_ ? Tone::bad : Tone::faint);
  canvas.text(at.inside, at.inside.rows - 1, 1, "Enter takes it, Esc gives up", Tone::strong);
}

CellPosition LaserForm::cursor(const Area& area) const {
  if (files_.active()) return files_.cursor(area, 0);
  const Layout at = layout(area);
  const auto k = static_cast<std::size_t>(place_.selected);
  return {at.inside.row + place_.selected - place_.first,
          at.inside.column + at.names + lines_[k].cursor_column(at.values)};
}

void LaserForm::next_choice(int by) {
  const auto k = static_cast<std::size_t>(place_.selected);
  const auto& choices = fields_[k].choices;
  const auto found = std::find(choices.begin(), choices.end(), lines_[k].text());
  const int count = static_cast<int>(choices.size());
  const int now = found == choices.end() ? 0 : static_cast<int>(found - choices.begin());
  lines_[k].set(choices[static_cast<std::size_t>((now + by + count) % count)]);
}

/// The next word that holds this letter: C for EC.
void LaserForm::next_choice_with(char32_t letter) {
  const auto k = static_cast<std::size_t>(place_.selected);
  const std::string wanted = lower(utf8_of(letter));
  for (std::size_t tries = 0; tries < fields_[k].choices.size(); ++tries) {
    next_choice(1);
    if (lower(lines_[k].text()).find(wanted) != std::string::npos) return;
  }
}

void LaserForm::type(const Key& key) {
  const auto k = static_cast<std::size_t>(place_.selected);
  const LaserField& field = fields_[k];
  if (!field.choices.empty()) {
    if (is_letter(key, U' ') || key.name == Key::Name::right) next_choice(1);
    if (key.name == Key::Name::left) next_choice(-1);
    if (key.name == Key::Name::letter && key.letter != U' ') next_choice_with(key.letter);
    if (key.name == Key::Name::backspace) lines_[k].set("");
    return;
  }
  if (key.name == Key::Name::tab && field.path && lines_[k].text().empty()) {
    files_.choose(field.help, field.wish, [this, k](const std::string& path) { lines_[k].set(path); });
    return;
  }
  if (key.name == Key::Name::tab && field.path) {
    const PathCompletion found = completed_path(lines_[k].text());
    lines_[k].set(found.completed);
    hint_ = fmt::format("{}", fmt::join(found.choices, "  "));
    return;
  }
  (void)lines_[k].on_key(key);
}

bool LaserForm::on_key(const Key& key) {
  if (files_.on_key(key)) return true;
  hint_.clear();
  refused_ = false;
  const int count = static_cast<int>(fields_.size());
  if (key.name == Key::Name::escape) return false;
  if (key.name == Key::Name::enter) {
    std::vector<std::string> values;
    for (const TextLine& line : lines_) values.push_back(line.text());
    hint_ = take_(values);
    refused_ = !hint_.empty();
    return refused_;
  }
  if (key.name == Key::Name::up || key.name == Key::Name::down) {
    (void)place_.on_key(key, count);
  } else if (key.name == Key::Name::tab && !fields_[static_cast<std::size_t>(place_.selected)].path) {
    place_.selected = (place_.selected + 1) % count;
  } else {
    type(key);
  }
  return true;
}

}  // namespace ecs::app
