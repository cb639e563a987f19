#include "app/screens/talk.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "app/screens/event_log.hpp"

namespace ecs::app {

void MessageLine::say(const std::string& text, Tone tone) {
  text_ = text;
  tone_ = tone;
  log_event(tone, text);
}

void MessageLine::draw(Canvas& canvas, const Area& area) const {
  if (text_.empty() || area.rows <= 0) return;
  const auto lines = wrapped(text_, area.columns);
  const auto shown = std::min(lines.size(), static_cast<std::size_t>(area.rows));
  for (std::size_t r = 0; r < shown; ++r) canvas.text(area, static_cast<int>(r), 0, lines[r], tone_);
  if (shown < lines.size())
    canvas.text_right(area, area.rows - 1, canvas.glyphs() == Glyphs::ascii ? "..." : "…", tone_);
}

Reply reply_to(const Key& key) {
  if (is_letter(key, U'y') || is_letter(key, U'Y')) return Reply::yes;
  if (is_letter(key, U'n') || is_letter(key, U'N') || key.name == Key::Name::escape) return Reply::no;
  return Reply::none;
}

void draw_question(Canvas& canvas, const Area& area, const Question& question) {
  const int columns = std::min(area.columns, std::max(44, area.columns * 3 / 4));
  const auto title = wrapped(question.title, columns - 4);
  const auto detail = wrapped(question.detail, columns - 4);
  const int rows = std::min(area.rows, static_cast<int>(title.size() + detail.size()) + 4);
  const Area box{area.row + (area.rows - rows) / 2, area.column + (area.columns - columns) / 2, rows, columns};
  canvas.fill(box);
  canvas.frame(box, {}, Tone::warning);
  const Area inside{box.row + 1, box.column + 2, box.rows - 2, box.columns - 4};
  int row = 0;
  const auto put = [&](const std::vector<std::string>& lines, Tone tone) {  // the answers keep the last row
    for (const std::string& line : lines)
      if (row < inside.rows - 1) canvas.text(inside, row++, 0, line, tone);
  };
  put(title, Tone::strong);
  put(detail, Tone::plain);
  canvas.text(inside, inside.rows - 1, 0, fmt::format("y {}    n {}", question.yes, question.no), Tone::strong);
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
