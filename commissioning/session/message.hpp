// What work under way and whoever asked for it say to each other: tones, messages, questions, lines that are typed; and
// the log of what the screens said. A verb prints them, a screen shows them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

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

/// What was said last to the user of a controller; everything said goes to the log as well (log_event()).
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

/// Lines that a person, or a script in that place, types while something runs.
class Keyboard {
 public:
  virtual ~Keyboard() = default;
  /// The next whole line, without its end, if it is there already.
  [[nodiscard]] virtual std::optional<std::string> line() = 0;
  /// No line will come any more.
  [[nodiscard]] virtual bool ended() const = 0;
};

struct LogEntry {
  std::string time;  ///< "14:05:09", local
  Tone tone = Tone::plain;
  std::string text;
};

/// From any thread. The same text again at once counts once.
void log_event(Tone tone, const std::string& text);
/// The last thousand.
[[nodiscard]] std::vector<LogEntry> logged();
/// What must still be read when the screens are gone: logged, and printed once the terminal is given back.
void leave_word(const std::string& text);
[[nodiscard]] std::vector<std::string> words_left();
/// state_folder()/screens.log; started again when it has grown beyond a megabyte. Empty: there is nowhere to write.
[[nodiscard]] std::filesystem::path log_file();

}  // namespace ecs::commissioning
