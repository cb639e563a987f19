#include "app/verbs/logged.hpp"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "base/file_watch.hpp"
#include "base/json.hpp"
#include "base/text.hpp"
#include "commissioning/logbook/observed.hpp"
#include "commissioning/logbook/recorder.hpp"

namespace ecs::app {
namespace {

/// When a run of the verb is worth an entry.
enum class Logged {
  when_written,  ///< it wrote a file: what it shows alone changes nothing
  always,        ///< what it found is the result
};

struct LoggedVerb {
  const char* path;
  const char* kind;
  Logged when;
};
constexpr LoggedVerb kLoggedVerbs[] = {
    {"laser import", "measurement", Logged::when_written},
    {"laser capture", "measurement", Logged::when_written},
    {"laser prepare", "processing", Logged::when_written},
    {"laser process", "processing", Logged::when_written},
    {"laser normalise", "processing", Logged::when_written},
    {"test circle", "test", Logged::always},
    {"test diagonals", "test", Logged::always},
    {"test drift", "test", Logged::always},
    {"test flatness", "test", Logged::always},
    {"test warm-up", "test", Logged::always},
    {"map build", "map", Logged::when_written},
    {"map receive", "transfer", Logged::when_written},
    {"params new", "parameters", Logged::when_written},
    {"params set", "parameters", Logged::when_written},
    {"params receive", "transfer", Logged::when_written},
    {"memory dump", "transfer", Logged::when_written},
    {"model new", "model", Logged::when_written},
    {"model fit", "model", Logged::when_written},
    {"model add", "model", Logged::when_written},
    {"model undo", "model", Logged::when_written},
    {"model remove", "model", Logged::when_written},
    {"model decide", "model", Logged::when_written},
    {"model diagnose", "diagnosis", Logged::always},
    {"model investigate", "investigation", Logged::always},
    {"export", "export", Logged::when_written},
    {"report", "report", Logged::when_written},
};
constexpr std::size_t kMostAnswer = 1u << 20;  // bytes of an answer that an entry keeps
constexpr std::size_t kMostSummary = 160;

const LoggedVerb* logged_as(const std::vector<std::string>& words) {
  for (const LoggedVerb& verb : kLoggedVerbs) {
    const auto path = cli::words_of(verb.path);
    if (words.size() >= path.size() && std::equal(path.begin(), path.end(), words.begin())) return &verb;
  }
  return nullptr;
}

/// The words without those that are secret or only change how the answer is shown.
std::vector<std::string> kept_words(const std::vector<std::string>& words) {
  std::vector<std::string> kept;
  for (std::size_t k = 0; k < words.size(); ++k) {
    if (words[k] == "--json" || words[k] == "--quiet" || words[k].starts_with("--arm-code=")) continue;
    if (words[k] == "--arm-code") {
      ++k;
      continue;
    }
    kept.push_back(words[k]);
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

LogRecord record_of(const LoggedVerb& verb, const std::vector<std::string>& words, const Outcome& outcome,
                    const ObservedFiles& seen) {
  const Json answer = Json::parse(outcome.json, nullptr, false);
  std::error_code error;
  Json content{{"verb", verb.path},
               {"words", kept_words(words)},
               {"folder", std::filesystem::current_path(error).string()},
               {"exit_code", outcome.exit_code}};
  if (answer.is_object() && outcome.json.size() <= kMostAnswer) content["answer"] = answer;
  std::string written;
  for (const SeenFile& file : seen.outputs())
    written += (written.empty() ? "" : " ") + std::filesystem::path(file.name).filename().string();
  const std::string summary = summary_of(answer, outcome.text);
  LogRecord record;
  record.kind = verb.kind;
  record.summary =
      fmt::format("{}: {}{}{}", verb.path, written, written.empty() || summary.empty() ? "" : "; ", summary);
  record.content = one_line(content);
  return record;
}

void say_logbook_words(Console& console) {
  for (const LogbookWord& word : logbook_words()) word.warning ? console.warn(word.text) : console.note(word.text);
}

}  // namespace

AroundVerb logged_verb(const std::vector<std::string>& words) {
  const FileWatch* watch = FileWatch::current();  // a verb done again from the logbook is not logged
  if (!logbook_is_kept() || (watch != nullptr && watch->replaces_disc())) return {};
  return [words](VerbContext& context, const Action& action) {
    const ObservedFiles seen;
    Result<Outcome> result = action(context);
    const LoggedVerb* verb = logged_as(words);
    if (result && verb != nullptr && (verb->when == Logged::always || !seen.outputs().empty()))
      record(record_of(*verb, words, *result, seen));
    close_logbooks();
    say_logbook_words(context.console);
    return result;
  };
}

}  // namespace ecs::app
