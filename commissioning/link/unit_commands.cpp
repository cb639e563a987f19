#include "commissioning/link/unit_commands.hpp"

#include <algorithm>

namespace ecs::commissioning {

std::vector<std::string> words_on_unit(const UnitConnection& unit, std::vector<std::string> words) {
  words.insert(words.begin(), "ecs");
  const std::string link = unit.snapshot().link.empty() ? unit.link() : unit.snapshot().link;
  if (!link.empty()) words.insert(words.end(), {"--link", link});
  return words;
}

void note_on_unit(const UnitConnection& unit, std::vector<std::string> words, int exit_code) {
  NotedCommand command;
  command.words = words_on_unit(unit, std::move(words));
  command.exit_code = exit_code;
  note(std::move(command));
}

void note_form(const UnitConnection& unit, std::vector<std::string> words, int exit_code) {
  const auto option = std::find(words.begin(), words.end(), "--link");
  if (option != words.end() && option + 1 != words.end()) {
    if (*(option + 1) != unit.link()) return static_cast<void>(note_command(std::move(words), exit_code));
    words.erase(option, option + 2);
  }
  note_on_unit(unit, std::move(words), exit_code);
}

}  // namespace ecs::commissioning
