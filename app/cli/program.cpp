#include "app/cli/program.hpp"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <csignal>
#include <cstring>
#include <exception>
#include <utility>

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include "app/cli/around_verb.hpp"
#include "app/cli/overview.hpp"
#include "app/cli/parser.hpp"
#include "base/interrupt.hpp"
#include "base/json.hpp"
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

int run_action(VerbContext& context, const Action& action, const AroundVerb& around) {
  const Result<Outcome> result = around ? around(context, action) : action(context);
  if (result && result->finished) return answered(context, *result);
  if (result) return with_signal(answered(context, *result));
  if (interrupting_signal() != 0) return with_signal(failed(context, stopped_by_signal(result.error())));
  return failed(context, result.error());
}

int show_text(VerbContext& context, const std::string& key, const std::string& text) {
  return answered(context, {text, one_line(Json{{key, text}}), kDone});
}

/// No verb and no menu is named.
bool asks_for_program(const std::vector<std::string>& words) {
  return std::all_of(words.begin(), words.end(), [](const std::string& word) { return word.starts_with("-"); });
}

/// How the program is called and its options from the help of the command line, then every verb.
std::string whole_help(const VerbRegistry& registry, const std::string& help) {
  const std::size_t usage = std::min(help.find("Usage:"), help.size());
  const std::size_t menus = std::min(help.find("\nSubcommands:"), help.size());
  return fmt::format(
      "{}\n\n{}\n`ecs` alone opens the screens; `ecs FILE...` opens the files there: a model with its measurements, "
      "an\n"
      "error map, parameters, a dump; `ecs --linear` asks line by line, for screen readers and teletypes. `ecs VERB\n"
      "--help` explains a verb.\n{}",
      kProgramHelp, help.substr(usage, menus - usage), verbs_overview(registry));
}

int parsed_and_run(const VerbRegistry& registry, const std::vector<std::string>& words, VerbContext& context,
                   const AroundVerb& around) {
  using Kind = cli::Request::Kind;
  const auto [request, action] = parsed(registry, words, context);
  switch (request.kind) {
    case Kind::run:
      return run_action(context, action, around);
    case Kind::help:
      return show_text(context, "help", asks_for_program(words) ? whole_help(registry, request.text) : request.text);
    case Kind::version:
      return show_text(context, "version", program_version_and_commit());
    case Kind::no_words:
      return run_action(context, [&registry](VerbContext& c) { return overview(registry, c); }, {});
    case Kind::wrong:
      break;
  }
  return failed(context, {ProblemKind::usage, request.text, {}, 0, 0, {}});
}

/// Of the program: it has one.
std::atomic<const VerbRegistry*>& registry_in_use() {
  static std::atomic<const VerbRegistry*> registry{nullptr};
  return registry;
}

}  // namespace

int run_command_line(const VerbRegistry& registry, const std::vector<std::string>& words, std::ostream& out,
                     std::ostream& messages, ConsoleOptions options) {
  return run_command_line(registry, words, out, messages, std::move(options), {});
}

int run_same_program(const std::vector<std::string>& words, std::ostream& out, std::ostream& messages) {
  const VerbRegistry* registry = registry_in_use();
  assert(registry != nullptr);
  return run_command_line(*registry, words, out, messages);
}

int run_command_line(const VerbRegistry& registry, const std::vector<std::string>& words, std::ostream& out,
                     std::ostream& messages, ConsoleOptions options, const AroundVerb& around) {
  Console console(out, messages, std::move(options));
  console.json = std::find(words.begin(), words.end(), "--json") != words.end();
  VerbContext context{console, {}, {}, {}};
  registry_in_use() = &registry;
  try {
    return parsed_and_run(registry, words, context, around);
  } catch (const std::exception& error) {
    return failed(context, {ProblemKind::output, fmt::format("internal failure: {}", error.what()), {}, 0, 0, {}});
  }
}

}  // namespace ecs::app
