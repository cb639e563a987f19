#include "app/cli/program.hpp"

#include <algorithm>
#include <csignal>
#include <cstring>
#include <exception>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "app/cli/menus.hpp"
#include "app/cli/overview.hpp"
#include "base/interrupt.hpp"
#include "base/json.hpp"
#include "base/text.hpp"
#include "base/version.hpp"

namespace ecs::app {
namespace {

Json with_link(Json object, const VerbContext& context) {
  if (!context.link_name.empty() && !object.contains("link")) object["link"] = context.link_name;
  return object;
}

int failed(VerbContext& context, const Problem& problem) {
  context.console.end_progress();
  if (context.console.json) {
    Json object{{"error", json_of(problem)}};
    object["error"]["message"] = context.console.message_prefix + problem.message;
    context.console.print_json(one_line(with_link(std::move(object), context)));
  } else {
    context.console.show(problem);
  }
  return exit_code_of(problem.kind);
}

int answered(VerbContext& context, const Outcome& outcome) {
  std::string object = outcome.json;
  if (context.console.json && !object.empty() && !context.link_name.empty())
    object = one_line(with_link(Json::parse(object), context));
  context.console.answer(outcome.text, object);
  if (!context.console.output_is_whole())
    return failed(
        context,
        {ProblemKind::output, "stdout could not be written: the disc is full, or the pipe is closed", {}, 0, 0, {}});
  return outcome.exit_code;
}

int with_signal(int exit_code) {
  const int signal = interrupting_signal();
  return signal == 0 ? exit_code : 128 + signal;
}

/// What was under way says what it left behind.
Problem stopped_by_signal(Problem under_way) {
  under_way.message = fmt::format("stopped by signal {} ({}): {}", interrupting_signal(),
                                  ::strsignal(interrupting_signal()), under_way.message);
  return under_way;
}

int run_action(VerbContext& context, const Action& action) {
  const Result<Outcome> result = action(context);
  if (result) return with_signal(answered(context, *result));
  if (interrupting_signal() != 0) return with_signal(failed(context, stopped_by_signal(result.error())));
  return failed(context, result.error());
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

/// The menu or verb that the words lead to, and the first word that leads nowhere.
struct Place {
  const CLI::App* app = nullptr;
  std::string parent;  ///< "ecs utility", without the app's own name
  std::string path = "ecs";
  std::string stray;
};

Place place_of(const CLI::App& root, const std::vector<std::string>& words) {
  Place place;
  place.app = &root;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i] == "--link") ++i;
    if (i >= words.size() || words[i].starts_with("-")) continue;
    const auto subs = place.app->get_subcommands([&](const CLI::App* sub) { return sub->get_name() == words[i]; });
    if (subs.empty()) {
      if (!names_of_verbs(*place.app).empty()) place.stray = words[i];
      break;
    }
    place.app = subs.front();
    place.parent = place.path;
    place.path += " " + words[i];
  }
  return place;
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
    return fmt::format("{} needs {} behind it: {}", word, kind.empty() ? "a value" : "a value (" + kind + ")",
                       option->get_description());
  }
  return {};
}

std::string usage_text(const CLI::App& root, const std::vector<std::string>& words, const std::string& what) {
  const Place place = place_of(root, words);
  const auto verbs = names_of_verbs(*place.app);
  if (!place.stray.empty())
    return fmt::format("`{}` has no verb \"{}\"{} It has: {}", place.path, place.stray,
                       did_you_mean(place.stray, verbs).empty() ? "." : did_you_mean(place.stray, verbs),
                       fmt::join(verbs, ", "));
  if (const std::string lacks = lacking_value(*place.app, words, what); !lacks.empty())
    return fmt::format("{}: {} (see `{} --help`)", place.path, lacks, place.path);
  const std::vector<std::string> options = names_of_options(*place.app);
  std::string hint;
  for (const std::string& word : words)
    if (word.starts_with("--") && what.find(word) != std::string::npos && hint.empty() && !contains(options, word))
      hint = did_you_mean(word, options);
  return fmt::format("{}: {}{} (see `{} --help`)", place.path, what, hint, place.path);
}

std::string menu_text(const Place& place) {
  return fmt::format("`{}` needs a verb: {} (see `{} --help`)", place.path, fmt::join(names_of_verbs(*place.app), ", "),
                     place.path);
}

/// Lines of at most 80 columns; what is said of an option goes on under its beginning. Examples stay in one piece.
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

int show_text(VerbContext& context, const std::string& key, const std::string& text) {
  return answered(context, {text, one_line(Json{{key, text}}), kDone});
}

int parsed_and_run(const std::vector<std::string>& words, VerbContext& context) {
  CLI::App root("ECS: parameters, error maps and tests of an error compensation system for machine tools", "ecs");
  Action chosen;
  CommonOptions common;
  root.add_flag("--json", common.json, "the answer as one JSON object on stdout");
  root.add_flag("--quiet", common.quiet, "no notes and no progress bar");
  root.add_option("--link", common.link, "rtu:/dev/ttyUSB0:115200, tcp:host:port, emulator[:machine.toml]")
      ->type_name("");
  root.set_version_flag("--version", kVersion);
  root.require_subcommand(0, 1);
  Menu menu(root, common, chosen);
  add_all_menus(menu);
  try {
    root.parse(std::vector<std::string>(words.rbegin(), words.rend()));
  } catch (const CLI::CallForHelp&) {
    const Place place = place_of(root, words);
    return show_text(context, "help", wrapped_help(place.app->help(place.parent)));
  } catch (const CLI::CallForVersion&) {
    return show_text(context, "version", kVersion);
  } catch (const CLI::ParseError& error) {
    return failed(context, {ProblemKind::usage, usage_text(root, words, error.what()), {}, 0, 0, {}});
  }
  context.console.json = context.console.json || common.json;
  context.console.quiet = common.quiet;
  context.link_option = common.link;
  if (chosen) return run_action(context, chosen);
  const Place place = place_of(root, words);
  if (place.app != &root) return failed(context, {ProblemKind::usage, menu_text(place), {}, 0, 0, {}});
  return run_action(context, [&root](VerbContext& s) { return overview(root, s); });
}

}  // namespace

int run_program(const std::vector<std::string>& words, std::ostream& out, std::ostream& messages,
                ConsoleOptions options) {
  Console console(out, messages, options);
  console.json = std::find(words.begin(), words.end(), "--json") != words.end();
  VerbContext context{console, {}, {}};
  try {
    return parsed_and_run(words, context);
  } catch (const std::exception& error) {
    return failed(context, {ProblemKind::output, fmt::format("internal failure: {}", error.what()), {}, 0, 0, {}});
  }
}

}  // namespace ecs::app
