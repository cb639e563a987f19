// COMMANDS: what was done on the screens, each action as the command that does the same; saved as a script.
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
#include "commissioning/session/commands.hpp"

namespace ecs::app {
namespace {

std::string script_name() { return fmt::format("ecs-{:%Y%m%d-%H%M%S}.sh", fmt::localtime(std::time(nullptr))); }

std::string command_row(const NotedCommand& command) {
  std::string text = command_text(command);
  std::replace(text.begin(), text.end(), '\n', ' ');
  return fmt::format("{} {}", command.time, text);
}

/// Written whole, then made executable for those who may read it.
Result<void> write_script(const std::string& path, const std::vector<NotedCommand>& commands) {
  namespace fs = std::filesystem;
  if (auto written = write_file(path, script_of(commands)); !written) return written;
  std::error_code error;
  fs::permissions(path, fs::perms::owner_exec | fs::perms::group_exec | fs::perms::others_exec, fs::perm_options::add,
                  error);
  return {};
}

class CommandsScreen final : public Screen {
 public:
  CommandsScreen() : commands_(noted_commands()) { place_.selected = std::max(0, count() - 1); }

  [[nodiscard]] std::string title() const override { return "COMMANDS"; }
  void draw(Canvas& canvas, const Area& area) const override {
    if (area.rows < 4 || area.columns < 10) return;
    const Area text = area.between_margins();
    const int whole = std::clamp(area.rows / 4, 1, 8);
    canvas.text(text, 0, 0, fmt::format("{} action{}, newest last", count(), count() == 1 ? "" : "s"), Tone::strong);
    if (commands_.empty()) {
      canvas.paragraph(text.below(2), 0,
                       "Nothing was done yet. Whatever changes a file or the unit stands here as the command that does "
                       "the same.");
    } else {
      std::vector<ListRow> rows;
      for (const NotedCommand& command : commands_)
        rows.push_back({command_row(command), command.words.empty() ? Tone::faint : Tone::plain});
      draw_list(canvas, {area.row + 1, area.column, std::max(1, area.rows - 3 - whole), area.columns}, rows, place_);
      canvas.paragraph({area.row + area.rows - 2 - whole, area.column + 1, whole, area.columns - 2}, 0, copied(),
                       Tone::strong);
    }
    draw_foot(canvas, {area.row + area.rows - 1, area.column + 1, 1, area.columns - 2});
    draw_question(canvas, area, asking_);
  }

  [[nodiscard]] Step on_key(const Key& key) override {
    if (answers(asking_, key)) return stay();
    if (typing_) {
      on_name_key(key);
      return stay();
    }
    if (key.name == Key::Name::escape || is_letter(key, U'q')) return back();
    if (key.name == Key::Name::resized) return stay();
    said_.clear();
    if (key.name == Key::Name::mouse) {
      if (const auto clicked = place_.clicked(key); clicked && *clicked < count()) place_.selected = *clicked;
    } else if (is_letter(key, U'w') && !commands_.empty()) {
      typing_ = true;
      name_.set(script_name());
    } else if (is_letter(key, U'x') && !commands_.empty()) {
      asking_.ask(
          {"Begin anew?", "The actions so far leave this list; nothing else changes.", "begin anew", "keep them"},
          [this] {
            forget_commands();
            (void)advance();
          });
    } else {
      (void)place_.on_key(key, count());
    }
    return stay();
  }

  [[nodiscard]] std::vector<KeyHelp> keys() const override {
    if (typing_) return {{"Enter", "write the script"}, {"Esc", "leave it"}};
    if (commands_.empty()) return {{"Esc", "back"}};
    return {{"w", "write a script"}, {"F4", "copy the command"}, {"x", "begin anew"}, {"Esc", "back"}};
  }

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
    const bool at_end = place_.selected >= count() - 1;
    commands_ = std::move(now);
    if (grown && at_end) place_.selected = count() - 1;
    place_.selected = std::clamp(place_.selected, 0, std::max(0, count() - 1));
    return grown;
  }

  [[nodiscard]] bool typing() const override { return typing_; }
  [[nodiscard]] std::string copied() const override {
    return commands_.empty()
               ? std::string()
               : command_text(commands_[static_cast<std::size_t>(std::clamp(place_.selected, 0, count() - 1))]);
  }
  [[nodiscard]] CellPosition cursor(const Area& area) const override {
    if (!typing_) return {-1, -1};
    const int begin = width_of(kNameOfScript);
    return {area.row + area.rows - 1,
            area.column + 1 + begin + name_.cursor_column(std::max(1, area.columns - 2 - begin))};
  }

 private:
  static constexpr const char* kNameOfScript = "write the script to: ";

  [[nodiscard]] int count() const { return static_cast<int>(commands_.size()); }

  void write(const std::string& path) {
    const auto written = write_script(path, commands_);
    bad_ = !written;
    said_ = written ? fmt::format("{} actions written to {}", commands_.size(), path) : to_text(written.error());
  }

  void on_name_key(const Key& key) {
    if (key.name == Key::Name::escape) {
      typing_ = false;
    } else if (key.name == Key::Name::enter) {
      typing_ = false;
      const std::string path(trimmed(name_.text()));
      std::error_code error;
      bad_ = path.empty();
      said_ = bad_ ? "expected a file name, got none" : "";
      if (bad_) return;
      if (!std::filesystem::exists(path, error)) return write(path);
      asking_.ask({fmt::format("Replace {}?", path), "The file exists: what is in it is lost.", "replace", "keep it"},
                  [this, path] { write(path); });
    } else if (key.name == Key::Name::tab) {
      name_.set(completed_path(name_.text()).completed);
    } else {
      (void)name_.on_key(key);
    }
  }

  void draw_foot(Canvas& canvas, const Area& area) const {
    if (!typing_) return static_cast<void>(canvas.paragraph(area, 0, said_, bad_ ? Tone::bad : Tone::good));
    const int begin = canvas.text(area, 0, 0, kNameOfScript, Tone::strong);
    name_.draw(canvas, area, 0, begin, std::max(1, area.columns - begin), true);
  }

  std::vector<NotedCommand> commands_;
  ListPlace place_;
  bool typing_ = false;
  TextLine name_;
  std::string said_;
  bool bad_ = false;
  Asking asking_;
};

}  // namespace

std::unique_ptr<Screen> commands_screen() { return std::make_unique<CommandsScreen>(); }

}  // namespace ecs::app
