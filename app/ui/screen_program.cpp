#include "app/ui/screen_program.hpp"

#include <algorithm>
#include <vector>

#include "app/ui/copying.hpp"
#include "app/ui/key_line.hpp"
#include "app/ui/overlay.hpp"
#include "app/ui/talk.hpp"
#include "base/interrupt.hpp"
#include "commissioning/session/drafts.hpp"

namespace ecs::app {
namespace {

constexpr int kWait_ms = 40;  ///< between two looks at running work

Area key_area(const Canvas& canvas) { return {canvas.rows() - 1, 0, 1, canvas.columns()}; }

/// @param partly  the picture shows a text in part only
KeyLine key_line_of(const Screen& screen, bool partly) {
  KeyLine line{screen.keys(), {{screen.typing() ? "F1" : "?", "help"}}};
  if (partly) line.ends.insert(line.ends.begin(), {"F2", "more"});
  return line;
}

/// A long link without its middle: how it begins says what it is, how it ends which port and speed.
std::string short_link(const std::string& link, int room) {
  const std::u32string letters = code_points(link);
  const auto count = static_cast<std::size_t>(std::max(3, room));
  if (letters.size() <= count) return link;
  const std::size_t end = (count - 1) / 2, begin = count - 1 - end;
  return utf8_of(std::u32string_view(letters).substr(0, begin)) + "…" +
         utf8_of(std::u32string_view(letters).substr(letters.size() - end));
}

/// The way here at the left, its end first where it is too long; the unit at the right, its state before all.
void draw_header(Canvas& canvas, const std::string& path, const StatusLine& status, bool unsaved) {
  const Area header = canvas.whole().top(1);
  canvas.fill(header, U' ', Tone::selected);
  const std::string saved = unsaved ? "NOT SAVED" : "";
  const int link_room = std::max(8, header.columns / 2 - width_of(status.state) - width_of(saved));
  std::string right = status.link.empty() ? "" : short_link(status.link, link_room) + " " + status.state;
  if (unsaved) right = right.empty() ? saved : saved + "  " + right;
  if (width_of(right) >= header.columns) canvas.keep_whole(right);
  const int room = header.columns - width_of(right) - 4;
  std::string left = path;
  for (std::size_t cut = left.find(" > "); width_of(left) > room && cut != std::string::npos; cut = left.find(" > "))
    left.erase(0, cut + 3);
  canvas.text({header.row, header.column, 1, std::max(0, room + 2)}, 0, 1, left, Tone::selected);
  canvas.text_right({header.row, header.column, 1, header.columns - 1}, 0, right,
                    status.bad ? Tone::bad : Tone::selected);
}

const std::vector<KeyHelp> kLeavingKeys{{"y", "leave"}, {"n", "stay"}};

/// Enter does what loses nothing: it leaves, or stays where work is not saved.
Reply reply_to_leaving(const Key& key, bool all_saved) {
  if (key.name == Key::Name::enter) return all_saved ? Reply::yes : Reply::no;
  return reply_to(key);
}

void draw_leaving(Canvas& canvas, const std::string& unsaved) {
  draw_question(
      canvas, canvas.whole(),
      {"Leave the program?",
       unsaved + (drafts_fail() && !unsaved.empty() ? " IT WOULD BE LOST: no draft can be written, see LOG." : ""),
       unsaved.empty() ? "or Enter: leave" : "leave", unsaved.empty() ? "stay" : "or Enter: stay"});
  draw_key_line(canvas, key_area(canvas), {kLeavingKeys, {}});
}

void draw_said(Canvas& canvas, const std::string& words) {
  const Area line = key_area(canvas);
  canvas.fill(line);
  canvas.text(line, 0, 1, words, Tone::warning);
}

/// Letters and tones: a key that only moves a cursor does something.
std::string seen_of(const Screen& screen, const Terminal& terminal) {
  const Canvas canvas = picture_of(screen, "", {}, terminal.canvas(), false);
  std::string seen = canvas.plain_text();
  for (int row = 0; row < canvas.rows(); ++row)
    for (int column = 0; column < canvas.columns(); ++column)
      seen += static_cast<char>('0' + static_cast<int>(canvas.at(row, column).tone));
  return seen;
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
    if (step.kind == Step::Kind::instead && step.next) screens_.back() = std::move(step.next);
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

Canvas picture_of(const Screen& screen, const std::string& path, const StatusLine& status, Canvas canvas,
                  bool with_help) {
  draw_header(canvas, path, status, !screen.unsaved().empty());
  screen.draw(canvas, screen_area(canvas));
  draw_key_line(canvas, key_area(canvas), key_line_of(screen, !canvas.whole_texts().empty()));
  if (with_help) {
    Overlay help;
    help.show_help(screen, canvas.plain_text());
    help.draw(canvas);
  }
  return canvas;
}

int run_screens(Terminal& terminal, std::unique_ptr<Screen> first, const ProgramHooks& hooks) {
  catch_signals();
  Stack stack(std::move(first));
  StatusLine status;
  Overlay over;
  std::vector<std::string> partly;  ///< seen in part only in the last picture
  bool changed = true;              ///< since the last picture
  bool urgent = true;               ///< by a key
  bool sure = false;                ///< asked once about unsaved work
  std::string said;                 ///< in place of the key line, until the next key
  while (!stack.empty() && interrupting_signal() == 0) {
    Screen& screen = stack.front();
    changed = screen.advance() || changed;
    auto next = screen.opens_by_itself();
    if (!next && hooks.in_front) next = hooks.in_front();
    if (next) {
      stack.take(opened(std::move(next)));
      changed = urgent = true;
      continue;
    }
    if (StatusLine now = hooks.status_line(); now != status) {
      status = std::move(now);
      changed = true;
    }
    if (changed) {
      Canvas canvas = picture_of(screen, stack.path(), status, terminal.canvas(), false);
      partly = canvas.whole_texts();
      if (over.shown()) over.draw(canvas);
      if (sure) draw_leaving(canvas, stack.unsaved());
      if (!said.empty()) draw_said(canvas, said);
      changed = !terminal.show(canvas, over.shown() || sure ? CellPosition{-1, -1} : screen.cursor(screen_area(canvas)),
                               urgent);
    }
    Key key = terminal.read(kWait_ms);
    if (const Area line = key_area(terminal.canvas()); key.name == Key::Name::mouse && key.row == line.row)
      key = clicked_key(line, sure ? KeyLine{kLeavingKeys, {}} : key_line_of(screen, !partly.empty()), key.column)
                .value_or(Key{});
    urgent = key.name != Key::Name::none;
    changed = changed || urgent;
    if (!urgent) continue;
    said.clear();
    if (sure) {
      const Reply reply = reply_to_leaving(key, stack.unsaved().empty());
      if (reply == Reply::yes) return 0;
      sure = reply == Reply::none;
    } else if (over.shown()) {
      over.on_key(key);
    } else if (key.name == Key::Name::control && key.letter == U'l') {
      terminal.redraw();
    } else if (key.name == Key::Name::control && key.letter == U'c') {
      if (stack.unsaved().empty()) return 0;
      sure = true;
    } else if ((is_letter(key, U'?') && !screen.typing()) || (key.name == Key::Name::function && key.number == 1)) {
      over.show_help(screen, picture_of(screen, "", {}, terminal.canvas(), false).plain_text());
    } else if (key.name == Key::Name::function && key.number == 3 && hooks.finder) {
      stack.take(opened(hooks.finder()));
    } else if (key.name == Key::Name::function && key.number == 6 && hooks.commands) {
      auto panel = hooks.commands();
      stack.take(panel->title() == screen.title() ? back() : opened(std::move(panel)));
    } else if (key.name == Key::Name::function && key.number == 2 && !partly.empty()) {
      over.show_whole(partly);
    } else if (key.name == Key::Name::function && key.number == 4) {
      const Canvas canvas = picture_of(screen, "", {}, terminal.canvas(), false);
      std::string text = screen.copied();
      if (text.empty()) text = text_to_copy(canvas, screen_area(canvas));
      said = terminal.copy(text) ? copied_words(text) : "this terminal takes no copies, or not as much";
    } else {
      const bool command = key.name == Key::Name::letter && !screen.typing();
      const std::string before = command ? seen_of(screen, terminal) : std::string();
      Step step = screen.on_key(key);
      if (command && step.kind == Step::Kind::stay && seen_of(screen, terminal) == before)
        said = idle_key_words(screen, key.letter);
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
