// What an action has to say to whoever asked for it: tones, messages, questions. A verb prints them, a screen shows
// them.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "base/result.hpp"

namespace ecs::commissioning {

/// What a text or a cell means; the terminal turns it into colours where it has them, else into bold, reverse,
/// underline.
enum class Tone : std::uint8_t {
  plain,
  faint,     ///< frames, units, hints
  strong,    ///< headings, the thing that matters
  selected,  ///< under the cursor
  good,
  warning,
  bad,
  forward,  ///< approach +1
  reverse,  ///< approach −1
};

/// Receives notes and warnings of work under way, in their order; they are kept where the work fails later.
class MessageSink {
 public:
  MessageSink() = default;
  MessageSink(const MessageSink&) = default;
  MessageSink& operator=(const MessageSink&) = default;
  virtual ~MessageSink() = default;
  virtual void note(std::string_view text) = 0;
  virtual void warn(std::string_view text) = 0;
};

/// Where nobody reads them.
class NoMessages final : public MessageSink {
 public:
  void note(std::string_view) override {}
  void warn(std::string_view) override {}
};

/// What was said last to the user of a controller; everything said goes to the log as well (event_log.hpp).
class Message {
 public:
  void say(const std::string& text, Tone tone = Tone::good);
  void say(const Problem& problem) { say(to_text(problem), Tone::bad); }
  void clear() { text_.clear(); }
  [[nodiscard]] const std::string& text() const { return text_; }
  [[nodiscard]] Tone tone() const { return tone_; }
  [[nodiscard]] bool is_problem() const { return tone_ == Tone::bad; }

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

/// A question that waits for its answer, and what follows it.
class Asking {
 public:
  void ask(Question question, std::function<void()> on_yes, std::function<void()> on_no = {});
  [[nodiscard]] bool active() const { return question_.has_value(); }
  [[nodiscard]] const std::optional<Question>& question() const { return question_; }
  /// @pre active(); what follows may ask again
  void answer(bool yes);

 private:
  std::optional<Question> question_;
  std::function<void()> on_yes_, on_no_;
};

}  // namespace ecs::commissioning
