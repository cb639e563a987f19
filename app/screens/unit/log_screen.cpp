// LOG: what the screens said, newest last, with the whole text of one below.
#include <algorithm>
#include <ctime>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "app/screens/unit/screens.hpp"
#include "app/ui/screen.hpp"
#include "app/ui/talk.hpp"
#include "app/ui/widgets.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "commissioning/session/event_log.hpp"

namespace ecs::app {
namespace {

const char* kind_of(Tone tone) {
  if (tone == Tone::bad) return "ERROR  ";
  return tone == Tone::warning ? "warning" : "       ";
}

std::string row_of(const LogEntry& entry) {
  std::string text = entry.text;
  std::replace(text.begin(), text.end(), '\n', ' ');
  return fmt::format("{} {} {}", entry.time, kind_of(entry.tone), text);
}

std::string copy_name() { return fmt::format("ecs-log-{:%Y%m%d-%H%M%S}.txt", fmt::localtime(std::time(nullptr))); }

class LogScreen final : public Screen {
 public:
  LogScreen() : entries_(logged()), file_(log_file()) { follow(); }

  [[nodiscard]] std::string title() const override { return "LOG"; }
  void draw(Canvas& canvas, const Area& area) const override {
    if (area.rows < 4 || area.columns < 10) return;
    const Area text = area.between_margins();
    const auto rows = shown();
    canvas.text(text, 0, 0,
                fmt::format("{} message{}{}{}", rows.size(), rows.size() == 1 ? "" : "s",
                            only_errors_ ? ", errors only" : "", following_ ? ", following" : ""),
                Tone::strong);
    canvas.text(text, 1, 0,
                file_.empty() ? std::string("no file: the state folder cannot be written")
                              : fmt::format("file {}", file_.string()),
                Tone::faint);
    const int whole = std::clamp(area.rows / 4, 1, 8);
    const Area list{area.row + 2, area.column, std::max(1, area.rows - 4 - whole), area.columns};
    if (rows.empty()) {
      canvas.text(text, 2, 0,
                  only_errors_ ? "no error since the start; e shows all messages"
                               : "No messages yet. Messages and errors of the screens are kept here.");
    } else {
      std::vector<ListRow> lines;
      for (const LogEntry* entry : rows)
        lines.push_back({row_of(*entry), entry->tone == Tone::good ? Tone::plain : entry->tone});
      draw_list(canvas, list, lines, place_);
      const LogEntry& entry =
          *rows[static_cast<std::size_t>(std::clamp(place_.selected, 0, static_cast<int>(rows.size()) - 1))];
      const Area below{area.row + area.rows - 2 - whole, area.column + 1, whole, area.columns - 2};
      canvas.paragraph(below, 0, entry.text, Tone::strong);
    }
    draw_bottom(canvas, {area.row + area.rows - 1, area.column + 1, 1, area.columns - 2});
    draw_question(canvas, area, asking_);
  }

  [[nodiscard]] Step on_key(const Key& key) override {
    if (answers(asking_, key)) return stay();
    if (typing()) {
      on_typing_key(key);
      return stay();
    }
    if (key.name == Key::Name::escape || is_letter(key, U'q')) return back();
    if (key.name == Key::Name::resized) return stay();
    said_.clear();
    const auto count = static_cast<int>(shown().size());
    if (key.name == Key::Name::mouse) {
      if (const auto clicked = place_.clicked(key); clicked && *clicked < count) place_.selected = *clicked;
      following_ = place_.selected >= count - 1;
    } else if (place_.on_key(key, count)) {
      following_ = place_.selected >= count - 1;
    } else if (is_letter(key, U'e')) {
      only_errors_ = !only_errors_;
      following_ = true;
      follow();
    } else if (is_letter(key, U'/')) {
      typing_ = Typing::sought;
      text_.set("");
    } else if (is_letter(key, U'n')) {
      seek(1);
    } else if (is_letter(key, U'p')) {
      seek(-1);
    } else if (is_letter(key, U's')) {
      typing_ = Typing::file;
      text_.set(copy_name());
    }
    return stay();
  }

  [[nodiscard]] std::vector<KeyHelp> keys() const override {
    if (typing()) return {{"Enter", "done"}, {"Esc", "leave it"}};
    return {{"e", only_errors_ ? "all messages" : "errors only"},
            {"/", "find"},
            {"n p", "next, previous"},
            {"s", "save a copy"},
            {"End", "follow"}};
  }

  [[nodiscard]] std::string help() const override {
    return "The messages of the screens since the program began, newest last; the whole text of the marked message is "
           "below the list. All of it is in the file named above, with date and time, for copying and sending; s "
           "writes a copy where you say. To copy with the mouse hold Shift while selecting, as the screens use the "
           "mouse themselves.";
  }

  [[nodiscard]] bool advance() override {
    auto now = logged();
    const bool same =
        now.size() == entries_.size() &&
        (now.empty() || (now.back().time == entries_.back().time && now.back().text == entries_.back().text));
    if (same) return false;
    entries_ = std::move(now);
    follow();
    return true;
  }

  [[nodiscard]] bool typing() const override { return typing_ != Typing::nothing; }
  [[nodiscard]] CellPosition cursor(const Area& area) const override {
    if (!typing()) return {-1, -1};
    const int begin = width_of(prompt());
    return {area.row + area.rows - 1,
            area.column + 1 + begin + text_.cursor_column(std::max(1, area.columns - 2 - begin))};
  }

 private:
  enum class Typing { nothing, sought, file };
  [[nodiscard]] std::vector<const LogEntry*> shown() const {
    std::vector<const LogEntry*> rows;
    for (const LogEntry& entry : entries_)
      if (!only_errors_ || entry.tone == Tone::bad) rows.push_back(&entry);
    return rows;
  }

  void follow() {
    if (following_) place_.selected = std::max(0, static_cast<int>(shown().size()) - 1);
  }

  void seek(int by) {
    const auto rows = shown();
    const auto count = static_cast<int>(rows.size());
    const std::string part = lower(sought_);
    bad_ = true;
    said_ = sought_.empty() ? "nothing was sought yet: / begins" : fmt::format("\"{}\" is in no message", sought_);
    if (sought_.empty()) return;
    for (int k = 1; k <= count; ++k) {
      const int at = ((place_.selected + by * k) % count + count) % count;
      if (lower(rows[static_cast<std::size_t>(at)]->text).find(part) == std::string::npos) continue;
      place_.selected = at;
      following_ = at == count - 1;
      said_.clear();
      return;
    }
  }

  void save(const std::string& path) {
    std::string text;
    for (const LogEntry& entry : entries_)
      text += fmt::format("{} {} {}\n", entry.time, kind_of(entry.tone), entry.text);
    const auto written = write_file(path, text);
    bad_ = !written;
    said_ = written ? fmt::format("{} messages written to {}", entries_.size(), path) : to_text(written.error());
  }

  void on_typing_key(const Key& key) {
    if (key.name == Key::Name::escape) {
      typing_ = Typing::nothing;
    } else if (key.name == Key::Name::enter) {
      const Typing what = typing_;
      typing_ = Typing::nothing;
      const std::string typed(trimmed(text_.text()));
      std::error_code error;
      if (what == Typing::sought) {
        sought_ = typed;
        seek(-1);
      } else if (typed.empty()) {
        bad_ = true;
        said_ = "expected a file name, got none";
      } else if (std::filesystem::exists(typed, error)) {
        asking_.ask(
            {fmt::format("Replace {}?", typed), "The file exists: what is in it is lost.", "replace", "keep it"},
            [this, typed] { save(typed); });
      } else {
        save(typed);
      }
    } else {
      (void)text_.on_key(key);
    }
  }

  void draw_bottom(Canvas& canvas, const Area& area) const {
    if (typing()) {
      const int begin = canvas.text(area, 0, 0, prompt(), Tone::strong);
      text_.draw(canvas, area, 0, begin, std::max(1, area.columns - begin), true);
    } else {
      canvas.paragraph(area, 0, said_, bad_ ? Tone::bad : Tone::good);
    }
  }

  [[nodiscard]] std::string prompt() const { return typing_ == Typing::sought ? "find: " : "save a copy to: "; }

  std::vector<LogEntry> entries_;
  std::filesystem::path file_;
  bool only_errors_ = false;
  bool following_ = true;
  ListPlace place_;
  Typing typing_ = Typing::nothing;
  TextLine text_;
  std::string sought_;
  std::string said_;  ///< about the log itself; not logged
  bool bad_ = false;
  Asking asking_;
};

}  // namespace

std::unique_ptr<Screen> log_screen() { return std::make_unique<LogScreen>(); }

}  // namespace ecs::app
