// What the module brings: a logbook of what is done, verbs and a screen that read it, certificates. One hook round all
// verbs writes what they do into the logbook of the machine: which makes which kind of entry says its definition.
// Does not live here: the logbook (store.hpp), transfers to units, which it sees whoever sends.

#include "app/cli/module.hpp"

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/cli/program.hpp"
#include "app/ui/screen.hpp"
#include "base/file_watch.hpp"
#include "base/json.hpp"
#include "base/text.hpp"
#include "modules/logbook/recorder.hpp"

namespace ecs::app {
namespace {

constexpr std::size_t kMostAnswer = 1u << 20;  // bytes of an answer that an entry keeps
constexpr std::size_t kMostSummary = 160;

/// The words without those that are secret or only change how the answer is shown.
std::vector<std::string> kept_words(const Action& action, const std::vector<std::string>& words) {
  std::vector<std::string> kept;
  std::string link, arm_code;
  const cli::Arguments arguments = action.bound({{}, &link, &arm_code}).arguments;
  const auto is_secret = [&](std::string_view name) {
    return std::any_of(arguments.begin(), arguments.end(),
                       [&](const cli::Argument& one) { return one.is_secret && one.name == name; });
  };
  for (std::size_t k = 0; k < words.size(); ++k) {
    if (words[k] == "--json" || words[k] == "--quiet") continue;
    const std::size_t equals = words[k].find('=');
    if (!is_secret(words[k].substr(0, equals)))
      kept.push_back(words[k]);
    else if (equals == std::string::npos)
      ++k;
  }
  return kept;
}

/// The sentence in which an answer says it all; else its first line, unless that is the head of a table.
std::string summary_of(const Json& answer, const std::string& text) {
  for (const char* key : {"headline", "verdict"})
    if (const auto found = answer.is_object() ? answer.find(key) : answer.end();
        answer.is_object() && found != answer.end() && found->is_string())
      return found->get<std::string>();
  for (const std::string_view line : lines_of(text))
    if (const std::string_view words = trimmed(line); !words.empty())
      return words.find("  ") == std::string_view::npos ? std::string(words.substr(0, kMostSummary)) : std::string();
  return {};
}

LogRecord record_of(const Action& action, const std::vector<std::string>& words, const Outcome& outcome,
                    const ObservedFiles& seen) {
  const Json answer = Json::parse(outcome.json, nullptr, false);
  const std::string name = *action.is.logged_as != '\0' ? action.is.logged_as : action.path;
  std::error_code error;
  Json content{{"verb", name},
               {"words", kept_words(action, words)},
               {"folder", std::filesystem::current_path(error).string()},
               {"exit_code", outcome.exit_code}};
  if (answer.is_object() && outcome.json.size() <= kMostAnswer) content["answer"] = answer;
  std::string written;
  for (const SeenFile& file : seen.outputs())
    written += (written.empty() ? "" : " ") + std::filesystem::path(file.name).filename().string();
  const std::string summary = summary_of(answer, outcome.text);
  return {.kind = action.is.kind,
          .summary = fmt::format("{}: {}{}{}", name, written, written.empty() || summary.empty() ? "" : "; ", summary),
          .content = one_line(content)};
}

void say_logbook_words(Console& console) {
  for (const LogbookWord& word : logbook_words()) word.warning ? console.warn(word.text) : console.note(word.text);
}

/// Runs the verb of these words, sees the files that it reads and writes, and adds an entry if it was of use. Says what
/// there is to say of the logbook. Nothing is added where this process keeps none.
AroundVerb logged_verb(const std::vector<std::string>& words) {
  const FileWatch* watch = FileWatch::current();  // a verb done again from the logbook is not logged
  if (!records_are_kept() || (watch != nullptr && watch->replaces_disc())) return {};
  return [words](VerbContext& context, const Action& action, const Action::Run& run) {
    const ObservedFiles seen;
    Result<Outcome> result = run(context);
    const Logged logged = action.is.logged;
    if (result && (logged == Logged::always || (logged == Logged::when_written && !seen.outputs().empty())))
      record(record_of(action, words, *result, seen));
    close_logbooks();
    say_logbook_words(context.console);
    return result;
  };
}

}  // namespace

extern const std::vector<Action> kLogReading, kLogExporting, kLogVerification;
std::unique_ptr<Screen> logbook_screen();

const Module& logbook_module() {
  static const Module module{
      .menus = {{"log", "LOGBOOK: what was done at a machine, each entry tied to the one before"}},
      .verbs = {{"volume", &kLogReading}, {"volume", &kLogExporting}, {"volume", &kLogVerification}},
      .screens = {{"LOGBOOK", "what was done at a machine; verify, replay",
                   [](const auto&) { return logbook_screen(); }}},
      .synonyms = {{"LOGBOOK", "history entries certificate audit traceability who when wear"},
                   {"log compare", "wear worn year drift history"},
                   {"log export", "certificate calibration dcc audit"}},
      .begin = [] { commissioning::keep_logbook(); },
      .around = logged_verb};
  return module;
}

}  // namespace ecs::app
