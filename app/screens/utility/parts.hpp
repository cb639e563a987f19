// What the screens of ECS UTILITY share: the unit's state and its axes in rows, a question with what follows from it, a
// line to type into.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/ui/talk.hpp"
#include "app/ui/widgets.hpp"
#include "commissioning/utility/unit_view.hpp"

namespace ecs::app {

/// Why there is no answer, over two rows; else the unit's name, mode and fault on one.
void draw_unit_row(Canvas& canvas, const Area& area, int row, const UnitView& unit);

/// Heading and a row for each axis: position, speed, referenced, switch, marker, relay; `chosen` is marked.
/// @return rows used
int draw_axis_rows(Canvas& canvas, const Area& area, int row, const UnitView& unit, std::optional<Axis> chosen);

/// A question that waits for its answer, and what is done after yes.
class Asking {
 public:
  void ask(Question question, std::function<void()> on_yes);
  [[nodiscard]] bool active() const { return question_.has_value(); }
  /// @return whether the key was for the question: while one waits, all are
  bool on_key(const Key& key);
  void draw(Canvas& canvas, const Area& area) const;
  [[nodiscard]] const std::optional<Question>& question() const { return question_; }

 private:
  std::optional<Question> question_;
  std::function<void()> on_yes_;
};

/// A line of text asked for: a number, a file. Enter takes it, Esc drops it, Tab completes a path.
class Prompt {
 public:
  enum class Kind { number, path };
  void ask(std::string label, Kind kind, const std::string& text, std::function<void(const std::string&)> on_text);
  [[nodiscard]] bool active() const { return on_text_ != nullptr; }
  /// @return whether the key was for the line: while it is open, all are
  bool on_key(const Key& key);
  void draw(Canvas& canvas, const Area& area, int row) const;
  [[nodiscard]] CellPosition cursor(const Area& area, int row) const;

 private:
  [[nodiscard]] int columns(const Area& area) const;
  std::string label_;
  Kind kind_ = Kind::number;
  TextLine line_;
  std::string hint_;
  std::function<void(const std::string&)> on_text_;
};

/// Which of `count` axes was clicked whose first stands on this row of the canvas.
[[nodiscard]] std::optional<int> axis_clicked(const Key& key, int first_row, int count);

/// The axis that a letter names, "x" or "X".
[[nodiscard]] std::optional<Axis> axis_of_key(const Key& key);

}  // namespace ecs::app
