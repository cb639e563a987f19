// How a screen talks with whoever sits before it: one line that says what happened, a question with yes or no, how far
// long work is. Does not live here: lists and text lines (widgets.hpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/ui/cells.hpp"
#include "app/ui/keys.hpp"
#include "base/result.hpp"

namespace ecs::app {

/// What was said last; everything said goes to the log as well (commissioning/session/event_log.hpp).
class MessageLine {
 public:
  void say(const std::string& text, Tone tone = Tone::good);
  void say(const Problem& problem) { say(to_text(problem), Tone::bad); }
  void clear() { text_.clear(); }
  [[nodiscard]] const std::string& text() const { return text_; }
  [[nodiscard]] bool is_problem() const { return tone_ == Tone::bad; }
  /// Rows that it takes, 1 to `most`: a screen gives it those and the rest to what stands above.
  [[nodiscard]] int rows(int columns, int most) const;
  /// Whole words over as many rows as `area` has; the last one ends in "… F2" where it is not all (cells.hpp).
  void draw(Canvas& canvas, const Area& area) const;

 private:
  std::string text_;
  Tone tone_ = Tone::good;
};

/// Asked before something moves, is overwritten or is lost.
struct Question {
  std::string title;   ///< "Send the parameters to the unit?"
  std::string detail;  ///< what will happen: what moves, what is lost
  std::string yes = "yes";
  std::string no = "no";
};
enum class Reply { none, yes, no };
/// y: yes; n, Esc: no; Enter is neither: nobody confirms by accident.
[[nodiscard]] Reply reply_to(const Key& key);
/// A box in the middle of `area`.
void draw_question(Canvas& canvas, const Area& area, const Question& question);

/// "sending the map  [=======>      ]  62 %  8 s left"; a negative `seconds_left` is not shown.
void draw_progress(Canvas& canvas, const Area& area, int row, const std::string& label, double part,
                   double seconds_left = -1.0);

}  // namespace ecs::app
