#include "commissioning/logbook_session/controller.hpp"

#include <utility>

#include <fmt/format.h>

#include "base/text.hpp"
#include "commissioning/logbook/place.hpp"
#include "commissioning/logbook/recorder.hpp"
#include "commissioning/logbook/view.hpp"

namespace ecs::commissioning {
namespace {

std::filesystem::file_time_type time_of(const std::string& path) {
  std::error_code error;
  const auto time = std::filesystem::last_write_time(path, error);
  return error ? std::filesystem::file_time_type{} : time;
}

}  // namespace

LogbookController::LogbookController(RunVerb run) : run_(std::move(run)) { look(); }

void LogbookController::look() {
  const auto setting = logbook_setting();
  if (!setting) {
    absent_ = to_text(setting.error());
    return;
  }
  books_ = logbooks(*setting);
  if (books_.empty())
    absent_ = setting->off ? "No logbook is kept: ECS_LOGBOOK or the setting says off."
                           : "No logbook yet. Verbs and screens begin one when they work on a machine.";
  read();
}

void LogbookController::read() {
  entries_.clear();
  owner_.clear();
  if (books_.empty()) return;
  seen_ = time_of(book());
  const auto open = Logbook::open_to_read(book());
  auto entries = open ? open->entries(true) : tl::unexpected(open.error());
  const auto owner = open ? open->owner() : tl::unexpected(open.error());
  absent_ = entries ? "" : to_text(entries.error());
  if (entries) entries_ = std::move(*entries);
  if (owner) owner_ = in_words(*owner);
}

void LogbookController::open_next() {
  if (books_.size() < 2) return;
  at_ = (at_ + 1) % books_.size();
  message_.clear();
  read();
}

std::vector<std::string> LogbookController::lines_of(std::int64_t number) const {
  const auto open = Logbook::open_to_read(book());
  const auto entry = open ? open->entry(number) : tl::unexpected(open.error());
  return owned_lines_of(entry ? whole_entry_cell(*entry).text : to_text(entry.error()));
}

void LogbookController::verify() {
  if (running() || books_.empty()) return;
  task_.start(
      "checking every entry",
      [path = book()](JobControl& control) -> Found {
        const auto open = Logbook::open_to_read(path);
        if (!open) return {{}, to_text(open.error()), false};
        const LogVerdict verdict = open->verified({}, control.cancelled);
        const std::string text = verdict_cell(verdict, path).text;
        return {{}, std::string(trimmed(text)), verdict.whole()};
      },
      [this](Found found) { take(std::move(found)); });
}

void LogbookController::replay() {
  if (running() || books_.empty()) return;
  task_.start(
      "deriving the active map again",
      [path = book(), run = run_](JobControl&) -> Found {
        const auto open = Logbook::open_to_read(path);
        const auto done = open ? replayed(*open, run) : tl::unexpected(open.error());
        if (!done) return {{}, to_text(done.error()), false};
        return {owned_lines_of(replay_cell(*done).text),
                done->same ? "the active map follows from the raw readings, bit for bit"
                           : "the active map does NOT follow from the readings",
                done->same};
      },
      [this](Found found) { take(std::move(found)); });
}

void LogbookController::take(Found found) {
  answer_ = std::move(found.lines);
  message_.say(found.sentence, found.good ? Tone::good : Tone::bad);
}

bool LogbookController::advance() {
  const auto words = logbook_words();
  for (const LogbookWord& word : words) message_.say(word.text, word.warning ? Tone::warning : Tone::good);
  if (task_.advance() || !words.empty()) return true;
  if (books_.empty() || running() || time_of(book()) == seen_) return false;
  read();
  return true;
}

}  // namespace ecs::commissioning
