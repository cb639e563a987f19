// A verb that talks with whoever runs it: what comes next in the upper row, what it said below as it says it, a line to
// type into.
#include "app/screens/verbs/live_screen.hpp"

#include <algorithm>
#include <deque>
#include <memory>
#include <mutex>
#include <ostream>
#include <sstream>
#include <streambuf>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/ui/screen.hpp"
#include "app/ui/widgets.hpp"
#include "app/verbs/registry.hpp"
#include "base/text.hpp"
#include "commissioning/session/commands.hpp"
#include "commissioning/session/task_runner.hpp"

namespace ecs::app {
namespace {

constexpr std::string_view kNext = "next: ";
constexpr const char* kLeave = "q";

/// Between the verb, which runs beside the screen, and the screen: what it says, what is typed to it.
struct Wire {
  std::mutex mutex;
  std::string said;
  std::deque<std::string> typed;

  class Mouth final : public std::streambuf {
   public:
    explicit Mouth(Wire& wire) : wire_(&wire) {}

   protected:
    int_type overflow(int_type c) override {
      if (traits_type::eq_int_type(c, traits_type::eof())) return traits_type::not_eof(c);
      const std::lock_guard lock(wire_->mutex);
      wire_->said += traits_type::to_char_type(c);
      return c;
    }
    std::streamsize xsputn(const char* text, std::streamsize count) override {
      const std::lock_guard lock(wire_->mutex);
      wire_->said.append(text, static_cast<std::size_t>(count));
      return count;
    }

   private:
    Wire* wire_;
  };

  class Keys final : public Keyboard {
   public:
    Keys(Wire& wire, JobControl& control) : wire_(&wire), control_(&control) {}
    std::optional<std::string> line() override {
      if (control_->cancelled) return kLeave;
      const std::lock_guard lock(wire_->mutex);
      if (wire_->typed.empty()) return std::nullopt;
      std::string line = std::move(wire_->typed.front());
      wire_->typed.pop_front();
      return line;
    }
    [[nodiscard]] bool ended() const override { return false; }

   private:
    Wire* wire_;
    JobControl* control_;
  };

  void type(const std::string& line) {
    const std::lock_guard lock(mutex);
    typed.push_back(line);
  }
};

class LiveScreen final : public Screen {
 public:
  /// @param words  the command line; it is run at once
  LiveScreen(std::string name, const std::vector<std::string>& words)
      : name_(std::move(name)), wire_(std::make_shared<Wire>()) {
    const auto work = [words, wire = wire_](JobControl& control) {
      Wire::Mouth mouth(*wire);
      std::ostream messages(&mouth);
      std::ostringstream out;
      ConsoleOptions options;
      options.keyboard = std::make_shared<Wire::Keys>(*wire, control);
      const int code = run_program(words, out, messages, options);
      return Answer{owned_lines_of(out.str()), code};
    };
    task_.start("running", work, [this, words](Answer answer) {
      answer_ = std::move(answer);
      if (answer_->exit_code > 1) return;
      note_remark("it asks for what is typed");
      note_command(words, answer_->exit_code);
    });
  }

  [[nodiscard]] std::string title() const override { return name_; }
  void draw(Canvas& canvas, const Area& area) const override {
    const Area inside = area.between_margins();
    int row = 0;
    if (answer_) {
      canvas.text(inside, row++, 0, answer_->exit_code == 0 ? "done" : "not finished: see below",
                  answer_->exit_code == 0 ? Tone::good : Tone::warning);
      std::vector<std::string> lines = answer_->lines;
      lines.insert(lines.end(), said_.begin(), said_.end());
      draw_scrolled(canvas, inside.below(row), sentences_wrapped(lines, inside.columns), scroll_);
      return;
    }
    row += std::max(1, canvas.paragraph(inside, row, next().empty() ? "running ..." : next(), Tone::strong));
    canvas.text(inside, row, 0, ">", Tone::strong);
    line_.draw(canvas, inside, row, 2, std::max(8, inside.columns - 2), true);
    row += 2;
    for (auto line = said_.rbegin(); line != said_.rend() && row < inside.rows; ++line) {
      if (line->starts_with(kNext)) continue;
      row += canvas.paragraph(inside, row, *line, line->starts_with("warning:") ? Tone::warning : Tone::plain);
    }
  }

  /// Enter sends the line; Esc asks the verb to leave, and goes back once it has ended.
  [[nodiscard]] Step on_key(const Key& key) override {
    if (answer_) {
      if (key.name == Key::Name::escape || key.name == Key::Name::enter) return back();
      (void)scroll_.on_key(key);
      return stay();
    }
    if (key.name == Key::Name::escape) {
      task_.cancel();
      return stay();
    }
    if (key.name == Key::Name::enter) {
      wire_->type(line_.text());
      line_.set("");
      return stay();
    }
    (void)line_.on_key(key);
    return stay();
  }

  [[nodiscard]] std::vector<KeyHelp> keys() const override {
    if (answer_) return {{"up/down", "read"}, {"Esc", "back"}};
    return {{"Enter", "take a reading, or send what is typed"},
            {"u", "take the last one back"},
            {"s", "skip"},
            {"Esc", "leave; what was read is kept"}};
  }

  [[nodiscard]] std::string help() const override {
    return "The verb `ecs " + name_ +
           "` as it runs. The upper row says what comes next, the rows below what it said, the newest first. Type a "
           "value, or a command (u takes the last reading back, s skips a target, q leaves), and press Enter; an empty "
           "line is a trigger where readings come from a device. Esc leaves: what was read is kept in a .part file, "
           "and "
           "--resume goes on with it.";
  }

  [[nodiscard]] bool advance() override {
    std::string text;
    {
      const std::lock_guard lock(wire_->mutex);
      const std::size_t whole = wire_->said.rfind('\n');
      if (whole != std::string::npos) {
        text = wire_->said.substr(0, whole);
        wire_->said.erase(0, whole + 1);
      }
    }
    if (!text.empty())
      for (std::string& line : owned_lines_of(text)) said_.push_back(std::move(line));
    return task_.advance() || task_.running() || !text.empty();
  }

  [[nodiscard]] bool typing() const override { return task_.running(); }
  [[nodiscard]] CellPosition cursor(const Area& area) const override {
    if (answer_) return {-1, -1};
    const int columns = area.columns - 2;
    const int rows = std::max<int>(1, static_cast<int>(wrapped(next(), columns).size()));
    return {area.row + rows, area.column + 3 + line_.cursor_column(std::max(8, columns - 2))};
  }

 private:
  struct Answer {
    std::vector<std::string> lines;
    int exit_code = 0;
  };
  /// The line that says what comes next, as long as it is the verb's last word on it.
  [[nodiscard]] std::string next() const {
    const auto found =
        std::find_if(said_.rbegin(), said_.rend(), [](const std::string& line) { return line.starts_with(kNext); });
    return found == said_.rend() ? std::string() : *found;
  }

  std::string name_;
  std::shared_ptr<Wire> wire_;
  std::vector<std::string> said_;
  TextLine line_;
  ScrollPlace scroll_;
  std::optional<Answer> answer_;
  TaskRunner task_;
};

}  // namespace

bool runs_live(const std::string& verb) { return verb == "laser capture" || verb == "laser devices"; }

std::unique_ptr<Screen> live_screen(std::string name, const std::vector<std::string>& words) {
  return std::make_unique<LiveScreen>(std::move(name), words);
}

}  // namespace ecs::app
