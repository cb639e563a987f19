#include "app/ui/screen_program.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include <fmt/format.h>

#include "app/ui/cells.hpp"
#include "base/process.hpp"
#include "base/text.hpp"
#include "commissioning/session/message.hpp"
#include "commissioning/session/remembered.hpp"

namespace ecs::app {
namespace {

/// A word with its other forms in `forms`, parted by '|'.
struct GlossaryRow {
  const char* forms;
  const char* meaning;
};

constexpr GlossaryRow kGlossary[] = {
    {"alias", "another period of a periodic error that the same targets cannot distinguish from the one found"},
    {"approach", "the direction in which the axis last moved: forward (to larger coordinates) or reverse"},
    {"armed|arm code",
     "the unit accepts writes and commands from this host, because somebody has entered the arming code shown on the "
     "unit"},
    {"by chance",
     "how often noise alone would look as convincing: share of simulated noise-only data sets in which some effect "
     "explains as much as the named effect explains in the measured data"},
    {"candidate|candidates", "an effect that was tried on the residual"},
    {"commit",
     "the step that makes a completely sent map active; until then the old map stays active; the unit numbers its "
     "commits"},
    {"compensation mode|compensating|compensation",
     "the unit adds the compensation to the velocity command; it refuses parameters and maps"},
    {"credible set", "the smallest set of effects that contains the cause with a probability of 99 %"},
    {"datum|datuming", "reference point of an axis: found by switch and marker while the control references it"},
    {"deadband", "travel in the new direction after which the approach is regarded as changed"},
    {"dead path",
     "laser path from interferometer to reflector when the reading is set to zero; changes of the air in it are not "
     "corrected"},
    {"diagnosis|diagnose", "the search for effects that the model lacks, with evidence"},
    {"e-value",
     "how many times more probable the held-out readings are with the effect than without it, divided by the number of "
     "candidates tried; noise alone reaches 100 at most once in 100 cases; not valid where the zero of the readings "
     "drifts slowly"},
    {"held out|held-out", "readings that were not used for the fit and therefore test it"},
    {"integration mode|integration|integrating", "the unit accepts parameters, maps and commands; compensation is off"},
    {"lack of fit", "the means deviate from the model by more than the scatter of repeated readings allows (F test)"},
    {"likely",
     "not proved, but unlikely to be due to chance: in at most 1 of 100 simulated noise-only data sets, some effect "
     "fits as well as this one fits the readings. Held-out readings do not contradict it. The proved and likely "
     "effects together must reduce the residual to noise. Otherwise the likely ones must at least halve the part above "
     "noise (mean square of the residual minus that of the noise) that the proved ones leave. Another cause remains "
     "possible"},
    {"machine file",
     "description of the machine that is given with --machine: axes, travels, pitches, measurement lines (from which "
     "lever arms are measured), inputs of the unit"},
    {"marker",
     "the index pulse of the transducer, once per revolution or at one place on a scale; together with the switch it "
     "defines the datum"},
    {"parked",
     "at rest at this position while another axis moves; the distance from the measurement line of the moving axis is "
     "the lever arm of its angular errors"},
    {"pitch", "travel per turn of a screw (lead), or distance between the lines of a scale: errors repeat with it"},
    {"proved",
     "shown by held-out readings with an e-value of at least 100 or, where these give no e-value, by comparison with "
     "simulated noise-only data sets"},
    {"referenced", "the axis has found its datum since power-up: its positions are true machine coordinates"},
    {"relay", "connects the unit's output to the drive's velocity command; open: the unit cannot act on the machine"},
    {"residual", "reading minus model: the part that the model does not explain"},
    {"reversal error|reversal",
     "difference between the two approaches at the same target; lost motion (backlash) is the usual cause"},
    {"rms", "root mean square: an average size, for example of the residual"},
    {"rival|rivals", "an effect that these data cannot distinguish from the one named"},
    {"scope",
     "the errors that the unit compensates: linear (only the positioning error of each axis), planar (all errors in "
     "one plane) or volumetric (all errors of three axes)"},
    {"sense", "which error is measured, not the direction of travel: EX, EY, EZ translations; EA, EB, EC rotations"},
    {"sigma", "standard deviation of the number that it belongs to, for example of one reading or of a fitted value"},
    {"slope", "the part of a curve that is proportional to the position, in um/m"},
    {"squareness", "deviation of the angle between two axes from 90 degrees, one number per pair of axes, in um/m"},
    {"staging", "writing a new map into the inactive bank of the unit's memory; the old one stays active"},
    {"tie|tied", "a group of rivals: they fit these data equally well, and a further measurement decides"},
};

bool is_letter_of_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

bool occurs(const std::string& text, std::string_view word) {
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    if ((at == 0 || !is_letter_of_word(text[at - 1])) && (end == text.size() || !is_letter_of_word(text[end])))
      return true;
  }
  return false;
}

}  // namespace

std::vector<ExplainedWord> explained_words() {
  std::vector<ExplainedWord> all;
  for (const GlossaryRow& row : kGlossary) all.push_back({std::string(split(row.forms, '|').front()), row.meaning});
  return all;
}

std::vector<ExplainedWord> words_explained_in(const std::string& text) {
  const std::string seen = lower(text);
  std::vector<ExplainedWord> found;
  for (const GlossaryRow& row : kGlossary) {
    const auto forms = split(row.forms, '|');
    for (const std::string_view form : forms)
      if (occurs(seen, form)) {
        found.push_back({std::string(forms.front()), row.meaning});
        break;
      }
  }
  return found;
}

namespace {

/// What keys are for, as help groups them, by the key itself or by the first word of what it does.
struct KeyPurpose {
  std::string_view name, words;
};
constexpr std::array<KeyPurpose, 4> kPurposes{
    {{"actions", ""},
     {"editing", "add declare default delete edit new redo remove set undo use"},
     {"files, unit", "another arm compensate load map measured open picture read receive save send store write"},
     {"moving", "choose cursor field find go line page scroll step"}}};
constexpr std::size_t kActions = 0, kMoving = 3;
/// Fewer are found at a glance.
constexpr std::size_t kGroupedFrom = 8;

std::size_t purpose_of(const KeyHelp& key) {
  constexpr std::array<std::string_view, 6> kMovingKeys{"up/down", "left/right", "Tab", "Shift-Tab", "/", "1-9"};
  const std::string_view name = std::string_view(key.keys).substr(0, key.keys.find(' '));
  if (std::find(kMovingKeys.begin(), kMovingKeys.end(), name) != kMovingKeys.end()) return kMoving;
  const std::string_view first = std::string_view(key.does).substr(0, key.does.find_first_of(" ,"));
  for (std::size_t i = kActions + 1; i < kPurposes.size(); ++i)
    for (const std::string_view word : split(kPurposes[i].words, ' '))
      if (word == first) return i;
  return kActions;
}

}  // namespace

void Overlay::add_keys(const std::vector<KeyHelp>& keys) {
  if (keys.size() < kGroupedFrom) {
    for (const KeyHelp& key : keys) parts_.push_back({key.keys, key.does});
    return;
  }
  for (std::size_t i = 0; i < kPurposes.size(); ++i) {
    std::string text;
    for (const KeyHelp& key : keys)
      if (purpose_of(key) == i) text += fmt::format("{}{}: {}", text.empty() ? "" : "; ", key.keys, key.does);
    if (!text.empty()) parts_.push_back({std::string(kPurposes[i].name), text});
  }
  parts_.push_back({"", ""});
}

void Overlay::show_help(const Screen& screen, const std::string& seen) {
  *this = {};
  title_ = screen.title() + ": help";
  parts_ = {{"", screen.help()}, {"", ""}};
  const std::vector<KeyHelp> keys = screen.keys();
  add_keys(keys);
  if (std::none_of(keys.begin(), keys.end(), [](const KeyHelp& key) { return key.keys == "Esc"; }))
    parts_.push_back({"Esc", "back; on the first screen: leave"});
  parts_.push_back({"F2", "shows in full a text that was cut off (... F2)"});
  parts_.push_back({"F3", "finds any screen or command by its name, also from here"});
  parts_.push_back({"F4", "copies the row or screen to the clipboard, if possible"});
  parts_.push_back({"F6", "COMMANDS: the actions as commands; saves a script"});
  parts_.push_back({"Ctrl-L, Ctrl-C", "redraw everything; leave the program"});
  const std::vector<ExplainedWord> words = words_explained_in(seen + " " + screen.help());
  if (!words.empty()) parts_.push_back({"", ""});
  for (const ExplainedWord& word : words) parts_.push_back({word.word + ":", word.meaning});
}

void Overlay::show_whole(const std::vector<std::string>& texts) {
  if (texts.empty()) return;
  *this = {};
  title_ = "full text (also in MESSAGES)";
  const auto known = logged();
  for (const std::string& text : texts) {
    if (!parts_.empty()) parts_.push_back({});
    parts_.push_back({"", text});
    if (std::none_of(known.begin(), known.end(), [&](const LogEntry& entry) { return entry.text == text; }))
      log_event(Tone::plain, text);
  }
}

std::vector<std::string> Overlay::lines(int columns) const {
  std::vector<std::string> lines;
  const int keys = columns >= 50 ? 15 : 9;
  for (const Part& part : parts_) {
    const int begin = part.key.empty() ? 0 : std::max(keys, width_of(part.key) + 1);
    bool first = true;
    for (const std::string& line : wrapped(part.text, columns - begin)) {
      lines.push_back(in_columns(first ? part.key : "", begin) + line);
      first = false;
    }
  }
  return lines;
}

void Overlay::draw(Canvas& canvas) const {
  const auto all = lines(canvas.columns() - 8);
  const int count = static_cast<int>(all.size());
  page_ = std::max(1, std::min(count, canvas.rows() - 4));
  const Area box{(canvas.rows() - page_ - 2) / 2, 2, page_ + 2, canvas.columns() - 4};
  canvas.fill(box);
  const std::string ways = count > page_ ? "up, down; Esc continues" : "any key continues";
  const std::string whole = title_ + "; " + ways;
  canvas.frame(box, width_of(whole) + 5 > box.columns ? ways : whole, Tone::plain);
  const Area inside = box.inside();
  draw_scrolled(canvas, {inside.row, inside.column + 1, inside.rows, inside.columns - 1}, all, scroll_);
  fits_ = count <= page_;
  end_ = scroll_.first + page_ >= count;
}

void Overlay::on_key(const Key& key) {
  if (key.name == Key::Name::resized) return;
  if (!fits_ && scroll_.on_key(key, page_)) return;
  if (!end_ && is_letter(key, U' '))
    scroll_.first += page_;
  else
    *this = {};
}

namespace {

std::string row_text(const Canvas& canvas, const Area& area, int row) {
  std::u32string letters;
  for (int column = area.column; column < area.column + area.columns; ++column)
    if (const char32_t glyph = canvas.at(row, column).glyph; glyph != kSecondHalf) letters += glyph;
  return std::string(trimmed(utf8_of(letters)));
}

bool is_selected(const Canvas& canvas, const Area& area, int row) {
  for (int column = area.column; column < area.column + area.columns; ++column)
    if (const Cell& cell = canvas.at(row, column); cell.tone == Tone::selected && cell.glyph != U' ') return true;
  return false;
}

}  // namespace

std::string text_to_copy(const Canvas& canvas, const Area& area) {
  std::string selected, all;
  for (int row = area.row; row < area.row + area.rows; ++row) {
    const std::string line = row_text(canvas, area, row);
    if (!all.empty() || !line.empty()) all += line + "\n";
    if (is_selected(canvas, area, row)) selected += (selected.empty() ? "" : "\n") + line;
  }
  while (all.ends_with("\n")) all.pop_back();
  return selected.empty() ? all : selected;
}

std::string copied_words(const std::string& text) {
  const auto rows = std::count(text.begin(), text.end(), '\n') + 1;
  return rows > 1 ? fmt::format("copied: {} rows of this screen", rows) : "copied: " + text;
}

std::string idle_key_words(const Screen& screen, char32_t letter) {
  const std::string key = letter == U' ' ? "Space" : utf8_of(std::u32string(1, letter));
  for (const KeyHelp& help : screen.keys())
    for (const std::string_view name : split(help.keys, ' '))
      if (name == key || (name == "1-9" && letter >= U'1' && letter <= U'9'))
        return fmt::format("{} ({}): no change. It is already shown, at its limit, or still being computed", key,
                           help.does);
  return fmt::format("{} has no function here; {} lists the keys", key, screen.typing() ? "F1" : "?");
}

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
       unsaved + (drafts_fail() && !unsaved.empty() ? " IT WILL BE LOST: no draft can be written, see MESSAGES." : ""),
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
      over.show_help(screen, picture_of(screen, "", status, terminal.canvas(), false).plain_text());
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
      said = terminal.copy(text) ? copied_words(text) : "this terminal accepts no copies, or not as much";
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
