#include "app/cli/program.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <csignal>
#include <cstring>
#include <exception>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include "app/cli/verb_unit.hpp"
#include "base/json.hpp"
#include "base/process.hpp"
#include "base/version.hpp"
#include "commissioning/link/choice.hpp"

namespace ecs::app {
namespace {

/// What every menu and verb takes.
cli::Shared shared_by_all(VerbContext& context) {
  return {{{"--json", &context.console.json, "print the answer as JSON, for other programs"},
           {"--quiet", &context.console.quiet, "suppress notes and the progress bar"}},
          &context.link_option,
          &context.arm_code};
}

/// With the present name of an option of `ecs unit arm`, whose earlier name stays accepted.
std::vector<std::string> with_present_names(std::vector<std::string> words) {
  constexpr std::string_view kEarlier = "--code", kPresent = "--arm-code";
  const std::array<std::string_view, 2> arms{"unit", "arm"};
  if (std::search(words.begin(), words.end(), arms.begin(), arms.end()) == words.end()) return words;
  for (std::string& word : words)
    if (word == kEarlier || word.starts_with(std::string(kEarlier) + "=")) word.replace(0, kEarlier.size(), kPresent);
  return words;
}

}  // namespace

ParsedWords parsed(const Registry& registry, const std::vector<std::string>& words, VerbContext& context) {
  const cli::Shared shared = shared_by_all(context);
  std::vector<MenuDefinition> menus = registry.menus;
  for (MenuDefinition& menu : menus) menu.arguments = shared.always;
  cli::CommandTree tree("ecs", {{}, kProgramHelp, cli::with_shared({}, shared, Link::reads)}, menus);
  ParsedWords answer;
  for (const Action* action : registry.actions) {
    auto [arguments, run] = action->bound(shared);
    tree.add_verb(action->path, action->help, action->example, arguments, [&answer, action, run = std::move(run)] {
      answer.action = action;
      answer.run = run;
    });
  }
  answer.request = tree.parsed(with_present_names(words));
  return answer;
}

cli::ShownProgram shown_program(const Registry& registry, VerbContext& context) {
  return cli::shown_program("ecs", kProgramHelp, registry, shared_by_all(context));
}

namespace {

/// One line per verb, under the help of its menu; a verb outside any menu has its own paragraph.
void add_verbs(const Registry& registry, std::string& text, Json& verbs) {
  std::string menu;
  for (const Action* verb : registry.actions) {
    const std::string first = verb->words().front();
    if (first != menu)
      text += registry.menu_help(first).empty() ? "\n" : fmt::format("\n{}\n", registry.menu_help(first));
    menu = first;
    text += fmt::format("  {:<26} {}\n", verb->path, verb->help);
    verbs.push_back({{"verb", verb->path}, {"help", verb->help}});
  }
}

std::string state_of_link(const Result<LinkChoice>& choice) {
  if (!choice) return to_text(choice.error());
  const std::string name = to_text(*choice);
  if (choice->origin == "default") return name + " (used because no link is stored and none was given with --link)";
  return fmt::format("{} ({})", name,
                     choice->origin == "--link" ? "given" : "stored in " + configuration_file().string());
}

/// The tree alone: its menus with one line per verb.
std::string verbs_overview(const Registry& registry) {
  std::string text;
  Json verbs = Json::array();
  add_verbs(registry, text, verbs);
  return text;
}

/// The tree of menus with one line per verb, and which link would be used. Opens nothing.
Result<Outcome> overview(const Registry& registry, VerbContext& context) {
  const auto choice = chosen_link(context.link_option);
  std::string text = std::string(kProgramHelp) + "\n";
  Json verbs = Json::array();
  add_verbs(registry, text, verbs);
  text +=
      fmt::format("\nLink: {}\n`ecs VERB --help` explains a verb; `ecs doctor` finds out why a link does not work.\n",
                  state_of_link(choice));
  const Json link = choice ? Json(to_text(*choice)) : Json(nullptr);
  return Outcome{text, one_line(Json{{"verbs", verbs}, {"link", link}}), kDone};
}

Json with_link(Json object, const VerbContext& context) {
  if (!context.link_name.empty() && !object.contains("link")) object["link"] = context.link_name;
  return object;
}

int failed(VerbContext& context, const Problem& problem) {
  context.console.end_progress();
  if (context.console.json) {
    Json object{{"error", problem_json(problem)}};
    object["error"]["message"] = context.console.message_prefix + problem.message;
    context.console.print_json(one_line(with_link(std::move(object), context)));
  } else {
    context.console.show(problem);
  }
  return exit_code_of(problem.kind);
}

/// Whoever read stdout through a pipe has closed it, as `head` does.
bool reader_left() {
  pollfd answers{STDOUT_FILENO, POLLOUT, 0};
  return ::poll(&answers, 1, 0) > 0 && (answers.revents & POLLERR) != 0;
}

int answered(VerbContext& context, const Outcome& outcome) {
  std::string object = outcome.json;
  if (context.console.json && !object.empty() && !context.link_name.empty())
    object = one_line(with_link(Json::parse(object), context));
  context.console.answer(outcome.text, object);
  if (!context.console.output_is_whole()) {
    if (reader_left()) return 128 + SIGPIPE;  // it has read enough
    return failed(
        context,
        {ProblemKind::output, "stdout could not be written: the disc is full, or the pipe is closed", {}, 0, 0, {}});
  }
  return outcome.exit_code;
}

int with_signal(int exit_code) {
  const int signal = interrupting_signal();
  return signal == 0 ? exit_code : 128 + signal;
}

/// The message of the interrupted work says what it left behind.
Problem stopped_by_signal(Problem under_way) {
  under_way.message = fmt::format("stopped by signal {} ({}): {}", interrupting_signal(),
                                  ::strsignal(interrupting_signal()), under_way.message);
  return under_way;
}

int ended(VerbContext& context, const Result<Outcome>& result) {
  if (result && result->finished) return answered(context, *result);
  if (result) return with_signal(answered(context, *result));
  if (interrupting_signal() != 0) return with_signal(failed(context, stopped_by_signal(result.error())));
  return failed(context, result.error());
}

int run_action(VerbContext& context, const Action& action, const Action::Run& run, const AroundVerb& around) {
  context.link = action.is.link;
  if (context.link == Link::writes) announce_writing(context);
  return ended(context, around ? around(context, action, run) : run(context));
}

int show_text(VerbContext& context, const std::string& key, const std::string& text) {
  return answered(context, {text, one_line(Json{{key, text}}), kDone});
}

/// No verb and no menu is named.
bool asks_for_program(const std::vector<std::string>& words) {
  return std::all_of(words.begin(), words.end(), [](const std::string& word) { return word.starts_with("-"); });
}

/// How the program is called and its options from the help of the command line, then every verb.
std::string whole_help(const Registry& registry, const std::string& help) {
  const std::size_t usage = std::min(help.find("Usage:"), help.size());
  const std::size_t menus = std::min(help.find("\nSubcommands:"), help.size());
  return fmt::format(
      "{}\n\n{}\n`ecs` without arguments opens the screens. `ecs FILE...` opens files in the screens: a model with "
      "its\nmeasurements, an error map, parameters, a dump. `ecs --linear` works line by line, for screen readers "
      "and\nteletypes. `ecs VERB --help` explains a verb.\n{}",
      kProgramHelp, help.substr(usage, menus - usage), verbs_overview(registry));
}

int parsed_and_run(const Registry& registry, const std::vector<std::string>& words, VerbContext& context,
                   const AroundVerb& around) {
  using Kind = cli::Request::Kind;
  const auto [request, action, run] = parsed(registry, words, context);
  switch (request.kind) {
    case Kind::run:
      return run_action(context, *action, run, around);
    case Kind::help:
      return show_text(context, "help", asks_for_program(words) ? whole_help(registry, request.text) : request.text);
    case Kind::version:
      return show_text(context, "version", program_version_and_commit());
    case Kind::no_words:
      return ended(context, overview(registry, context));
    case Kind::wrong:
      break;
  }
  return failed(context, {ProblemKind::usage, request.text, {}, 0, 0, {}});
}

/// Of the program: it has one.
std::atomic<const Registry*>& registry_in_use() {
  static std::atomic<const Registry*> registry{nullptr};
  return registry;
}

}  // namespace

int run_same_program(const std::vector<std::string>& words, std::ostream& out, std::ostream& messages) {
  const Registry* registry = registry_in_use();
  assert(registry != nullptr);
  return run_command_line(*registry, words, out, messages);
}

int run_command_line(const Registry& registry, const std::vector<std::string>& words, std::ostream& out,
                     std::ostream& messages, ConsoleOptions options, const AroundVerb& around) {
  Console console(out, messages, std::move(options));
  console.json = std::find(words.begin(), words.end(), "--json") != words.end();
  VerbContext context{console};
  registry_in_use() = &registry;
  try {
    return parsed_and_run(registry, words, context, around);
  } catch (const std::exception& error) {
    return failed(context, {ProblemKind::output, fmt::format("internal failure: {}", error.what()), {}, 0, 0, {}});
  }
}

}  // namespace ecs::app
