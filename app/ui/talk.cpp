#include "app/ui/talk.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace ecs::app {

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
