// What the screens of ECS UTILITY share: the unit as it was seen last, a question with what follows from it, a line to
// type into, the axes in rows. Does not live here: the line to the unit (commissioning/link/unit_connection.hpp), what
// a screen does.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/ui/talk.hpp"
#include "app/ui/widgets.hpp"
#include "commissioning/link/unit_connection.hpp"

namespace ecs::app {

/// The unit as it was seen last, and how long ago.
struct UnitView {
  WatchedUnit standing;                           ///< without samples
  std::optional<protocol::MonitorSample> sample;  ///< the last one that came, also when the line is lost
  bool fresh = false;                             ///< `sample` came from the line that is open
  double age_s = 0.0;                             ///< of `sample`
  int restarts = 0;                               ///< how often the unit began anew while it was watched
  std::uint64_t changes = 0;

  /// @return whether there is anything new to draw
  bool look(const UnitConnection& connection);
  /// A sample that came with a piece of work while the connection could not look.
  void take(const protocol::MonitorSample& seen);
  [[nodiscard]] std::vector<Axis> axes() const;  ///< that the unit has; all as long as none answered
  [[nodiscard]] const protocol::AxisSample* axis(Axis which) const;
  [[nodiscard]] bool integrating() const { return sample && sample->mode == UnitMode::integration; }

 private:
  void take(const protocol::MonitorSample& seen, std::chrono::steady_clock::time_point at);
  std::chrono::steady_clock::time_point taken_at_{};
  std::uint64_t times_lost_ = 0;  ///< lines, when `sample` came
};

/// Whether the unit was started again between two samples: it then shows less than it had run, or lacks, of the time
/// that passed, at least all it had run before; half of that is the limit, for samples that came late.
/// @param passed  from one sample to the other while the line was lost, else 0
[[nodiscard]] bool began_anew(const protocol::MonitorSample& before, const protocol::MonitorSample& after,
                              std::chrono::steady_clock::duration passed);

[[nodiscard]] double seconds_since(std::chrono::steady_clock::time_point moment);

/// "seen 4 s ago", coarse; empty below one second.
[[nodiscard]] std::string age_text(double age_s);

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
  [[nodiscard]] Place cursor(const Area& area, int row) const;

 private:
  [[nodiscard]] int columns(const Area& area) const;
  std::string label_;
  Kind kind_ = Kind::number;
  TextLine line_;
  std::string hint_;
  std::function<void(const std::string&)> on_text_;
};

/// How work ended that did not succeed: given up by the user, or the problem. Empties `given_up`.
void say_failed(MessageLine& message, const Problem& problem, bool& given_up);

/// A stem with the local time, "datum-x-20260504-140509.csv".
[[nodiscard]] std::string file_name_now(const std::string& stem, const std::string& extension);

/// Which of `count` axes was clicked whose first stands on this row of the canvas.
[[nodiscard]] std::optional<int> axis_clicked(const Key& key, int first_row, int count);

/// A file or folder is there already.
[[nodiscard]] bool file_is_there(const std::string& path);

/// The axis that a letter names, "x" or "X".
[[nodiscard]] std::optional<Axis> axis_of_key(const Key& key);

}  // namespace ecs::app
