// What the screens did, each action as the command line that does the same: shown by the panel COMMANDS, written as a
// shell script that does it again. Controllers note an action where it has succeeded; what only looks is not noted.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace ecs::commissioning {

struct NotedCommand {
  std::string time{};                    ///< "14:05:09", local; note() fills it in
  std::vector<std::string> words{};      ///< from the program on: "ecs", "map", "send", …; "cp"; empty: `text` alone
  std::string text{};                    ///< of a remark; the content of `file`
  std::string file{};                    ///< that the commands after it read and no command makes; empty: none
  int exit_code = 0;                     ///< of the command: 1 where what was asked did not hold
  std::vector<std::string> meanwhile{};  ///< a command that runs beside it: the machine is referenced while it records
};

/// From any thread. An arming code is left out: the script takes it from $ECS_ARM_CODE. A file written before gets
/// --force. @return its place, for amend()
std::size_t note(NotedCommand command);
/// `ecs` with these words.
std::size_t note_command(std::vector<std::string> words, int exit_code = 0);
/// `ecs-emulator workshop SOCKET` with these words: what a person did at the emulated machine.
std::size_t note_workshop(const std::string& socket, std::vector<std::string> words);
/// An action that no command does.
void note_remark(const std::string& text);
/// A file that the screens wrote and no command makes, such as a recipe.
void note_file(const std::string& path, const std::string& content);
/// More became known of one: where its answer was saved.
void amend(std::size_t place, NotedCommand command);

[[nodiscard]] std::vector<NotedCommand> noted_commands();
/// From here on a new script.
void forget_commands();

/// A path as a command names it: from the working folder on where it lies in there, else whole.
[[nodiscard]] std::string path_word(const std::string& path);
/// From now on path_word() says `word` for a file that lies elsewhere, such as in the state folder.
void name_in_commands(const std::string& path, const std::string& word);
/// "screen-parameters-1.toml": a file that only the commands need, another one with each call.
[[nodiscard]] std::string file_between(const std::string& stem, const std::string& extension);

/// As a shell takes it: "ecs params set mill.toml 'axis.X.label=it'\''s' -o new.toml". Of a remark "# …".
[[nodiscard]] std::string command_text(const NotedCommand& command);
/// A script for any POSIX shell that ends with the first command that fails. The link of its first command is $LINK and
/// the first workshop $WORKSHOP, which the environment may name otherwise.
[[nodiscard]] std::string script_of(const std::vector<NotedCommand>& commands);

/// As a POSIX shell takes it: quoted where it holds more than letters, digits and signs that mean nothing there.
[[nodiscard]] std::string shell_word(const std::string& word);
/// A whole command.
[[nodiscard]] std::string shell_command(const std::vector<std::string>& words);

}  // namespace ecs::commissioning
