// MESSAGES and COMMANDS: what the screens said, and what was done on them.
#include <algorithm>
#include <ctime>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "app/screens/unit/list_screen.hpp"
#include "app/screens/unit/screens.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "commissioning/session/commands.hpp"
#include "commissioning/session/message.hpp"

namespace ecs::app {
namespace {

std::string on_one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

std::string name_now(const char* stem, const char* extension) {
  return fmt::format("{}-{:%Y%m%d-%H%M%S}.{}", stem, fmt::localtime(std::time(nullptr)), extension);
}

// --- MESSAGES
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

  [[nodiscard]] std::string title() const override { return "MESSAGES"; }
  [[nodiscard]] std::string help() const override {
    return "The messages of the screens since the program started, newest last. The full text of the marked message is "
           "below the list. The file named above contains all messages with date and time. Press s to save a copy. To "
           "copy with the mouse, press Shift while selecting, because the screens use the mouse themselves.";
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
                       following_ ? ", new ones are shown as they come" : "");
  }
  [[nodiscard]] std::string below_heading() const override {
    return file_.empty() ? "no file: the state folder cannot be written" : "file " + file_.string();
  }
  [[nodiscard]] std::string while_empty() const override {
    return only_errors_ ? "no error since the start; press e for all messages"
                        : "No messages yet. Messages and errors of the screens are listed here.";
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
    if (sought_.empty()) return say("no search yet: press / to search", Tone::bad);
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
             {"x", "start again",
              [this] {
                asking_.ask({"Start again?", "The list is cleared; nothing else changes.", "start again", "keep them"},
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
    return "Every action of the screens that changed a file or the unit, as the equivalent command of ecs. The marked "
           "command is shown in full below the list; press F4 to copy it. Press w to write all commands as a shell "
           "script that stops at the first failing command: for training, for the next machine, and as a record. Run "
           "in a folder with the same files, the script repeats the actions. To use another unit, start it as "
           "`LINK=... ./script`; WORKSHOP=... in the same way selects another emulated machine, and ECS_ARM_CODE=... "
           "gives the code that the unit shows. Arming codes are never written. A line that begins with # is an action "
           "without an equivalent "
           "command. Press x to begin a new script.";
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
    return "No commands yet. Every action that changes a file or the unit is listed here as the equivalent command.";
  }
  [[nodiscard]] std::string whole(std::size_t row) const override { return command_text(commands_[row]); }

 private:
  std::vector<NotedCommand> commands_;
};

}  // namespace

std::unique_ptr<Screen> log_screen() { return std::make_unique<LogScreen>(); }
std::unique_ptr<Screen> commands_screen() { return std::make_unique<CommandsScreen>(); }

}  // namespace ecs::app
