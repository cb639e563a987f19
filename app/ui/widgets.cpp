#include "app/ui/widgets.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

namespace ecs::app {
namespace {

constexpr int kWheelRows = 3;

std::optional<int> moved(const Key& key, int from, int page, int last) {
  switch (key.name) {
    case Key::Name::up:
      return from - 1;
    case Key::Name::down:
      return from + 1;
    case Key::Name::wheel_up:
      return from - kWheelRows;
    case Key::Name::wheel_down:
      return from + kWheelRows;
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

void draw_scroll_marks(Canvas& canvas, const Area& area, int first, int count) {
  const int column = area.column + area.columns - 1;
  const auto put = [&](int row, int step, char32_t mark) {  // in a row near the edge whose text leaves room for it
    const int edge = row;
    for (int k = 0; k < std::min(2, area.rows / 2) && canvas.at(row, column).glyph != U' '; ++k) row += step;
    canvas.put(canvas.at(row, column).glyph == U' ' ? row : edge, column, mark, Tone::faint);
  };
  if (first > 0) put(area.row, 1, U'↑');
  if (first + area.rows < count) put(area.row + area.rows - 1, -1, U'↓');
}

bool ListPlace::on_key(const Key& key, int count, int page) {
  const auto to = moved(key, selected, page, count - 1);
  if (!to) return false;
  selected = std::clamp(*to, 0, std::max(0, count - 1));
  return true;
}

void draw_tabs(Canvas& canvas, const Area& area, int row, std::span<const char* const> titles, int here) {
  int column = 0;
  for (int p = 0; p < static_cast<int>(titles.size()); ++p)
    column += canvas.text(area, row, column,
                          fmt::format("{}{} {}{}", p == here ? "[" : " ", p + 1, titles[static_cast<std::size_t>(p)],
                                      p == here ? "]" : " "),
                          p == here ? Tone::strong : Tone::faint);
}

std::optional<int> ListPlace::clicked(const Key& key) const {
  if (key.name != Key::Name::mouse || key.row < seen.row || key.row >= seen.row + seen.rows) return std::nullopt;
  return first + key.row - seen.row;
}

void draw_list(Canvas& canvas, const Area& area, const std::vector<ListRow>& rows, const ListPlace& place,
               bool active) {
  const int count = static_cast<int>(rows.size());
  const int selected = std::clamp(place.selected, 0, std::max(0, count - 1));
  place.first = std::clamp(place.first, std::max(0, selected - area.rows + 1), std::max(0, selected));
  place.first = std::clamp(place.first, 0, std::max(0, count - area.rows));
  place.seen = area.top(std::min(area.rows, count - place.first));
  for (int r = 0; r < place.seen.rows; ++r) {
    const int k = place.first + r;
    const ListRow& row = rows[static_cast<std::size_t>(k)];
    const bool here = active && k == selected;
    if (here) canvas.fill({area.row + r, area.column, 1, area.columns}, U' ', Tone::selected);
    canvas.text(area, r, 0, here ? ">" : " ", here ? Tone::selected : Tone::plain);
    canvas.text(area, r, 2, row.text, here ? Tone::selected : row.tone);
  }
  draw_scroll_marks(canvas, area, place.first, count);
}

bool ScrollPlace::on_key(const Key& key, int page) {
  if (key.name == Key::Name::left || key.name == Key::Name::right) {
    column = std::max(0, column + (key.name == Key::Name::right ? kColumns : -kColumns));
    return true;
  }
  const auto to = moved(key, first, page, 1 << 20);
  if (!to) return false;
  first = std::max(0, *to);
  if (key.name == Key::Name::home) column = 0;
  return true;
}

namespace {

/// Rows of tables stay whole: cells stand at least two blanks apart.
bool is_sentence(const std::string& line) {
  const std::size_t begin = line.find_first_not_of(' ');
  return begin != std::string::npos && line.find(' ', begin) != std::string::npos &&
         line.find("  ", begin) == std::string::npos;
}

/// A sentence over several lines, indented as it was.
void add_wrapped(std::vector<std::string>& lines, const std::string& line, int columns) {
  const std::size_t indent = std::min(line.find_first_not_of(' '), static_cast<std::size_t>(std::max(0, columns - 20)));
  const std::string before(indent, ' ');
  for (const std::string& part : wrapped(line, columns - static_cast<int>(indent))) lines.push_back(before + part);
}

/// The part of a line that is seen from a column on, with a mark at either edge where it goes on.
void draw_sideways(Canvas& canvas, const Area& area, int row, const std::string& line, int from) {
  int column = -from;
  bool goes_on = false;
  for (const Letter& letter : letters_of(line)) {
    if (column >= 0 && column + letter.columns <= area.columns)
      canvas.put(area.row + row, area.column + column, letter.glyph);
    column += letter.columns;
    goes_on = goes_on || column > area.columns;
  }
  if (goes_on) canvas.put(area.row + row, area.column + area.columns - 1, U'→', Tone::strong);
  if (from > 0 && column + from > 0) canvas.put(area.row + row, area.column, U'←', Tone::strong);
}

}  // namespace

std::vector<std::string> sentences_wrapped(const std::vector<std::string>& lines, int columns) {
  std::vector<std::string> out;
  for (const std::string& line : lines) {
    if (width_of(line) > columns && is_sentence(line))
      add_wrapped(out, line, columns);
    else
      out.push_back(line);
  }
  return out;
}

void draw_scrolled(Canvas& canvas, const Area& area, const std::vector<std::string>& lines, const ScrollPlace& place) {
  const int count = static_cast<int>(lines.size());
  place.first = std::clamp(place.first, 0, std::max(0, count - area.rows));
  int widest = 0;
  for (const std::string& line : lines) widest = std::max(widest, width_of(line));
  const int steps = (std::max(0, widest - area.columns) + ScrollPlace::kColumns - 1) / ScrollPlace::kColumns;
  place.column = std::clamp(place.column, 0, steps * ScrollPlace::kColumns);
  for (int r = 0; r < std::min(area.rows, count - place.first); ++r)
    draw_sideways(canvas, area, r, lines[static_cast<std::size_t>(place.first + r)], place.column);
  draw_scroll_marks(canvas, area, place.first, count);
}

bool TextLine::on_key(const Key& key) {
  if (std::exchange(proposed_, false) && key.name == Key::Name::letter) set("");
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

std::string TextLine::text() const { return utf8_of(text_); }

void TextLine::set(const std::string& text) {
  text_ = code_points(text);
  at_ = text_.size();
  proposed_ = false;
}

void TextLine::propose(const std::string& text) {
  set(text);
  proposed_ = true;
}

/// Columns of the letters from `first` up to the cursor.
int TextLine::columns_before_cursor(std::size_t first) const {
  return width_of(utf8_of(std::u32string_view(text_).substr(first, at_ - first)));
}

std::size_t TextLine::first_seen(int columns) const {
  const int room = std::max(1, columns - 1);
  std::size_t first = at_ - std::min(at_, static_cast<std::size_t>(room));  // no letter takes less than a column
  while (first > 0 && columns_of(text_[first]) == 0) --first;
  while (first < at_ && columns_before_cursor(first) > room) ++first;
  return first;
}

int TextLine::cursor_column(int columns) const { return columns_before_cursor(first_seen(columns)); }

void TextLine::draw(Canvas& canvas, const Area& area, int row, int column, int columns, bool active) const {
  const Tone tone = active ? Tone::strong : Tone::plain;
  const std::size_t first = first_seen(columns);
  int used = 0;
  for (const Letter& letter : letters_of(utf8_of(std::u32string_view(text_).substr(first)))) {
    if (used + letter.columns > columns) break;
    canvas.put(area.row + row, area.column + column + used, letter.glyph, tone);
    used += letter.columns;
  }
  for (; used < columns; ++used) canvas.put(area.row + row, area.column + column + used, active ? U'_' : U' ', tone);
  if (first > 0 && columns > 1) canvas.put(area.row + row, area.column + column, U'…', Tone::faint);
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

int rows_of_message(const Message& message, int columns, int most) {
  if (message.text().empty()) return 1;
  return std::clamp(static_cast<int>(wrapped(message.text(), columns).size()), 1, std::max(1, most));
}

void draw_message(Canvas& canvas, const Area& area, const Message& message) {
  if (!message.text().empty() && area.rows > 0) canvas.paragraph(area, 0, message.text(), message.tone());
}

Reply reply_to(const Key& key) {
  if (is_letter(key, U'y') || is_letter(key, U'Y')) return Reply::yes;
  if (is_letter(key, U'n') || is_letter(key, U'N') || key.name == Key::Name::escape) return Reply::no;
  return Reply::none;
}

void draw_question(Canvas& canvas, const Area& area, const Question& question) {
  const int columns = std::min(area.columns, std::max(44, area.columns * 3 / 4));
  const auto title = wrapped(question.title, columns - 4);
  const auto detail = question.detail.empty() ? std::vector<std::string>{} : wrapped(question.detail, columns - 4);
  std::vector<std::string> answers{"y " + question.yes, "n " + question.no};
  if (width_of(answers[0]) + 4 + width_of(answers[1]) <= columns - 4) answers = {answers[0] + "    " + answers[1]};
  const int last = static_cast<int>(answers.size());
  const int rows = std::min(area.rows, static_cast<int>(title.size() + detail.size()) + 3 + last);
  const Area box{area.row + (area.rows - rows) / 2, area.column + (area.columns - columns) / 2, rows, columns};
  canvas.fill(box);
  canvas.frame(box, {}, Tone::warning);
  const Area inside{box.row + 1, box.column + 2, box.rows - 2, box.columns - 4};
  const Area asked = inside.top(inside.rows - last);  // the answers keep the last rows
  const int row = canvas.paragraph(asked, 0, question.title, Tone::strong);
  if (!question.detail.empty()) canvas.paragraph(asked, row, question.detail);
  for (int k = 0; k < last; ++k)
    canvas.text(inside, inside.rows - last + k, 0, answers[static_cast<std::size_t>(k)], Tone::strong);
}

void draw_question(Canvas& canvas, const Area& area, const Asking& asking) {
  if (asking.active()) draw_question(canvas, area, *asking.question());
}

bool answers(Asking& asking, const Key& key) {
  if (!asking.active()) return false;
  if (const Reply reply = reply_to(key); reply != Reply::none) asking.answer(reply == Reply::yes);
  return true;
}

void draw_bar(Canvas& canvas, const Area& area, int row, double value, double most, Tone tone) {
  const int length = most > 0.0 ? static_cast<int>(std::lround(value / most * area.columns)) : 0;
  for (int c = 0; c < std::clamp(length, 0, area.columns); ++c) canvas.put(area.row + row, area.column + c, U'█', tone);
}

void draw_progress(Canvas& canvas, const Area& area, int row, const std::string& label, double part,
                   double seconds_left) {
  const std::string left = seconds_left < 0.0 ? "" : fmt::format("  {:.0f} s left", std::ceil(seconds_left));
  const std::string right = fmt::format("{:3.0f} %{}", 100.0 * std::clamp(part, 0.0, 1.0), left);
  const int begin = canvas.text(area, row, 0, label, Tone::strong) + 2;
  const int columns = area.columns - begin - width_of(right) - 4;
  if (columns >= 5) {
    const int done = static_cast<int>(std::lround(std::clamp(part, 0.0, 1.0) * columns));
    canvas.text(area, row, begin,
                "[" + std::string(static_cast<std::size_t>(done), '=') +
                    std::string(static_cast<std::size_t>(columns - done), ' ') + "]");
  }
  canvas.text_right(area, row, right);
}

}  // namespace ecs::app
