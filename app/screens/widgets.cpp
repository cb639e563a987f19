#include "app/screens/widgets.hpp"

#include <algorithm>
#include <filesystem>

namespace ecs::app {
namespace {

/// A mark at the right edge where there is more above or below.
void draw_more(Canvas& canvas, const Area& area, int first, int count) {
  if (first > 0) canvas.put(area.row, area.column + area.columns - 1, U'↑', Tone::faint);
  if (first + area.rows < count)
    canvas.put(area.row + area.rows - 1, area.column + area.columns - 1, U'↓', Tone::faint);
}

std::optional<int> moved(const Key& key, int from, int page, int last) {
  switch (key.name) {
    case Key::Name::up:
      return from - 1;
    case Key::Name::down:
      return from + 1;
    case Key::Name::page_up:
      return from - page;
    case Key::Name::page_down:
      return from + page;
    case Key::Name::home:
      return 0;
    case Key::Name::end:
      return last;
    default:
      return std::nullopt;
  }
}

}  // namespace

bool ListPlace::on_key(const Key& key, int count, int page) {
  const auto to = moved(key, selected, page, count - 1);
  if (!to) return false;
  selected = std::clamp(*to, 0, std::max(0, count - 1));
  return true;
}

void draw_list(Canvas& canvas, const Area& area, const std::vector<ListRow>& rows, const ListPlace& place,
               bool active) {
  const int count = static_cast<int>(rows.size());
  const int selected = std::clamp(place.selected, 0, std::max(0, count - 1));
  place.first = std::clamp(place.first, std::max(0, selected - area.rows + 1), std::max(0, selected));
  place.first = std::clamp(place.first, 0, std::max(0, count - area.rows));
  for (int r = 0; r < std::min(area.rows, count - place.first); ++r) {
    const int k = place.first + r;
    const ListRow& row = rows[static_cast<std::size_t>(k)];
    const bool here = active && k == selected;
    if (here) canvas.fill({area.row + r, area.column, 1, area.columns}, U' ', Tone::selected);
    canvas.text(area, r, 0, here ? ">" : " ", here ? Tone::selected : Tone::plain);
    canvas.text(area, r, 2, row.text, here ? Tone::selected : row.tone);
  }
  draw_more(canvas, area, place.first, count);
}

bool ScrollPlace::on_key(const Key& key, int page) {
  const auto to = moved(key, first, page, 1 << 20);
  if (!to) return false;
  first = std::max(0, *to);
  return true;
}

void draw_scrolled(Canvas& canvas, const Area& area, const std::vector<std::string>& lines, const ScrollPlace& place) {
  const int count = static_cast<int>(lines.size());
  place.first = std::clamp(place.first, 0, std::max(0, count - area.rows));
  for (int r = 0; r < std::min(area.rows, count - place.first); ++r)
    canvas.text(area, r, 0, lines[static_cast<std::size_t>(place.first + r)]);
  draw_more(canvas, area, place.first, count);
}

bool TextLine::on_key(const Key& key) {
  switch (key.name) {
    case Key::Name::letter:
      text_.insert(at_, 1, key.letter);
      ++at_;
      return true;
    case Key::Name::backspace:
      if (at_ > 0) text_.erase(--at_, 1);
      return true;
    case Key::Name::erase:
      if (at_ < text_.size()) text_.erase(at_, 1);
      return true;
    case Key::Name::left:
      if (at_ > 0) --at_;
      return true;
    case Key::Name::right:
      if (at_ < text_.size()) ++at_;
      return true;
    case Key::Name::home:
      at_ = 0;
      return true;
    case Key::Name::end:
      at_ = text_.size();
      return true;
    case Key::Name::control:
      if (key.letter != U'u') return false;
      text_.erase(0, at_);
      at_ = 0;
      return true;
    default:
      return false;
  }
}

std::string TextLine::text() const {
  std::string out;
  for (const char32_t glyph : text_) out += utf8_of(glyph);
  return out;
}

void TextLine::set(const std::string& text) {
  text_ = code_points(text);
  at_ = text_.size();
}

std::size_t TextLine::first_seen(int columns) const {
  const auto room = static_cast<std::size_t>(std::max(1, columns - 1));
  return at_ > room ? at_ - room : 0;
}

int TextLine::cursor_column(int columns) const { return static_cast<int>(at_ - first_seen(columns)); }

void TextLine::draw(Canvas& canvas, const Area& area, int row, int column, int columns, bool active) const {
  const std::size_t first = first_seen(columns);
  for (int c = 0; c < columns; ++c) {
    const std::size_t k = first + static_cast<std::size_t>(c);
    const char32_t blank = active ? U'_' : U' ';
    canvas.put(area.row + row, area.column + column + c, k < text_.size() ? text_[k] : blank,
               active ? Tone::strong : Tone::plain);
  }
}

PathCompletion completed_path(const std::string& typed) {
  namespace fs = std::filesystem;
  const std::size_t slash = typed.rfind('/');
  const std::string folder = slash == std::string::npos ? "" : typed.substr(0, slash + 1);
  const std::string begun = slash == std::string::npos ? typed : typed.substr(slash + 1);
  PathCompletion completion{typed, {}};
  std::error_code fault;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder.empty() ? "." : folder, fault)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(begun) || (begun.empty() && name.starts_with("."))) continue;
    std::error_code no_folder;
    completion.choices.push_back(name + (entry.is_directory(no_folder) ? "/" : ""));
  }
  std::sort(completion.choices.begin(), completion.choices.end());
  if (completion.choices.empty()) return completion;
  std::string common = completion.choices.front();
  for (const std::string& choice : completion.choices) {
    std::size_t same = 0;
    while (same < common.size() && same < choice.size() && common[same] == choice[same]) ++same;
    common.resize(same);
  }
  completion.completed = folder + common;
  if (completion.choices.size() == 1) completion.choices.clear();
  return completion;
}

PathCompletion completed_paths(const std::string& typed) {
  std::size_t start = 0;
  bool quoted = false;
  for (std::size_t k = 0; k < typed.size(); ++k) {
    if (typed[k] == '"') quoted = !quoted;
    if (typed[k] == ' ' && !quoted) start = k + 1;
  }
  std::string word = typed.substr(start);
  if (word.starts_with('"')) word.erase(0, 1);
  PathCompletion found = completed_path(word);
  if (found.completed.find(' ') != std::string::npos) {
    const bool whole = found.choices.empty() && !found.completed.ends_with('/');
    found.completed = '"' + found.completed + (whole ? "\"" : "");
  }
  found.completed = typed.substr(0, start) + found.completed;
  return found;
}

}  // namespace ecs::app
