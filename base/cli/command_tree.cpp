#include "base/cli/command_tree.hpp"

#include <algorithm>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.hpp"

namespace ecs::cli {
namespace {

std::string range_text(double least, double most) {
  if (most == std::numeric_limits<double>::max()) return fmt::format("a number of at least {}", least);
  if (least == std::numeric_limits<double>::lowest()) return fmt::format("a number of at most {}", most);
  return fmt::format("a number from {} to {}", least, most);
}

CLI::Validator finite_number(double least, double most) {
  return CLI::Validator(
      [least, most](std::string& text) {
        const auto value = number_in(text);
        if (!value) return fmt::format("expected a number, got \"{}\"", text);
        if (*value < least || *value > most) return fmt::format("expected {}, got {}", range_text(least, most), text);
        return std::string();
      },
      std::string(), std::string());
}

CLI::Validator one_of(std::vector<std::string> words) {
  return CLI::Validator(
      [words = std::move(words)](std::string& text) {
        for (const std::string& word : words)
          if (lower(word) == lower(text)) {
            text = word;
            return std::string();
          }
        return fmt::format("expected {}, got \"{}\"", fmt::join(words, " or "), text);
      },
      std::string(), std::string());
}

/// Adds each kind of argument as the command-line library wants it.
struct OptionAdder {
  CLI::App& app;
  const Argument& argument;

  CLI::Option* operator()(std::string* into) const {
    CLI::Option* option = app.add_option(argument.name, *into, argument.help)->type_name("");
    if (argument.choices.empty()) return option;
    return option->type_name(fmt::format("{}", fmt::join(argument.choices, "|")))->transform(one_of(argument.choices));
  }
  CLI::Option* operator()(std::vector<std::string>* into) const {
    return app.add_option(argument.name, *into, argument.help)->type_name("");
  }
  CLI::Option* operator()(double* into) const { return number(app.add_option(argument.name, *into, argument.help)); }
  CLI::Option* operator()(std::optional<double>* into) const {
    return number(app.add_option_function<double>(
        argument.name, [into](const double& value) { *into = value; }, argument.help));
  }
  CLI::Option* operator()(int* into) const { return integer(app.add_option(argument.name, *into, argument.help)); }
  CLI::Option* operator()(std::size_t* into) const {
    return integer(app.add_option(argument.name, *into, argument.help));
  }
  CLI::Option* operator()(std::optional<std::uint64_t>* into) const {
    return app
        .add_option_function<std::uint64_t>(
            argument.name, [into](const std::uint64_t& value) { *into = value; }, argument.help)
        ->check([](const std::string& text) {
          return text.starts_with('-') ? std::string("expected 0 or more") : std::string();
        })
        ->type_name("INTEGER");
  }
  CLI::Option* operator()(const OnNumber& on) const {
    return number(app.add_option_function<double>(argument.name, on, argument.help));
  }
  CLI::Option* operator()(const OnInteger& on) const {
    return integer(app.add_option_function<long long>(argument.name, on, argument.help));
  }
  CLI::Option* operator()(const OnText& on) const {
    return app.add_option_function<std::string>(argument.name, on, argument.help)->type_name("");
  }
  CLI::Option* operator()(const OnNumbers& on) const {
    return number(parted(app.add_option_function<std::vector<double>>(argument.name, on, argument.help)));
  }
  CLI::Option* operator()(const OnTexts& on) const {
    return parted(app.add_option_function<std::vector<std::string>>(argument.name, on, argument.help))->type_name("");
  }
  CLI::Option* operator()(const OnFlag& on) const {
    return app.add_flag_function(
        argument.name, [on](std::int64_t) { on(); }, argument.help);
  }
  CLI::Option* operator()(bool* into) const { return app.add_flag(argument.name, *into, argument.help); }

 private:
  CLI::Option* number(CLI::Option* option) const {
    return option->check(finite_number(argument.least, argument.most))->type_name("NUMBER");
  }
  CLI::Option* integer(CLI::Option* option) const {
    if (argument.most < std::numeric_limits<double>::max())
      option->check(CLI::Range(static_cast<int>(argument.least), static_cast<int>(argument.most)).description(""));
    return option->type_name("INTEGER");
  }
  CLI::Option* parted(CLI::Option* option) const { return argument.by_commas ? option->delimiter(',') : option; }
};

void add_argument(CLI::App& app, const Argument& argument) {
  CLI::Option* option = std::visit(OptionAdder{app, argument}, argument.into);
  option->required(argument.need == Need::required);
  if (!argument.heading.empty()) option->group(argument.heading);
  if (const std::string preset = argument.preset(); !preset.empty()) option->default_str(preset);
}

void add_arguments(CLI::App& app, const Arguments& arguments) {
  for (const Argument& argument : arguments) add_argument(app, argument);
}

std::vector<std::string> names_of_verbs(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(sub->get_name());
  return names;
}

std::vector<std::string> names_of_options(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

std::string did_you_mean(const std::string& word, const std::vector<std::string>& candidates) {
  const std::string near = nearest_word(word, candidates);
  return near.empty() ? std::string() : fmt::format("; did you mean \"{}\"?", near);
}

/// The verbs and menus below `app` whose own name this is, by their whole paths.
void add_paths_named(const CLI::App& app, const std::string& path, const std::string& name,
                     std::vector<std::string>& paths) {
  for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; })) {
    const std::string below = path + " " + sub->get_name();
    if (sub->get_name() == name) paths.push_back("`" + below + "`");
    add_paths_named(*sub, below, name, paths);
  }
}

/// The menu or verb that the words lead to, and the first word that is none.
struct WordsEnd {
  const CLI::App* app = nullptr;
  std::string parent;  ///< "ecs-emulator workshop SOCKET", without the app's own name
  std::string path;
  std::string stray;
};

std::size_t places_in(const CLI::App& app) {
  const auto options = app.get_options();
  return static_cast<std::size_t>(std::count_if(options.begin(), options.end(),
                                                [](const CLI::Option* option) { return option->get_positional(); }));
}

WordsEnd end_of(const CLI::App& root, const std::vector<std::string>& words) {
  WordsEnd end;
  end.app = &root;
  end.path = root.get_name();
  std::size_t places = 0;  ///< words that the menu itself takes by their place
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i].starts_with("-") || (i > 0 && words[i - 1] == "--link")) continue;
    const auto subs = end.app->get_subcommands([&](const CLI::App* sub) { return sub->get_name() == words[i]; });
    if (subs.empty()) {
      if (places > 0) {
        --places;
        continue;
      }
      if (!names_of_verbs(*end.app).empty()) end.stray = words[i];
      break;
    }
    end.parent = end.path;
    for (const CLI::Option* option : end.app->get_options())
      if (option->get_positional()) end.parent += " " + option->get_name(true);
    end.app = subs.front();
    end.path += " " + words[i];
    places = places_in(*end.app);
  }
  return end;
}

bool contains(const std::vector<std::string>& all, const std::string& word) {
  return std::find(all.begin(), all.end(), word) != all.end();
}

/// "--smooth needs a NUMBER: …" where the parser complains of an option without its value; else empty.
std::string lacking_value(const CLI::App& app, const std::vector<std::string>& words, const std::string& what) {
  if (what.find(" required ") == std::string::npos || what.find(" missing") == std::string::npos) return {};
  for (const std::string& word : words) {
    const CLI::Option* option = word.starts_with("-") ? app.get_option_no_throw(word) : nullptr;
    if (option == nullptr || !what.starts_with(option->get_name() + ":")) continue;
    const std::string kind = option->get_type_name();
    return fmt::format("{} needs {} after it: {}", word, kind.empty() ? "a value" : "a value (" + kind + ")",
                       option->get_description());
  }
  return {};
}

/// That a menu has no such verb, with the nearest that it has, or those of that name in its other menus.
std::string no_verb_text(const WordsEnd& end) {
  const std::vector<std::string> verbs = names_of_verbs(*end.app);
  std::string near = did_you_mean(end.stray, verbs);
  std::vector<std::string> elsewhere;
  if (end.stray == "help") near = fmt::format("; did you mean `{} --help`?", end.path);
  if (near.empty()) add_paths_named(*end.app, end.path, end.stray, elsewhere);
  if (!elsewhere.empty()) near = fmt::format("; did you mean {}?", fmt::join(elsewhere, " or "));
  return fmt::format("`{}` has no verb \"{}\"{} It has: {}", end.path, end.stray, near.empty() ? "." : near,
                     fmt::join(verbs, ", "));
}

std::string usage_text(const CLI::App& root, const std::vector<std::string>& words, const std::string& what) {
  const WordsEnd end = end_of(root, words);
  if (!end.stray.empty()) return no_verb_text(end);
  if (const std::string lacks = lacking_value(*end.app, words, what); !lacks.empty())
    return fmt::format("{}: {} (see `{} --help`)", end.path, lacks, end.path);
  const std::vector<std::string> options = names_of_options(*end.app);
  std::string hint;
  for (const std::string& word : words)
    if (word.starts_with("--") && what.find(word) != std::string::npos && hint.empty() && !contains(options, word))
      hint = did_you_mean(word, options);
  return fmt::format("{}: {}{} (see `{} --help`)", end.path, what, hint, end.path);
}

std::string menu_text(const WordsEnd& end) {
  return fmt::format("`{}` needs a verb: {} (see `{} --help`)", end.path, fmt::join(names_of_verbs(*end.app), ", "),
                     end.path);
}

/// Lines of at most 80 columns; the help of an option goes on under its beginning. Examples stay in one piece.
std::string wrapped_help(const std::string& help) {
  constexpr std::size_t kWide = 80;
  constexpr std::size_t kHelpColumn = 30;
  std::string out;
  bool example = false;
  for (std::string_view line : lines_of(help)) {
    if (line.empty() && out.ends_with("\n\n")) continue;  // between groups of options
    example = example || line.starts_with("Example:");
    const std::size_t indent = line.starts_with("  ") ? kHelpColumn : 0;
    std::size_t room = kWide;
    while (line.size() > room && !example) {
      const std::size_t cut = line.rfind(' ', room);
      if (cut == std::string_view::npos || line.find_first_not_of(' ') > cut) break;
      out += std::string(line.substr(0, cut)) + "\n" + std::string(indent, ' ');
      line.remove_prefix(cut + 1);
      room = kWide - indent;
    }
    out += std::string(line) + "\n";
  }
  return out;
}

}  // namespace

CommandTree::CommandTree(const std::string& program, const Menu& root, std::vector<Menu> menus)
    : root_(std::make_unique<CLI::App>(root.help, program)), menus_(std::move(menus)) {
  root_->get_formatter()->label("Positionals", "Arguments");  // of every verb, which has the same formatter
  add_arguments(*root_, root.arguments);
  root_->set_version_flag("--version", "");
  root_->require_subcommand(0, 1);
}

CommandTree::~CommandTree() = default;

CLI::App& CommandTree::menu_at(CLI::App& parent, const std::string& name, const std::string& path) {
  for (CLI::App* sub : parent.get_subcommands([&](const CLI::App* one) { return one->get_name() == name; }))
    return *sub;
  CLI::App* made = parent.add_subcommand(name);
  made->require_subcommand(0, 1);
  for (const Menu& menu : menus_) {
    if (menu.path != path) continue;
    made->description(menu.help);
    add_arguments(*made, menu.arguments);
  }
  return *made;
}

void CommandTree::add_verb(const std::string& path, const std::string& help, const std::string& example,
                           const Arguments& arguments, std::function<void()> chosen) {
  CLI::App* parent = root_.get();
  std::vector<std::string> words = words_of(path);
  const std::string name = words.back();
  words.pop_back();
  std::string menu;
  for (const std::string& word : words) {
    menu += (menu.empty() ? "" : " ") + word;
    parent = &menu_at(*parent, word, menu);
  }
  CLI::App* verb = parent->add_subcommand(name, help);
  add_arguments(*verb, arguments);
  verb->footer("Example:\n  " + example);
  verb->callback(std::move(chosen));
}

Request CommandTree::parsed(const std::vector<std::string>& words) {
  try {
    root_->parse(std::vector<std::string>(words.rbegin(), words.rend()));
  } catch (const CLI::CallForHelp&) {
    const WordsEnd end = end_of(*root_, words);
    if (!end.stray.empty()) return {Request::Kind::wrong, no_verb_text(end)};
    return {Request::Kind::help, wrapped_help(end.app->help(end.parent))};
  } catch (const CLI::CallForVersion&) {
    return {Request::Kind::version, {}};
  } catch (const CLI::ExtrasError&) {  // which lists the words backwards
    const std::vector<std::string> extras = root_->remaining(true);
    return {Request::Kind::wrong,
            usage_text(*root_, words,
                       fmt::format("The following argument{} not expected: {}", extras.size() == 1 ? " was" : "s were",
                                   fmt::join(extras, " ")))};
  } catch (const CLI::ParseError& error) {
    return {Request::Kind::wrong, usage_text(*root_, words, error.what())};
  }
  if (root_->get_subcommands().empty()) return {Request::Kind::no_words, menu_text(end_of(*root_, words))};
  // What the parser took, not what the words look like: a menu takes a verb's name for its own word by place.
  WordsEnd end{root_.get(), {}, root_->get_name(), {}};
  while (!end.app->get_subcommands().empty()) {
    end.app = end.app->get_subcommands().front();
    end.path += " " + end.app->get_name();
  }
  if (!names_of_verbs(*end.app).empty()) return {Request::Kind::wrong, menu_text(end)};
  return {Request::Kind::run, {}};
}

}  // namespace ecs::cli
