// The lists that grow while the screens run, the newest row last and followed, the marked one whole below: LOG,
// COMMANDS, LOGBOOK.
#include <algorithm>
#include <ctime>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "app/screens/files/prompt.hpp"
#include "app/screens/unit/screens.hpp"
#include "app/ui/screen.hpp"
#include "app/ui/widgets.hpp"
#include "app/verbs/registry.hpp"
#include "base/file.hpp"
#include "base/outcome.hpp"
#include "base/text.hpp"
#include "commissioning/logbook/place.hpp"
#include "commissioning/logbook/recorder.hpp"
#include "commissioning/logbook/view.hpp"
#include "commissioning/session/commands.hpp"
#include "commissioning/session/message.hpp"
#include "commissioning/session/task_runner.hpp"

namespace ecs::app {
namespace {

std::string on_one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

/// What the three have in common; each says its rows and its keys.
class ListScreen : public Screen {
 public:
  void draw(Canvas& canvas, const Area& area) const final {
    if (area.rows < 4 || area.columns < 10) return;
    const Area inside = area.between_margins();
    if (!page_.empty()) return draw_scrolled(canvas, area, sentences_wrapped(page_, inside.columns), scroll_);
    const auto list = rows();
    canvas.text(inside, 0, 0, heading(), Tone::strong);
    canvas.text(inside, 1, 0, below_heading(), Tone::faint);
    const int below = shows_whole_below() ? std::clamp(area.rows / 4, 1, 8) : 0;
    if (list.empty())
      canvas.paragraph(inside, 2, while_empty());
    else
      draw_list(canvas, {area.row + 2, area.column, std::max(1, area.rows - 4 - below), area.columns}, list, place_);
    if (!list.empty() && below > 0)
      canvas.paragraph({area.row + area.rows - 2 - below, inside.column, below, inside.columns}, 0, whole(marked()),
                       Tone::strong);
    canvas.paragraph({area.row + area.rows - 1, inside.column, 1, inside.columns}, 0, said_, tone_);
    prompt_.draw(canvas, inside, inside.rows - 1);
    draw_question(canvas, area, asking_);
  }

  [[nodiscard]] Step on_key(const Key& key) final {
    if (answers(asking_, key) || prompt_.on_key(key) || key.name == Key::Name::resized) return stay();
    if (!page_.empty()) {
      if (key.name == Key::Name::escape)
        page_.clear();
      else
        (void)scroll_.on_key(key);
      return stay();
    }
    if (key.name == Key::Name::escape || is_letter(key, U'q')) return back();
    said_.clear();
    if (const auto clicked = key.name == Key::Name::mouse ? place_.clicked(key) : std::nullopt)
      place_.selected = std::min(*clicked, last());
    else if (!place_.on_key(key, count()) && act_on(keys_, key))
      return stay();
    following_ = place_.selected >= last();
    return stay();
  }

  [[nodiscard]] std::vector<KeyHelp> keys() const final {
    if (const auto& asked = asking_.question()) return {{"y", asked->yes}, {"n", asked->no}};
    if (prompt_.active()) return prompt_.keys();
    if (!page_.empty()) return {{"up/down", "scroll"}, {"Esc", "the list"}};
    std::vector<KeyHelp> keys = helps_of(keys_);
    keys.push_back({"Esc", "back"});
    return keys;
  }

  [[nodiscard]] bool typing() const final { return prompt_.active(); }
  [[nodiscard]] CellPosition cursor(const Area& area) const final {
    const Area inside = area.between_margins();
    return prompt_.cursor(inside, inside.rows - 1);
  }

 protected:
  [[nodiscard]] virtual std::vector<ListRow> rows() const = 0;
  [[nodiscard]] virtual std::string heading() const = 0;
  [[nodiscard]] virtual std::string below_heading() const = 0;
  [[nodiscard]] virtual std::string while_empty() const = 0;
  [[nodiscard]] virtual std::string whole(std::size_t row) const = 0;
  [[nodiscard]] virtual bool shows_whole_below() const { return true; }

  [[nodiscard]] int count() const { return static_cast<int>(rows().size()); }
  [[nodiscard]] int last() const { return std::max(0, count() - 1); }
  [[nodiscard]] std::size_t marked() const { return static_cast<std::size_t>(std::clamp(place_.selected, 0, last())); }
  void follow() {
    if (following_) place_.selected = last();
  }
  void say(std::string text, Tone tone) {
    said_ = std::move(text);
    tone_ = tone;
  }
  void show(const std::string& text) {
    page_ = owned_lines_of(text);
    scroll_ = {};
  }
  /// Asks for a file, and again before one is replaced. @param write  returns why not
  void save(const std::string& label, const std::string& proposed, const std::string& what,
            std::function<Result<void>(const std::string&)> write) {
    prompt_.ask(label, Prompt::Kind::path, proposed, [this, what, write](const std::string& typed) {
      const std::string path(trimmed(typed));
      const auto written = [this, what, write, path] {
        const auto done = write(path);
        say(done ? fmt::format("{} written to {}", what, path) : to_text(done.error()), done ? Tone::good : Tone::bad);
      };
      std::error_code error;
      if (!std::filesystem::exists(path, error)) return written();
      asking_.ask({fmt::format("Replace {}?", path), "The file exists: what is in it is lost.", "replace", "keep it"},
                  written);
    });
  }

  std::vector<KeyRow> keys_;
  ListPlace place_;
  bool following_ = true;
  Prompt prompt_;
  Asking asking_;
  std::string said_;  ///< about the list itself; not logged
  Tone tone_ = Tone::good;

 private:
  std::vector<std::string> page_;  ///< shown in place of the list; empty: the list
  ScrollPlace scroll_;
};

std::string name_now(const char* stem, const char* extension) {
  return fmt::format("{}-{:%Y%m%d-%H%M%S}.{}", stem, fmt::localtime(std::time(nullptr)), extension);
}

// --- LOG
const char* kind_of(Tone tone) {
  if (tone == Tone::bad) return "ERROR  ";
  return tone == Tone::warning ? "warning" : "       ";
}

class LogScreen final : public ListScreen {
 public:
  LogScreen() : entries_(logged()), file_(log_file()) {
    keys_ = {{"e", "errors only", [this] { show_errors(true); }, [this] { return !only_errors_; }},
             {"e", "all messages", [this] { show_errors(false); }, [this] { return only_errors_; }},
             {"/", "find",
              [this] {
                prompt_.ask("find:", Prompt::Kind::text, "", [this](const std::string& typed) {
                  sought_ = trimmed(typed);
                  seek(-1);
                });
              }},
             {"n p", "next, previous"},
             {"n", "", [this] { seek(1); }},
             {"p", "", [this] { seek(-1); }},
             {"s", "save a copy",
              [this] {
                save("save a copy to:", name_now("ecs-log", "txt"), fmt::format("{} messages", entries_.size()),
                     [this](const std::string& path) { return write_file(path, copy()); });
              }},
             {"End", "follow"}};
    follow();
  }

  [[nodiscard]] std::string title() const override { return "LOG"; }
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

 protected:
  [[nodiscard]] std::vector<ListRow> rows() const override {
    std::vector<ListRow> rows;
    for (const LogEntry* entry : shown())
      rows.push_back({fmt::format("{} {} {}", entry->time, kind_of(entry->tone), on_one_line(entry->text)),
                      entry->tone == Tone::good ? Tone::plain : entry->tone});
    return rows;
  }
  [[nodiscard]] std::string heading() const override {
    const std::size_t count = shown().size();
    return fmt::format("{} message{}{}{}", count, count == 1 ? "" : "s", only_errors_ ? ", errors only" : "",
                       following_ ? ", following" : "");
  }
  [[nodiscard]] std::string below_heading() const override {
    return file_.empty() ? "no file: the state folder cannot be written" : "file " + file_.string();
  }
  [[nodiscard]] std::string while_empty() const override {
    return only_errors_ ? "no error since the start; e shows all messages"
                        : "No messages yet. Messages and errors of the screens are kept here.";
  }
  [[nodiscard]] std::string whole(std::size_t row) const override { return shown()[row]->text; }

 private:
  [[nodiscard]] std::vector<const LogEntry*> shown() const {
    std::vector<const LogEntry*> entries;
    for (const LogEntry& entry : entries_)
      if (!only_errors_ || entry.tone == Tone::bad) entries.push_back(&entry);
    return entries;
  }

  [[nodiscard]] std::string copy() const {
    std::string text;
    for (const LogEntry& entry : entries_)
      text += fmt::format("{} {} {}\n", entry.time, kind_of(entry.tone), entry.text);
    return text;
  }

  void show_errors(bool alone) {
    only_errors_ = alone;
    following_ = true;
    follow();
  }

  void seek(int by) {
    if (sought_.empty()) return say("nothing was sought yet: / begins", Tone::bad);
    const auto entries = shown();
    const auto count = static_cast<int>(entries.size());
    const std::string part = lower(sought_);
    for (int k = 1; k <= count; ++k) {
      const int at = ((place_.selected + by * k) % count + count) % count;
      if (lower(entries[static_cast<std::size_t>(at)]->text).find(part) == std::string::npos) continue;
      place_.selected = at;
      following_ = at == count - 1;
      return;
    }
    say(fmt::format("\"{}\" is in no message", sought_), Tone::bad);
  }

  std::vector<LogEntry> entries_;
  std::filesystem::path file_;
  bool only_errors_ = false;
  std::string sought_;
};

// --- COMMANDS
/// Written whole, then made executable for those who may read it.
Result<void> write_script(const std::string& path, const std::vector<NotedCommand>& commands) {
  namespace fs = std::filesystem;
  ECS_DO(write_file(path, script_of(commands)));
  std::error_code error;
  fs::permissions(path, fs::perms::owner_exec | fs::perms::group_exec | fs::perms::others_exec, fs::perm_options::add,
                  error);
  return {};
}

class CommandsScreen final : public ListScreen {
 public:
  CommandsScreen() : commands_(noted_commands()) {
    const auto some = [this] { return !commands_.empty(); };
    keys_ = {{"w", "write a script",
              [this] {
                save("write the script to:", name_now("ecs", "sh"), fmt::format("{} actions", commands_.size()),
                     [this](const std::string& path) { return write_script(path, commands_); });
              },
              some},
             {"F4", "copy the command", {}, some},
             {"x", "begin anew",
              [this] {
                asking_.ask({"Begin anew?", "The actions so far leave this list; nothing else changes.", "begin anew",
                             "keep them"},
                            [this] {
                              forget_commands();
                              (void)advance();
                            });
              },
              some}};
    follow();
  }

  [[nodiscard]] std::string title() const override { return "COMMANDS"; }
  [[nodiscard]] std::string help() const override {
    return "Every action of the screens that changed a file or the unit, as the command of ecs that does the same; the "
           "marked one whole below the list. F4 copies it. w writes all of them as a shell script that ends with the "
           "first command that fails: for training, for the next machine, and as proof of what was done. Run in a "
           "folder with the same files it does the same again; LINK=... in front of it names another unit, "
           "WORKSHOP=... another emulated machine, ECS_ARM_CODE=... the code that the unit shows. Arming codes are "
           "never written. A line that begins with # is an action that no command does. x begins a new script.";
  }
  [[nodiscard]] bool advance() override {
    auto now = noted_commands();
    const bool grown = now.size() != commands_.size();
    commands_ = std::move(now);
    place_.selected = std::min(place_.selected, last());
    if (grown) follow();
    return grown;
  }
  [[nodiscard]] std::string copied() const override { return commands_.empty() ? std::string() : whole(marked()); }

 protected:
  [[nodiscard]] std::vector<ListRow> rows() const override {
    std::vector<ListRow> rows;
    for (const NotedCommand& command : commands_)
      rows.push_back({fmt::format("{} {}", command.time, on_one_line(command_text(command))),
                      command.words.empty() ? Tone::faint : Tone::plain});
    return rows;
  }
  [[nodiscard]] std::string heading() const override {
    return fmt::format("{} action{}, newest last", commands_.size(), commands_.size() == 1 ? "" : "s");
  }
  [[nodiscard]] std::string below_heading() const override { return {}; }
  [[nodiscard]] std::string while_empty() const override {
    return "Nothing was done yet. Whatever changes a file or the unit stands here as the command that does the same.";
  }
  [[nodiscard]] std::string whole(std::size_t row) const override { return command_text(commands_[row]); }

 private:
  std::vector<NotedCommand> commands_;
};

// --- LOGBOOK
std::filesystem::file_time_type time_of(const std::string& path) {
  std::error_code error;
  const auto time = std::filesystem::last_write_time(path, error);
  return error ? std::filesystem::file_time_type{} : time;
}

class LogbookScreen final : public ListScreen {
 public:
  LogbookScreen() {
    keys_ = {{"Enter", "the entry whole", [this] { show_entry(); }},
             {"v", "verify", [this] { run("checking every entry", "verify"); }},
             {"r", "replay", [this] { run("deriving the active map again", "replay"); }},
             {"Tab", "next logbook", [this] { open_next(); }}};
    look();
  }

  [[nodiscard]] std::string title() const override { return "LOGBOOK"; }
  [[nodiscard]] std::string help() const override {
    return "What verbs and screens did at a machine, written by themselves: measurements, maps, parameters, transfers, "
           "diagnoses, reports, each with its files and tied by its hash to the entry before. v checks every entry: a "
           "change is found and the first one named. r derives the active map again from the raw readings and compares "
           "it bit for bit. `ecs log` does the same, compares two years and writes a calibration certificate "
           "(docs/logbook.md). ECS_LOGBOOK=off keeps no logbook.";
  }
  [[nodiscard]] bool advance() override {
    const auto words = logbook_words();
    for (const LogbookWord& word : words) say(word.text, word.warning ? Tone::warning : Tone::good);
    if (task_.advance() || !words.empty()) return true;
    if (books_.empty() || task_.running() || time_of(book()) == seen_) return false;
    read();
    return true;
  }

 protected:
  [[nodiscard]] std::vector<ListRow> rows() const override {
    std::vector<ListRow> rows;
    for (const LogbookEntry& entry : entries_) {
      std::string time = entry.time.substr(0, 16);
      std::replace(time.begin(), time.end(), 'T', ' ');
      rows.push_back({fmt::format("{:>6} {:<16} {:<18} {}", entry.number, time, entry.kind, entry.summary)});
    }
    return rows;
  }
  [[nodiscard]] std::string heading() const override {
    if (entries_.empty()) return "logbook";
    return fmt::format("{}: {} entries{}", owner_, entries_.size(),
                       books_.size() > 1 ? fmt::format(" ({} logbooks, Tab shows the next)", books_.size()) : "");
  }
  [[nodiscard]] std::string below_heading() const override { return book(); }
  [[nodiscard]] std::string while_empty() const override { return absent_.empty() ? "It holds no entry." : absent_; }
  [[nodiscard]] std::string whole(std::size_t row) const override {
    const auto open = Logbook::open_to_read(book());
    const auto entry = open ? open->entry(entries_[row].number) : tl::unexpected(open.error());
    return entry ? whole_entry_cell(*entry).text : to_text(entry.error());
  }
  [[nodiscard]] bool shows_whole_below() const override { return false; }

 private:
  struct Ran {
    std::string text;
    int exit_code = 0;
  };
  [[nodiscard]] std::string book() const { return books_.empty() ? "" : books_[at_].string(); }

  void look() {
    const auto setting = logbook_setting();
    if (!setting) {
      absent_ = to_text(setting.error());
      return;
    }
    books_ = logbooks(*setting);
    if (books_.empty())
      absent_ = setting->off ? "No logbook is kept: ECS_LOGBOOK or the setting says off."
                             : "No logbook yet. Verbs and screens begin one when they work on a machine.";
    read();
  }

  void read() {
    entries_.clear();
    owner_.clear();
    if (books_.empty()) return;
    seen_ = time_of(book());
    const auto open = Logbook::open_to_read(book());
    auto entries = open ? open->entries(true) : tl::unexpected(open.error());
    const auto owner = open ? open->owner() : tl::unexpected(open.error());
    absent_ = entries ? "" : to_text(entries.error());
    if (entries) entries_ = std::move(*entries);
    if (owner) owner_ = in_words(*owner);
    follow();
  }

  void open_next() {
    if (books_.size() < 2) return;
    at_ = (at_ + 1) % books_.size();
    following_ = true;
    read();
  }

  void show_entry() {
    if (!entries_.empty()) show(whole(marked()));
  }

  /// `ecs log VERB` on this logbook, beside the screen; more than a line of it is shown as a page.
  void run(const std::string& doing, const std::string& verb) {
    if (task_.running() || books_.empty()) return;
    say(doing + " ...", Tone::warning);
    const auto work = [words = std::vector<std::string>{"log", verb, "--log", book()}](JobControl&) {
      std::ostringstream out, messages;
      const int code = run_program(words, out, messages);
      return Ran{std::string(trimmed(messages.str() + out.str())), code};
    };
    task_.start(doing, work, [this](const Ran& ran) {
      const std::string first = ran.text.substr(0, ran.text.find('\n'));
      say(first, ran.exit_code == kDone ? Tone::good : Tone::bad);
      if (first != ran.text) show(ran.text);
    });
  }

  std::vector<std::filesystem::path> books_;
  std::size_t at_ = 0;
  std::string owner_, absent_;
  std::vector<LogbookEntry> entries_;
  std::filesystem::file_time_type seen_{};
  TaskRunner task_;
};

}  // namespace

std::unique_ptr<Screen> log_screen() { return std::make_unique<LogScreen>(); }
std::unique_ptr<Screen> commands_screen() { return std::make_unique<CommandsScreen>(); }
std::unique_ptr<Screen> logbook_screen() { return std::make_unique<LogbookScreen>(); }

}  // namespace ecs::app
