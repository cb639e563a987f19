#include "app/cli/catalogue.hpp"

#include <algorithm>
#include <utility>

namespace ecs::app {
namespace {

/// "--output" of "-o,--output".
std::string long_name(const std::string& name) {
  const std::size_t at = name.find("--");
  return at == std::string::npos ? name : name.substr(at);
}

VerbOption option_of(const cli::Argument& argument) {
  VerbOption one;
  one.by_place = argument.by_place();
  one.name = one.by_place ? argument.name : long_name(argument.name);
  one.help = argument.help;
  one.value = argument.preset();
  one.choices = argument.choices;
  one.required = argument.need == Need::required;
  one.flag = argument.is_flag();
  one.many = argument.takes_many();
  one.output = argument.is_output;
  return one;
}

VerbEntry entry_of(const Action& definition) {
  std::string link, arm_code;
  const Action::Bound bound = definition.bound({{}, &link, &arm_code});
  VerbEntry entry{definition.words(), definition.help, "Example:\n  " + definition.example, {}, definition.is.live};
  for (const cli::Argument& argument : bound.arguments) entry.options.push_back(option_of(argument));
  std::stable_partition(entry.options.begin(), entry.options.end(), [](const VerbOption& o) { return o.required; });
  return entry;
}

}  // namespace

std::string VerbEntry::name() const {
  std::string name;
  for (const std::string& word : words) name += (name.empty() ? "" : " ") + word;
  return name;
}

std::vector<MenuEntry> verb_catalogue(const Registry& registry) {
  std::vector<MenuEntry> menus;
  MenuEntry other{"OTHER", {}};
  std::string menu;
  for (const Action* verb : registry.actions) {
    const std::string first = verb->words().front();
    const std::string title = registry.menu_help(first);
    if (!title.empty() && first != menu) menus.push_back({title, {}});
    menu = first;
    (title.empty() ? other : menus.back()).verbs.push_back(entry_of(*verb));
  }
  menus.push_back(std::move(other));
  return menus;
}

std::vector<std::string> split_words(const std::string& text) {
  std::vector<std::string> words;
  std::string word;
  bool inside = false;
  char quote = 0;
  for (const char c : text) {
    if (quote != 0) {
      if (c == quote)
        quote = 0;
      else
        word += c;
    } else if (c == '"' || c == '\'') {
      quote = c;
      inside = true;
    } else if (c == ' ') {
      if (inside) words.push_back(word);
      word.clear();
      inside = false;
    } else {
      word += c;
      inside = true;
    }
  }
  if (inside) words.push_back(word);
  return words;
}

std::vector<std::string> command_line(const VerbEntry& verb, const std::vector<std::string>& values) {
  std::vector<std::string> line = verb.words;
  const auto add_values = [&](const VerbOption& option, const std::string& value) {
    if (!option.many) return line.push_back(value);
    for (const std::string& word : split_words(value)) line.push_back(word);
  };
  for (std::size_t k = 0; k < verb.options.size() && k < values.size(); ++k) {
    const VerbOption& option = verb.options[k];
    if (values[k].empty() || (values[k] == option.value && !option.required)) continue;
    if (!option.by_place) line.push_back(option.name);
    if (option.flag) continue;
    add_values(option, values[k]);
  }
  return line;
}

}  // namespace ecs::app
