// The two streams a verb speaks through, results on stdout, messages and the progress bar on stderr; and the keyboard:
// lines typed while it runs. Does not live here: which verb runs (program.hpp), what it answers (base/outcome.hpp).
#pragma once

#include <chrono>
#include <memory>
#include <ostream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "app/names/commissioning.hpp"
#include "base/result.hpp"
#include "commissioning/session/message.hpp"

namespace ecs::app {

/// Lines of any descriptor, read without waiting. The descriptor stays the caller's.
[[nodiscard]] std::shared_ptr<Keyboard> keyboard_of(int descriptor);
[[nodiscard]] std::shared_ptr<Keyboard> keyboard_of_stdin();

struct ConsoleOptions {
  bool messages_on_terminal = false;   ///< progress bar wanted
  bool answers_on_terminal = false;    ///< one that can move its cursor
  bool colour = false;                 ///< on the messages
  std::shared_ptr<Keyboard> keyboard;  ///< lines typed while a verb runs; empty: there is nobody to type
};

/// What stdout and stderr are; colour on a terminal unless NO_COLOR is set or TERM says "dumb".
[[nodiscard]] ConsoleOptions options_of_stderr();

/// Messages never reach stdout; with `json` nothing but JSON does. Text passes base/text.hpp, so that no file and no
/// unit can speak to the terminal.
class Console final : public MessageSink {
 public:
  Console(std::ostream& out, std::ostream& messages, ConsoleOptions options = {})
      : out_(&out), messages_(&messages), options_(std::move(options)) {}

  bool json = false;           ///< --json
  bool quiet = false;          ///< --quiet: no notes, no progress bar; warnings and problems stay
  std::string message_prefix;  ///< "EMULATOR: " while a verb writes to the bundled emulator

  void note(std::string_view text) override;
  void warn(std::string_view text) override;
  void show(const Problem& problem);

  /// A line of results, at once: for verbs that print as they go. Nothing with --json.
  void print(std::string_view text);
  /// A JSON object on a line of its own, at once. Nothing without --json.
  void print_json(std::string_view object);
  /// The whole answer of a verb: text or JSON.
  void answer(std::string_view text, std::string_view json_object);

  /// Draws the bar on a terminal, at most ten times a second, and takes it away at the end.
  /// @param fraction  0 … 1
  void progress(std::string_view label, double fraction, double seconds_left);
  void end_progress();

  /// Both streams are a terminal that can move its cursor, and text is wanted.
  [[nodiscard]] bool shows_blocks() const;
  /// Draws lines in place of those of the block before; messages appear above it. @pre shows_blocks()
  void show_block(const std::vector<std::string>& lines);
  /// Takes the block away.
  void end_block();

  /// Null: there is nobody to type.
  [[nodiscard]] Keyboard* keyboard() const { return options_.keyboard.get(); }

  /// False once stdout could not be written.
  [[nodiscard]] bool output_is_whole();

 private:
  void say(std::string_view colour, std::string_view text);
  void draw_block();
  void erase_block();

  std::ostream* out_;
  std::ostream* messages_;
  ConsoleOptions options_;
  std::vector<std::string> block_;
  bool bar_shown_ = false;
  std::chrono::steady_clock::time_point bar_drawn_{};
};

}  // namespace ecs::app
