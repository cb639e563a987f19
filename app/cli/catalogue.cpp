#include "app/cli/catalogue.hpp"

#include <sstream>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "app/cli/menus.hpp"
#include "base/text.hpp"

namespace ecs::app {
namespace {

std::vector<const CLI::App*> subcommands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

std::vector<std::string> words_between_bars(const std::string& type) {
  std::vector<std::string> words;
  if (type.find('|') == std::string::npos) return words;
  std::istringstream in(type);
  for (std::string word; std::getline(in, word, '|');) words.push_back(word);
  return words;
}

VerbOption option_of(const CLI::Option& option) {
  VerbOption one;
  one.by_place = option.nonpositional() == false && option.get_positional();
  one.name = one.by_place ? option.get_name(true, false) : option.get_name(false, false);
  if (!one.by_place && !option.get_lnames().empty()) one.name = "--" + option.get_lnames().front();
  one.help = option.get_description();
  one.value = option.get_default_str();
  one.choices = words_between_bars(option.get_type_name());
  one.required = option.get_required();
  one.flag = option.get_expected_max() == 0;
  one.many = option.get_expected_max() > 1;
  return one;
}

bool of_every_verb(const CLI::Option& option) {
  const std::string name = option.get_name(false, false);
  return name == "--json" || name == "--quiet" || name.find("help") != std::string::npos;
}

VerbEntry entry_of(const CLI::App& verb, std::vector<std::string> words) {
  VerbEntry entry{std::move(words), verb.get_description(), verb.get_footer(), {}};
  for (const CLI::Option* option : verb.get_options())
    if (!of_every_verb(*option)) entry.options.push_back(option_of(*option));
  std::stable_partition(entry.options.begin(), entry.options.end(), [](const VerbOption& o) { return o.required; });
  return entry;
}

void add_verbs(const CLI::App& menu, const std::vector<std::string>& words, std::vector<VerbEntry>& out) {
  for (const CLI::App* sub : subcommands_of(menu)) {
    std::vector<std::string> path = words;
    path.push_back(sub->get_name());
    if (subcommands_of(*sub).empty())
      out.push_back(entry_of(*sub, std::move(path)));
    else
      add_verbs(*sub, path, out);
  }
}

}  // namespace

std::string VerbEntry::name() const {
  std::string name;
  for (const std::string& word : words) name += (name.empty() ? "" : " ") + word;
  return name;
}

std::vector<MenuEntry> verb_catalogue() {
  CommonOptions common;
  Action chosen;
  CLI::App root("", "ecs");
  Menu menu(root, common, chosen);
  add_all_menus(menu);
  std::vector<MenuEntry> menus;
  MenuEntry other{"OTHER", {}};
  for (const CLI::App* sub : subcommands_of(root)) {
    if (subcommands_of(*sub).empty()) {
      other.verbs.push_back(entry_of(*sub, {sub->get_name()}));
      continue;
    }
    menus.push_back({sub->get_description(), {}});
    add_verbs(*sub, {sub->get_name()}, menus.back().verbs);
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
