#include "app/screens/screens_program.hpp"

#include <algorithm>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "app/interrupt.hpp"
#include "app/screens/drafts.hpp"
#include "app/screens/talk.hpp"
#include "app/screens/widgets.hpp"

namespace ecs::app {
namespace {

constexpr int kWait_ms = 40;  ///< between two looks at running work

void draw_key_line(Canvas& canvas, const Area& line, const std::vector<KeyHelp>& keys, bool typing) {
  canvas.fill(line, U' ', Tone::faint);
  int column = 0;
  const std::string more = typing ? "F1 help " : "? help ";  // the last cell of a terminal stays empty
  for (const KeyHelp& key : keys) {
    const std::string text = key.keys + " " + key.does;
    if (column + width_of(text) + 2 > line.columns - width_of(more)) break;
    column += canvas.text(line, 0, column, key.keys, Tone::strong);
    column += canvas.text(line, 0, column, " " + key.does, Tone::faint) + 2;
  }
  canvas.text_right(line, 0, more, Tone::strong);
}

/// The way here at the left, its end first where it is too long; the unit at the right.
void draw_header(Canvas& canvas, const std::string& path, const Standing& standing, bool unsaved) {
  const Area header = canvas.whole().top(1);
  canvas.fill(header, U' ', Tone::selected);
  std::string right = standing.link.empty() ? "" : standing.link + " " + standing.state;
  if (unsaved) right = right.empty() ? "NOT SAVED" : "NOT SAVED  " + right;
  const int room = header.columns - width_of(right) - 4;
  std::string left = path;
  for (std::size_t cut = left.find(" > "); width_of(left) > room && cut != std::string::npos; cut = left.find(" > "))
    left.erase(0, cut + 3);
  canvas.text({header.row, header.column, 1, std::max(0, room + 2)}, 0, 1, left, Tone::selected);
  canvas.text_right({header.row, header.column, 1, header.columns - 1}, 0, right,
                    standing.bad ? Tone::bad : Tone::selected);
}

std::vector<std::string> help_lines(const Screen& screen, int columns) {
  std::vector<std::string> lines = wrapped(screen.help(), std::max(20, columns - 8));
  lines.emplace_back();
  for (const KeyHelp& key : screen.keys()) lines.push_back(fmt::format("{:<14} {}", key.keys, key.does));
  lines.push_back(fmt::format("{:<14} {}", "Esc", "back; on the first screen: leave"));
  lines.push_back(fmt::format("{:<14} {}", "Ctrl-L, Ctrl-C", "draw everything anew; leave the program"));
  return lines;
}

int help_rows(const Canvas& canvas) { return std::max(1, canvas.rows() - 4); }

/// The lines of the help from `first` on, as many as fit.
void draw_help(Canvas& canvas, const Screen& screen, int first) {
  const auto lines = help_lines(screen, canvas.columns());
  const int left = static_cast<int>(lines.size()) - first;
  const int rows = std::min(left, help_rows(canvas));
  const Area box{(canvas.rows() - rows - 2) / 2, 2, rows + 2, canvas.columns() - 4};
  canvas.fill(box);
  canvas.frame(box,
               screen.title() + (left > rows ? ": help, any key shows more, Esc goes on" : ": help, any key goes on"),
               Tone::plain);
  for (int r = 0; r < rows; ++r) canvas.text(box.inside(), r, 1, lines[static_cast<std::size_t>(first + r)]);
}

void draw_leaving(Canvas& canvas, const std::string& unsaved) {
  draw_question(
      canvas, canvas.whole(),
      {"Leave the program?",
       unsaved + (drafts_fail() && !unsaved.empty() ? " IT WOULD BE LOST: no draft can be written, see LOG." : ""),
       "leave", "stay"});
  const Area line{canvas.rows() - 1, 0, 1, canvas.columns()};
  canvas.fill(line);
  canvas.text(line, 0, 0, "y leave  n stay", Tone::strong);
}

/// The screens one behind the other.
class Stack {
 public:
  explicit Stack(std::unique_ptr<Screen> first) { screens_.push_back(std::move(first)); }
  [[nodiscard]] bool empty() const { return screens_.empty(); }
  [[nodiscard]] bool is_last() const { return screens_.size() == 1; }
  [[nodiscard]] Screen& front() { return *screens_.back(); }
  [[nodiscard]] std::string path() const {
    std::string path;
    for (const auto& screen : screens_) path += (path.empty() ? "" : " > ") + screen->title();
    return path;
  }
  void take(Step step) {
    if (step.kind == Step::Kind::open && step.next) screens_.push_back(std::move(step.next));
    if (step.kind == Step::Kind::back) screens_.pop_back();
    if (step.kind == Step::Kind::leave) screens_.clear();
  }
  [[nodiscard]] std::string unsaved() const {
    for (const auto& screen : screens_)
      if (std::string work = screen->unsaved(); !work.empty()) return work;
    return {};
  }

 private:
  std::vector<std::unique_ptr<Screen>> screens_;
};

}  // namespace

Area screen_area(const Canvas& canvas) { return {1, 0, std::max(0, canvas.rows() - 2), canvas.columns()}; }

Canvas picture_of(const Screen& screen, const std::string& path, const Standing& standing, Canvas canvas,
                  bool with_help) {
  draw_header(canvas, path, standing, !screen.unsaved().empty());
  screen.draw(canvas, screen_area(canvas));
  draw_key_line(canvas, {canvas.rows() - 1, 0, 1, canvas.columns()}, screen.keys(), screen.typing());
  if (with_help) draw_help(canvas, screen, 0);
  return canvas;
}

int run_screens(Terminal& terminal, std::unique_ptr<Screen> first, const StandingNow& standing_now) {
  catch_signals();
  Stack stack(std::move(first));
  Standing standing;
  std::optional<int> help;  ///< the first line of it that is shown
  bool changed = true;      ///< since the last picture
  bool urgent = true;       ///< by a key
  bool sure = false;        ///< asked once about unsaved work
  while (!stack.empty() && interrupting_signal() == 0) {
    Screen& screen = stack.front();
    changed = screen.advance() || changed;
    if (auto next = screen.opens_by_itself()) {
      stack.take(opened(std::move(next)));
      changed = urgent = true;
      continue;
    }
    if (Standing now = standing_now(); now != standing) {
      standing = std::move(now);
      changed = true;
    }
    if (changed) {
      Canvas canvas = picture_of(screen, stack.path(), standing, terminal.canvas(), false);
      if (help) draw_help(canvas, screen, *help);
      if (sure) draw_leaving(canvas, stack.unsaved());
      changed = !terminal.show(canvas, help || sure ? Place{-1, -1} : screen.cursor(screen_area(canvas)), urgent);
    }
    const Key key = terminal.read(kWait_ms);
    urgent = key.name != Key::Name::none;
    changed = changed || urgent;
    if (!urgent) {
      continue;
    } else if (sure) {
      const Reply reply = reply_to(key);
      if (reply == Reply::yes) return 0;
      sure = reply == Reply::none;
    } else if (help) {
      const int next = *help + help_rows(terminal.canvas());
      const bool more = next < static_cast<int>(help_lines(screen, terminal.canvas().columns()).size());
      if (key.name != Key::Name::resized)
        help = more && key.name != Key::Name::escape ? std::optional(next) : std::nullopt;
    } else if (key.name == Key::Name::control && key.letter == U'l') {
      terminal.redraw();
    } else if (key.name == Key::Name::control && key.letter == U'c') {
      if (stack.unsaved().empty()) return 0;
      sure = true;
    } else if ((is_letter(key, U'?') && !screen.typing()) || (key.name == Key::Name::function && key.number == 1)) {
      help = 0;
    } else {
      Step step = screen.on_key(key);
      if (step.kind == Step::Kind::back && stack.is_last())
        sure = true;
      else
        stack.take(std::move(step));
    }
  }
  const int signal = interrupting_signal();
  return signal == 0 ? 0 : 128 + signal;
}

}  // namespace ecs::app
