// What the module brings: a logbook of what is done, verbs and a screen that read it, certificates. The screen LOGBOOK:
// what was done at a machine, one entry whole, verified and replayed. One hook round all verbs writes what they do into
// the logbook of the machine: which makes which kind of entry says its definition.
// Does not live here: the logbook (store.hpp), transfers to units, which it sees whoever sends.

#include "app/cli/module.hpp"

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/cli/program.hpp"
#include "app/screens/unit/list_screen.hpp"
#include "app/ui/screen.hpp"
#include "app/verbs/registry.hpp"
#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "base/file_kind.hpp"
#include "base/json.hpp"
#include "base/outcome.hpp"
#include "base/text.hpp"
#include "commissioning/session/task_runner.hpp"
#include "modules/logbook/place.hpp"
#include "modules/logbook/recorder.hpp"
#include "modules/logbook/replay.hpp"

namespace ecs::app {
namespace {

std::filesystem::file_time_type time_of(const std::string& path) {
  std::error_code error;
  const auto time = std::filesystem::last_write_time(path, error);
  return error ? std::filesystem::file_time_type{} : time;
}

class LogbookScreen final : public ListScreen {
 public:
  LogbookScreen() {
    keys_ = {{"Enter", "full entry", [this] { show_entry(); }},
             {"v", "verify", [this] { run("checking every entry", "verify"); }},
             {"r", "derive map again", [this] { run("deriving the active map again", "replay"); }},
             {"Tab", "next logbook", [this] { open_next(); }}};
    look();
  }

  [[nodiscard]] std::string title() const override { return "LOGBOOK"; }
  [[nodiscard]] std::string help() const override {
    return "The actions of verbs and screens on a machine, recorded automatically: measurements, maps, parameters, "
           "transfers, diagnoses, reports. Each entry contains its files and the hash of the previous entry. Press v "
           "to check every entry; the first changed entry is shown. Press r to derive the active map again from the "
           "raw readings and compare it bit for bit. `ecs log` does the same, compares two days and writes a "
           "calibration certificate (modules/logbook/README.md). ECS_LOGBOOK=off disables the logbook.";
  }
  [[nodiscard]] bool advance() override {
    const auto words = logbook_words();
    for (const LogbookWord& word : words) say(word.text, word.warning ? Tone::warning : Tone::good);
    if (task_.advance() || !words.empty()) return true;
    if (books_.empty() || task_.running() || time_of(book()) == seen_) return false;
    read();
    return true;
  }

 protected:
  [[nodiscard]] std::vector<ListRow> rows() const override {
    std::vector<ListRow> rows;
    for (const LogbookEntry& entry : entries_) {
      std::string time = entry.time.substr(0, 16);
      std::replace(time.begin(), time.end(), 'T', ' ');
      rows.push_back({fmt::format("{:>6} {:<16} {:<18} {}", entry.number, time, entry.kind, entry.summary)});
    }
    return rows;
  }
  [[nodiscard]] std::string heading() const override {
    if (entries_.empty()) return "logbook";
    return fmt::format("{}: {} entries{}", owner_, entries_.size(),
                       books_.size() > 1 ? fmt::format(" ({} logbooks, Tab shows the next)", books_.size()) : "");
  }
  [[nodiscard]] std::string below_heading() const override { return book(); }
  [[nodiscard]] std::string while_empty() const override { return absent_.empty() ? "It contains no entry." : absent_; }
  [[nodiscard]] std::string whole(std::size_t row) const override {
    const auto open = Logbook::open_to_read(book());
    const auto entry = open ? open->entry(entries_[row].number) : tl::unexpected(open.error());
    return entry ? whole_entry_cell(*entry, entries_[row].summary).text : to_text(entry.error());
  }
  [[nodiscard]] bool shows_whole_below() const override { return false; }

 private:
  struct Ran {
    std::string text;
    int exit_code = 0;
  };
  [[nodiscard]] std::string book() const { return books_.empty() ? "" : books_[at_].string(); }

  void look() {
    const auto setting = logbook_setting();
    if (!setting) {
      absent_ = to_text(setting.error());
      return;
    }
    books_ = logbooks(*setting);
    if (books_.empty())
      absent_ = setting->off ? "No logbook is kept: ECS_LOGBOOK or the setting is off."
                             : "No logbook yet. One is started when verbs or screens work on a machine.";
    read();
  }

  void read() {
    entries_.clear();
    owner_.clear();
    if (books_.empty()) return;
    seen_ = time_of(book());
    const auto open = Logbook::open_to_read(book());
    auto entries = open ? open->entries(true) : tl::unexpected(open.error());
    const auto owner = open ? open->owner() : tl::unexpected(open.error());
    absent_ = entries ? "" : to_text(entries.error());
    if (entries) entries_ = std::move(*entries);
    name_users_of_inputs(entries_);
    if (owner) owner_ = in_words(*owner);
    follow();
  }

  void open_next() {
    if (books_.size() < 2) return;
    at_ = (at_ + 1) % books_.size();
    following_ = true;
    read();
  }

  void show_entry() {
    if (!entries_.empty()) show(whole(marked()));
  }

  /// `ecs log VERB` on this logbook, beside the screen; more than a line of it is shown as a page.
  void run(const std::string& doing, const std::string& verb) {
    if (task_.running() || books_.empty()) return;
    say(doing + " ...", Tone::warning);
    const auto work = [words = std::vector<std::string>{"log", verb, "--log", book()}](JobControl&) {
      std::ostringstream out, messages;
      const int code = run_program(words, out, messages);
      return Ran{std::string(trimmed(messages.str() + out.str())), code};
    };
    task_.start(doing, work, [this](const Ran& ran) {
      const std::string first = ran.text.substr(0, ran.text.find('\n'));
      say(first, ran.exit_code == kDone ? Tone::good : Tone::bad);
      if (first != ran.text) show(ran.text);
    });
  }

  std::vector<std::filesystem::path> books_;
  std::size_t at_ = 0;
  std::string owner_, absent_;
  std::vector<LogbookEntry> entries_;
  std::filesystem::file_time_type seen_{};
  TaskRunner task_;
};

}  // namespace

std::unique_ptr<Screen> logbook_screen() { return std::make_unique<LogbookScreen>(); }

namespace {

constexpr std::size_t kMostAnswer = 1u << 20;  // bytes of an answer that an entry keeps
constexpr std::size_t kMostSummary = 160;

/// The words without those that are secret or only change how the answer is shown.
std::vector<std::string> kept_words(const Action& action, const std::vector<std::string>& words) {
  std::vector<std::string> kept;
  std::string link, arm_code;
  const Action::Bound bound = action.bound({{}, &link, &arm_code});
  const auto is_secret = [&](std::string_view name) {
    return std::any_of(bound.arguments.begin(), bound.arguments.end(),
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

/// The first line of an answer with those into which it was wrapped.
std::string first_words(std::string_view text) {
  std::string words;
  std::size_t last_line = 0;
  for (const std::string_view line : lines_of(text)) {
    const std::string_view said = trimmed(line);
    const std::size_t next_word = ecs::columns_of(said.substr(0, said.find(' ')));
    const bool is_table = said.find("  ") != std::string_view::npos;
    const bool was_wrapped = last_line + 1 + next_word > kTerminalColumns;
    if (!words.empty() && (said.empty() || is_table || !was_wrapped)) break;
    if (said.empty()) continue;
    words += (words.empty() ? "" : " ") + std::string(said);
    last_line = ecs::columns_of(line);
  }
  return words;
}

/// At most `bytes`, up to the end of a word.
std::string shortened(std::string text, std::size_t bytes) {
  constexpr std::string_view kMore = " ...";
  if (text.size() <= bytes) return text;
  const std::size_t end = text.rfind(' ', bytes - kMore.size());
  text.resize(end == std::string::npos ? bytes - kMore.size() : end);
  return text + std::string(kMore);
}

/// The sentence in which an answer says it all; else its first words, unless they are the head of a table.
std::string summary_of(const Json& answer, const std::string& text) {
  for (const char* key : {"headline", "verdict"})
    if (const auto found = answer.is_object() ? answer.find(key) : answer.end();
        answer.is_object() && found != answer.end() && found->is_string())
      return found->get<std::string>();
  const std::string words = first_words(text);
  return words.find("  ") == std::string::npos ? shortened(words, kMostSummary) : std::string();
}

LogRecord record_of(const Action& action, const std::vector<std::string>& words, const Outcome& outcome,
                    const ObservedFiles& seen) {
  const Json answer = Json::parse(outcome.json, nullptr, false);
  const std::string name = *action.is.logged_as != '\0' ? action.is.logged_as : action.path;
  std::error_code error;
  Json content =
      object_of("verb"_is(name), "words"_is(kept_words(action, words)),
                "folder"_is(std::filesystem::current_path(error).string()), "exit_code"_is(outcome.exit_code));
  if (answer.is_object() && outcome.json.size() <= kMostAnswer) content["answer"] = answer;
  std::string written;
  for (const SeenFile& file : seen.outputs())
    written += (written.empty() ? "" : " ") + std::filesystem::path(file.name).filename().string();
  std::string summary = summary_of(answer, outcome.text);
  if (const std::size_t colon = summary.find(": ");
      colon != std::string::npos && std::filesystem::path(summary.substr(0, colon)).filename() == written)
    summary.erase(0, colon + 2);  // named once
  if (!written.empty()) written += " written";
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

extern const std::vector<Action> kLog;

const Module& logbook_module() {
  static const Module module{
      .menus = {{"log", "LOGBOOK: the actions on a machine, each entry linked to the previous one"}},
      .verbs = {{"volume", &kLog}},
      .screens = {{"LOGBOOK", "the actions on a machine; verify, derive the map again",
                   [](const auto&) { return logbook_screen(); }}},
      .synonyms = {{"LOGBOOK", "history entries certificate audit traceability who when wear"},
                   {"log compare", "wear worn year drift history"},
                   {"log export", "certificate calibration dcc audit"}},
      .advice = {{name_of(FileKind::logbook), "use `ecs log list --log {}`"}},
      .begin = [] { commissioning::keep_logbook(); },
      .around = logged_verb};
  return module;
}

}  // namespace ecs::app
