#include "commissioning/session/commands.hpp"

#include <algorithm>
#include <array>
#include <ctime>
#include <filesystem>
#include <map>
#include <mutex>
#include <set>
#include <string_view>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "base/file.hpp"
#include "base/text.hpp"

namespace ecs::commissioning {
namespace {

bool is_plain(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
         std::string_view("_@%+=:,./-").find(c) != std::string_view::npos;
}

}  // namespace

std::string shell_word(const std::string& word) {
  if (!word.empty() && std::all_of(word.begin(), word.end(), is_plain)) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string shell_command(const std::vector<std::string>& words) {
  std::string line;
  for (const std::string& word : words) line += (line.empty() ? "" : " ") + shell_word(word);
  return line;
}

namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 7> kOutputs{"-o",     "--output", "--params-out", "--save",
                                                   "--plot", "--record", "--values"};
constexpr std::array<std::string_view, 2> kWorkshops{"workshop", "--workshop"};  // a socket stands behind

std::mutex commands_mutex;
std::vector<NotedCommand> commands_noted;
std::set<std::string> outputs_noted;  ///< files that the commands wrote so far
int files_between = 0;
std::map<std::string, std::string> other_names;  ///< of files, by their whole path

template <std::size_t N>
bool is_one_of(const std::array<std::string_view, N>& names, const std::string& word) {
  return std::find(names.begin(), names.end(), word) != names.end();
}

/// The files that a command writes.
std::vector<std::string> outputs_in(const std::vector<std::string>& words) {
  std::vector<std::string> outputs;
  for (std::size_t k = 0; k + 1 < words.size(); ++k)
    if (is_one_of(kOutputs, words[k]) && !words[k + 1].starts_with("-")) outputs.push_back(words[k + 1]);
  return outputs;
}

/// "--code" of other verbs is a component.
void leave_out_secrets(std::vector<std::string>& words) {
  const bool arms = words.size() > 2 && words[1] == "unit" && words[2] == "arm";
  std::vector<std::string> kept;
  for (std::size_t k = 0; k < words.size(); ++k) {
    const std::string name = words[k].substr(0, words[k].find('='));
    if (name != "--arm-code" && !(arms && name == "--code"))
      kept.push_back(std::move(words[k]));
    else if (name == words[k])
      ++k;  // its value
  }
  words = std::move(kept);
}

/// --force where it writes a file that a command before it wrote and that it does not read itself.
void force_where_needed(std::vector<std::string>& words) {
  bool again = false;
  for (const std::string& output : outputs_in(words)) {
    const bool in_place = std::count(words.begin(), words.end(), output) > 1;
    again = again || (!outputs_noted.insert(output).second && !in_place);
  }
  if (again && std::find(words.begin(), words.end(), "--force") == words.end()) words.emplace_back("--force");
}

std::string time_now_text() { return fmt::format("{:%H:%M:%S}", fmt::localtime(std::time(nullptr))); }

// --- as a shell takes it

/// What a script names by variables; empty: nothing.
struct ScriptNames {
  std::string link, workshop;
};

/// The word behind `name`; empty: there is none.
std::string word_behind(const std::vector<std::string>& words, std::string_view name) {
  const auto at = std::find(words.begin(), words.end(), name);
  return at == words.end() || at + 1 == words.end() ? std::string() : *(at + 1);
}

std::string line_of_words(const std::vector<std::string>& words, const ScriptNames& names) {
  std::string line;
  for (std::size_t k = 0; k < words.size(); ++k) {
    line += k == 0 ? "" : " ";
    if (k > 0 && words[k - 1] == "--link" && words[k] == names.link)
      line += "\"$LINK\"";
    else if (k > 0 && is_one_of(kWorkshops, words[k - 1]) && words[k] == names.workshop)
      line += "\"$WORKSHOP\"";
    else
      line += shell_word(words[k]);
  }
  return line;
}

std::string as_remark(const std::string& text) {
  std::string out;
  for (const std::string_view line : lines_of(text)) out += fmt::format("{}# {}", out.empty() ? "" : "\n", line);
  return out;
}

/// In one line: a folder's name may have any character.
std::string folder_text() {
  std::error_code error;
  std::string text = fs::current_path(error).string();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

ScriptNames names_in(const std::vector<NotedCommand>& commands) {
  ScriptNames names;
  for (const NotedCommand& command : commands)
    for (const auto* words : {&command.words, &command.meanwhile}) {
      if (names.link.empty()) names.link = word_behind(*words, "--link");
      for (const std::string_view name : kWorkshops)
        if (names.workshop.empty()) names.workshop = word_behind(*words, name);
    }
  return names;
}

/// `: "${LINK:=…}"`, the value as it is inside of double quotes.
std::string preset_line(const char* name, const std::string& value, const char* what) {
  if (value.empty()) return {};
  std::string inside;
  for (const char c : value) {
    if (std::string_view("\\\"$`}").find(c) != std::string_view::npos) inside += '\\';
    inside += c;
  }
  return fmt::format(": \"${{{}:={}}}\"  # {}\n", name, inside, what);
}

/// A line that ends the file and is none of its own.
std::string end_for(const std::string& content) {
  std::string end = "END";
  while (("\n" + content).find("\n" + end + "\n") != std::string::npos) end += "_";
  return end;
}

class ScriptWriter {
 public:
  explicit ScriptWriter(ScriptNames names) : names_(std::move(names)) {}

  std::string text_of(const NotedCommand& command) {
    if (!command.file.empty()) return folder_for(command.file) + file_text(command);
    if (command.words.empty()) return as_remark(command.text) + "\n";
    if (command.words.front() == "cp") return folder_for(command.words.back()) + copy_text(command.words);
    std::string text;
    for (const std::string& output : outputs_in(command.words)) text += folder_for(output);
    if (!command.meanwhile.empty())
      text += fmt::format("{{ sleep 1; {}; }} &\n", line_of_words(command.meanwhile, names_));
    text += line_of_words(command.words, names_);
    if (command.exit_code == 1) text += " || [ $? -eq 1 ]";  // as it was on the screen: it did not hold
    return text + (command.meanwhile.empty() ? "\n" : "\nwait\n");
  }

 private:
  /// cp would overwrite.
  std::string copy_text(const std::vector<std::string>& words) {
    const char* into = written_.insert(words.back()).second ? ">" : ">|";
    return fmt::format("cat {} {}{}\n", shell_word(words[1]), into, shell_word(words.back()));
  }

  std::string folder_for(const std::string& path) {
    const std::string folder = fs::path(path).parent_path().string();
    if (folder.empty() || fs::path(path).is_absolute() || !made_.insert(folder).second) return {};
    return fmt::format("mkdir -p {}\n", shell_word(folder));
  }

  /// The first time it must not be there.
  std::string file_text(const NotedCommand& command) {
    const std::string end = end_for(command.text);
    const char* into = written_.insert(command.file).second ? ">" : ">|";
    return fmt::format("cat {}{} <<'{}'\n{}{}{}\n", into, shell_word(command.file), end, command.text,
                       command.text.ends_with('\n') || command.text.empty() ? "" : "\n", end);
  }

  ScriptNames names_;
  std::set<std::string> made_, written_;
};

}  // namespace

std::size_t note(NotedCommand command) {
  const std::lock_guard lock(commands_mutex);
  if (command.time.empty()) command.time = time_now_text();
  leave_out_secrets(command.words);
  force_where_needed(command.words);
  commands_noted.push_back(std::move(command));
  return commands_noted.size() - 1;
}

std::size_t note_command(std::vector<std::string> words, int exit_code) {
  words.insert(words.begin(), "ecs");
  NotedCommand command;
  command.words = std::move(words);
  command.exit_code = exit_code;
  return note(std::move(command));
}

std::size_t note_workshop(const std::string& socket, std::vector<std::string> words) {
  words.insert(words.begin(), {"ecs-emulator", "workshop", socket});
  NotedCommand command;
  command.words = std::move(words);
  return note(std::move(command));
}

void note_remark(const std::string& text) {
  NotedCommand command;
  command.text = text;
  note(std::move(command));
}

void note_file(const std::string& path, const std::string& content) {
  NotedCommand command;
  command.file = path_word(path);
  command.text = content;
  note(std::move(command));
}

void amend(std::size_t place, NotedCommand command) {
  const std::lock_guard lock(commands_mutex);
  if (place >= commands_noted.size()) return;
  command.time = commands_noted[place].time;
  force_where_needed(command.words);
  commands_noted[place] = std::move(command);
}

std::vector<NotedCommand> noted_commands() {
  const std::lock_guard lock(commands_mutex);
  return commands_noted;
}

void forget_commands() {
  const std::lock_guard lock(commands_mutex);
  commands_noted.clear();
  outputs_noted.clear();
  files_between = 0;
  other_names.clear();
}

std::string path_word(const std::string& path) {
  if (path.empty()) return path;
  std::error_code error;
  const fs::path here = fs::current_path(error);
  const fs::path whole = fs::absolute(path, error).lexically_normal();
  {
    const std::lock_guard lock(commands_mutex);
    if (const auto other = other_names.find(whole.string()); other != other_names.end()) return other->second;
  }
  const auto [end, rest] = std::mismatch(here.begin(), here.end(), whole.begin(), whole.end());
  if (error || end != here.end() || here == here.root_path()) return whole.string();
  const fs::path inside = whole.lexically_relative(here);
  return inside.empty() ? whole.string() : inside.string();
}

void name_in_commands(const std::string& path, const std::string& word) {
  const std::string whole = disc::absolute(path).lexically_normal().string();
  const std::lock_guard lock(commands_mutex);
  other_names[whole] = word;
}

std::string file_between(const std::string& stem, const std::string& extension) {
  const std::lock_guard lock(commands_mutex);
  return fmt::format("screen-{}-{}{}", stem, ++files_between, extension);
}

std::string command_text(const NotedCommand& command) {
  if (!command.file.empty())
    return fmt::format("cat >{}  # the file as written by the screens", shell_word(command.file));
  return command.words.empty() ? as_remark(command.text) : line_of_words(command.words, {});
}

std::string script_of(const std::vector<NotedCommand>& commands) {
  const ScriptNames names = names_in(commands);
  std::string text = fmt::format(
      "#!/bin/sh\n# Actions on the screens of ecs on {:%Y-%m-%d}, as the commands that do the "
      "same.\n"
      "# File names are relative to the folder {}. In another\n# folder the script needs the same input files; it "
      "overwrites no file.\n"
      "# Commands that write to a unit need its code: ECS_ARM_CODE=… in front of sh.\nset -e\nset -C\n",
      fmt::localtime(std::time(nullptr)), folder_text());
  text += preset_line("LINK", names.link, "the unit; LINK=… in front of sh selects another one");
  text +=
      preset_line("WORKSHOP", names.workshop, "socket of the emulated machine: `ecs-emulator serve --workshop SOCKET`");
  ScriptWriter writer(names);
  for (const NotedCommand& command : commands) text += fmt::format("\n# {}\n{}", command.time, writer.text_of(command));
  return text;
}

}  // namespace ecs::commissioning
