#include "app/cli/parser.hpp"

#include <algorithm>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/cli/verb_unit.hpp"
#include "base/text.hpp"

namespace ecs::app {
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
  const VerbArgument& argument;

  CLI::Option* operator()(std::string* into) const {
    CLI::Option* option = app.add_option(argument.name, *into, argument.help)->type_name("");
    if (argument.choices.empty()) return option;
    return option->type_name(fmt::format("{}", fmt::join(argument.choices, "|")))->check(one_of(argument.choices));
  }
  CLI::Option* operator()(std::vector<std::string>* into) const {
    return app.add_option(argument.name, *into, argument.help)->type_name("");
  }
  CLI::Option* operator()(double* into) const { return number(app.add_option(argument.name, *into, argument.help)); }
  CLI::Option* operator()(std::optional<double>* into) const {
    return number(app.add_option_function<double>(
        argument.name, [into](const double& value) { *into = value; }, argument.help));
  }
  CLI::Option* operator()(int* into) const {
    return app.add_option(argument.name, *into, argument.help)
        ->check(CLI::Range(static_cast<int>(argument.least), static_cast<int>(argument.most)).description(""))
        ->type_name("INTEGER");
  }
  CLI::Option* operator()(bool* into) const { return app.add_flag(argument.name, *into, argument.help); }

 private:
  CLI::Option* number(CLI::Option* option) const {
    return option->check(finite_number(argument.least, argument.most))->type_name("NUMBER");
  }
};

void add_argument(CLI::App& app, const VerbArgument& argument) {
  CLI::Option* option = std::visit(OptionAdder{app, argument}, argument.into);
  option->required(argument.need == Need::required);
  if (const std::string preset = argument.preset(); !preset.empty()) option->default_str(preset);
}

void add_common_flags(CLI::App& app, VerbContext& context) {
  app.add_flag("--json", context.console.json, "the answer as one JSON object on stdout");
  app.add_flag("--quiet", context.console.quiet, "no notes and no progress bar");
}

/// The registry as the command-line library knows it; `chosen` is the action of the verb that the words name.
class Tree {
 public:
  Tree(const VerbRegistry& registry, VerbContext& context) : registry_(&registry), context_(&context) {
    add_common_flags(root, context);
    root.add_option("--link", context.link_option, "rtu:/dev/ttyUSB0:115200, tcp:host:port, emulator[:machine.toml]")
        ->type_name("");
    root.set_version_flag("--version", "");
    root.require_subcommand(0, 1);
    for (const VerbDefinition* verb : registry.verbs) add(*verb);
  }

  CLI::App root{kProgramHelp, "ecs"};
  Action chosen;

 private:
  /// The menu of that name in `parent`, made where it is not there yet.
  CLI::App* menu(CLI::App* parent, const std::string& name, const std::string& path) {
    for (CLI::App* sub : parent->get_subcommands([&](const CLI::App* one) { return one->get_name() == name; }))
      return sub;
    CLI::App* made = parent->add_subcommand(name, registry_->menu_help(path));
    made->require_subcommand(0, 1);
    add_common_flags(*made, *context_);
    return made;
  }

  void add(const VerbDefinition& verb) {
    CLI::App* parent = &root;
    std::string path;
    std::vector<std::string> words = verb.words();
    const std::string name = words.back();
    words.pop_back();
    for (const std::string& word : words) {
      path += (path.empty() ? "" : " ") + word;
      parent = menu(parent, word, path);
    }
    CLI::App* sub = parent->add_subcommand(name, verb.help);
    add_common_flags(*sub, *context_);
    sub->footer("Example:\n  " + verb.example);
    Verb options(context_->link_option);
    Action action = verb.declare(options);
    for (const VerbArgument& argument : options.arguments()) add_argument(*sub, argument);
    if (options.writes())
      action = [inner = std::move(action)](VerbContext& context) {
        announce_writing(context);
        return inner(context);
      };
    sub->callback([this, action = std::move(action)] { chosen = action; });
  }

  const VerbRegistry* registry_;
  VerbContext* context_;
};

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

/// The menu or verb that the words lead to, and the first word that is none.
struct WordsEnd {
  const CLI::App* app = nullptr;
  std::string parent;  ///< "ecs utility", without the app's own name
  std::string path = "ecs";
  std::string stray;
};

WordsEnd end_of(const CLI::App& root, const std::vector<std::string>& words) {
  WordsEnd end;
  end.app = &root;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i] == "--link") ++i;
    if (i >= words.size() || words[i].starts_with("-")) continue;
    const auto subs = end.app->get_subcommands([&](const CLI::App* sub) { return sub->get_name() == words[i]; });
    if (subs.empty()) {
      if (!names_of_verbs(*end.app).empty()) end.stray = words[i];
      break;
    }
    end.app = subs.front();
    end.parent = end.path;
    end.path += " " + words[i];
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

std::string usage_text(const CLI::App& root, const std::vector<std::string>& words, const std::string& what) {
  const WordsEnd end = end_of(root, words);
  const auto verbs = names_of_verbs(*end.app);
  if (!end.stray.empty())
    return fmt::format("`{}` has no verb \"{}\"{} It has: {}", end.path, end.stray,
                       did_you_mean(end.stray, verbs).empty() ? "." : did_you_mean(end.stray, verbs),
                       fmt::join(verbs, ", "));
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
    example = example || line.starts_with("Example:");
    const std::size_t indent = line.starts_with("  ") ? kHelpColumn : 0;
    while (line.size() > kWide && !example) {
      const std::size_t cut = line.rfind(' ', kWide);
      if (cut == std::string_view::npos || line.find_first_not_of(' ') > cut) break;
      out += std::string(line.substr(0, cut)) + "\n" + std::string(indent, ' ');
      line.remove_prefix(cut + 1);
      if (line.size() + indent <= kWide) break;
    }
    out += std::string(line) + "\n";
  }
  return out;
}

}  // namespace

Request parsed(const VerbRegistry& registry, const std::vector<std::string>& words, VerbContext& context) {
  Tree tree(registry, context);
  try {
    tree.root.parse(std::vector<std::string>(words.rbegin(), words.rend()));
  } catch (const CLI::CallForHelp&) {
    const WordsEnd end = end_of(tree.root, words);
    return {Request::Kind::help, {}, wrapped_help(end.app->help(end.parent))};
  } catch (const CLI::CallForVersion&) {
    return {Request::Kind::version, {}, {}};
  } catch (const CLI::ParseError& error) {
    return {Request::Kind::wrong, {}, usage_text(tree.root, words, error.what())};
  }
  if (tree.chosen) return {Request::Kind::run, std::move(tree.chosen), {}};
  const WordsEnd end = end_of(tree.root, words);
  if (end.app != &tree.root) return {Request::Kind::wrong, {}, menu_text(end)};
  return {Request::Kind::overview, {}, {}};
}

}  // namespace ecs::app
