#include "app/screens/laser/mapping.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

namespace ecs::app {
namespace {

constexpr int kLabels = 9;         ///< "heading" and its margin
constexpr int kSettingNames = 10;  ///< "approach" and its margins
constexpr int kSettings = 31;
constexpr int kRoomForBoth = 66;  ///< settings and preview beside each other
constexpr int kLines = 2 + static_cast<int>(kMappingSettings);

}  // namespace

MappingForm::MappingForm(MappedTable table, Take accept, Take others)
    : table_(std::move(table)), accept_(std::move(accept)), others_(std::move(others)) {
  for (std::size_t k = table_.columns(); k-- > 0;)
    if (table_.role(k) != "-") column_ = k;
  parked_.set(table_.answers().parked);
}

void MappingForm::go_to_parked() { line_ = kLines - 1; }

MappingForm::Layout MappingForm::layout(const Area& area) const {
  Layout at;
  at.inside = area.inside();
  constexpr int kFixed = 4;  // numbers, headings, roles, units
  const int below = static_cast<int>(kMappingSettings) + 2;
  at.first_rows = std::clamp(at.inside.rows - kFixed - below, 1, static_cast<int>(table_.first_rows().size()));
  at.table = at.inside.top(std::min(at.inside.rows, kFixed + at.first_rows));
  const Area rest = at.inside.below(at.table.rows);
  const int help = rest.rows > below ? 2 : 1;
  at.help = rest.below(std::max(0, rest.rows - help)).between_margins();
  const Area middle = rest.top(std::max(0, rest.rows - help)).below(rest.rows >= below ? 1 : 0);
  const bool both = middle.columns >= kRoomForBoth;
  at.settings = both ? middle.left(kSettings) : middle;
  at.preview = both ? middle.right_of(kSettings + 1) : at.help;
  return at;
}

int MappingForm::width_of_column(std::size_t column) const {
  constexpr int kLeast = 6, kMost = 15;
  int width = std::max(
      {kLeast, width_of(table_.heading(column)), width_of(table_.role(column)), width_of(table_.unit(column))});
  for (const auto& row : table_.first_rows()) width = std::max(width, width_of(row[column]));
  return std::min(width, kMost) + 1;
}

/// The column under the cursor is whole between the edges.
void MappingForm::scroll_to_cursor(int columns) const {
  first_ = std::min(first_, column_);
  const auto width_up_to_cursor = [&] {
    int width = 0;
    for (std::size_t k = first_; k <= column_; ++k) width += width_of_column(k);
    return width;
  };
  while (first_ < column_ && width_up_to_cursor() > columns) ++first_;
}

void MappingForm::draw_table(Canvas& canvas, const Layout& at) const {
  const Area cells = at.table.right_of(kLabels);
  scroll_to_cursor(cells.columns - 2);
  const int role_row = at.table.rows - 2;
  const auto label = [&](int row, const char* text) { canvas.text(at.table, row, 1, text, Tone::faint); };
  label(0, "column");
  label(1, "heading");
  if (!table_.has_headings()) canvas.text(cells, 1, 0, "none", Tone::faint);
  label(role_row, "role");
  label(role_row + 1, "unit");
  int left = 0;
  std::size_t k = first_;
  for (; k < table_.columns() && left + width_of_column(k) <= cells.columns - 2; ++k) {
    const int width = width_of_column(k);
    const Area column{cells.row, cells.column + left, cells.rows, width - 1};
    const bool read = table_.role(k) != "-";
    const Tone tone = read ? Tone::plain : Tone::faint;
    canvas.text(column, 0, 0, fmt::format("{}", k + 1), k == column_ ? Tone::strong : Tone::faint);
    canvas.text(column, 1, 0, table_.heading(k), tone);
    for (int r = 0; r < at.first_rows; ++r)
      canvas.text(column, 2 + r, 0, table_.first_rows()[static_cast<std::size_t>(r)][k], tone);
    for (const int line : {kRoleLine, kUnitLine}) {
      const bool here = k == column_ && line == line_;
      const std::string text = line == kRoleLine ? table_.role(k) : table_.unit(k);
      canvas.text(column, role_row + line, 0, here ? in_columns(text, width - 1) : text,
                  here   ? Tone::selected
                  : read ? Tone::strong
                         : Tone::faint);
    }
    left += width;
  }
  if (first_ > 0) canvas.text(at.table, 0, kLabels - 1, "<", Tone::strong);
  if (k < table_.columns()) canvas.text_right(at.table, 0, fmt::format("{} >", table_.columns()), Tone::strong);
  if (in_table()) canvas.text(at.table, role_row + line_, 0, ">", Tone::strong);
}

void MappingForm::draw_settings(Canvas& canvas, const Layout& at) const {
  const auto settings = table_.settings();
  const int here = line_ - kUnitLine - 1;
  const int first = std::clamp(here - at.settings.rows + 1, 0, static_cast<int>(settings.size()));
  const int shown = std::min(at.settings.rows, static_cast<int>(settings.size()) - first);
  const Area values = at.settings.right_of(kSettingNames);
  for (int r = 0; r < shown; ++r) {
    const int place = first + r;
    const SettingWords& words = settings[static_cast<std::size_t>(place)];
    const bool selected = place == here;
    canvas.text(at.settings, r, 0, selected ? ">" : " ", Tone::strong);
    canvas.text(at.settings, r, 1, words.name, Tone::faint);
    if (place == static_cast<int>(MappingSetting::parked))
      parked_.draw(canvas, values, r, 0, values.columns, selected);
    else
      canvas.text(values, r, 0, words.value, selected ? Tone::selected : Tone::plain);
  }
}

void MappingForm::draw_preview(Canvas& canvas, const Layout& at) const {
  const MappingPreview& preview = table_.preview();
  const bool wrong = !preview.wrong.empty();
  std::vector<ListRow> texts;
  if (wrong) texts.push_back({(refused_ ? "Not accepted: " : "") + preview.wrong, Tone::bad});
  for (const std::string& line : preview.lines) texts.push_back({line, texts.empty() ? Tone::good : Tone::plain});
  int row = 0;
  for (const ListRow& text : texts)
    if (row < at.preview.rows) row += canvas.paragraph(at.preview, row, text.text, text.tone);
}

MappingSetting MappingForm::setting() const { return static_cast<MappingSetting>(line_ - kUnitLine - 1); }

std::string MappingForm::help() const {
  if (line_ == kRoleLine) return table_.role_help(column_) + " (Space, Backspace or a letter changes it)";
  if (line_ == kUnitLine)
    return "unit of the column (Space, Backspace change it; * uses it although the heading states another)";
  const std::string own = table_.settings()[static_cast<std::size_t>(setting())].help;
  return own + (setting() == MappingSetting::parked ? "" : " (Space changes it)");
}

void MappingForm::draw(Canvas& canvas, const Area& area) const {
  canvas.fill(area);
  canvas.frame(
      area, fmt::format("Columns of {}: {}", std::filesystem::path(table_.path()).filename().string(), table_.origin()),
      Tone::strong);
  const Layout at = layout(area);
  draw_table(canvas, at);
  draw_settings(canvas, at);
  if (at.preview.row != at.help.row) canvas.paragraph(at.help, 0, help(), Tone::faint);
  draw_preview(canvas, at);
}

CellPosition MappingForm::cursor(const Area& area) const {
  if (in_table() || setting() != MappingSetting::parked) return {-1, -1};
  const Layout at = layout(area);
  const int row = std::min(static_cast<int>(MappingSetting::parked), at.settings.rows - 1);
  return {at.settings.row + row,
          at.settings.column + kSettingNames + parked_.cursor_column(at.settings.columns - kSettingNames)};
}

void MappingForm::on_table_key(const Key& key) {
  const std::size_t last = table_.columns() - 1;
  const bool role = line_ == kRoleLine;
  const auto next = [&](int by) { role ? table_.next_role(column_, by) : table_.next_unit(column_, by); };
  if (key.name == Key::Name::left && column_ > 0) --column_;
  if (key.name == Key::Name::right && column_ < last) ++column_;
  if (key.name == Key::Name::home) column_ = 0;
  if (key.name == Key::Name::end) column_ = last;
  if (key.name == Key::Name::backspace) next(-1);
  if (key.name == Key::Name::erase) table_.clear_role(column_);
  if (key.name != Key::Name::letter) return;
  if (key.letter == U' ')
    next(+1);
  else if (key.letter == U'-')
    table_.clear_role(column_);
  else if (key.letter == U'*')
    table_.toggle_forced_unit(column_);
  else if (role && key.letter < 0x80)
    table_.next_role_with(column_, static_cast<char>(key.letter));
}

void MappingForm::on_setting_key(const Key& key) {
  if (setting() == MappingSetting::parked) {
    if (parked_.on_key(key)) table_.set_parked(parked_.text());
    return;
  }
  const bool forward = is_letter(key, U' ') || key.name == Key::Name::right;
  const bool backward = key.name == Key::Name::backspace || key.name == Key::Name::left;
  if (!forward && !backward) return;
  table_.next_value(setting(), forward ? 1 : -1);
  parked_.set(table_.answers().parked);
}

bool MappingForm::on_key(const Key& key) {
  refused_ = false;
  switch (key.name) {
    case Key::Name::escape:
      return false;
    case Key::Name::enter:
      refused_ = !table_.preview().wrong.empty();
      if (!refused_) accept_(table_);
      return refused_;
    case Key::Name::tab:
      others_(table_);
      return false;
    case Key::Name::up:
      line_ = std::max(kRoleLine, line_ - 1);
      return true;
    case Key::Name::down:
      line_ = std::min(kLines - 1, line_ + 1);
      return true;
    default:
      break;
  }
  if (in_table())
    on_table_key(key);
  else
    on_setting_key(key);
  return true;
}

std::vector<KeyHelp> MappingForm::keys() const {
  return {{"Enter", "accept"}, {"left/right", "column"}, {"up/down", "line"}, {"Space", "change"},
          {"-", "not read"},   {"Tab", "other options"}, {"Esc", "cancel"}};
}

}  // namespace ecs::app
