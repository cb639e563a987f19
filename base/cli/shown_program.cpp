#include "base/cli/shown_program.hpp"

#include <algorithm>

#include "base/text.hpp"

namespace ecs::cli {

std::string ShownProgram::help_of(const std::string& path) const {
  for (const ShownVerb& verb : verbs)
    if (verb.path == path) return verb.help;
  for (const Menu& menu : menus)
    if (menu.path == path) return menu.help;
  return path.empty() ? help : std::string();
}

std::vector<std::string> ShownProgram::next_words(const std::string& path) const {
  const std::vector<std::string> before = words_of(path);
  std::vector<std::string> next;
  for (const ShownVerb& verb : verbs) {
    const std::vector<std::string> words = words_of(verb.path);
    if (words.size() <= before.size() || !std::equal(before.begin(), before.end(), words.begin())) continue;
    if (std::find(next.begin(), next.end(), words[before.size()]) == next.end()) next.push_back(words[before.size()]);
  }
  return next;
}

std::vector<std::string> ShownProgram::paths() const {
  std::vector<std::string> all{""};
  for (const Menu& menu : menus) all.push_back(menu.path);
  for (const ShownVerb& verb : verbs) all.push_back(verb.path);
  return all;
}

std::vector<ShownArgument> shown(const std::vector<VerbArgument>& arguments) {
  std::vector<ShownArgument> all{{{"-h", "--help"}, "the help", {}, {}, false, false, true, false}};
  for (const VerbArgument& argument : arguments) {
    ShownArgument one;
    for (const std::string_view name : split(argument.name, ',')) one.names.emplace_back(name);
    one.help = argument.help;
    one.preset = argument.preset();
    one.choices = argument.choices;
    one.by_place = argument.by_place();
    one.required = argument.need == Need::required;
    one.flag = argument.is_flag();
    one.many = argument.takes_many();
    all.push_back(std::move(one));
  }
  return all;
}

}  // namespace ecs::cli
