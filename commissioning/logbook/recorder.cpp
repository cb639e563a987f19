#include "commissioning/logbook/recorder.hpp"

#include <atomic>
#include <mutex>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "base/clock.hpp"
#include "base/file.hpp"
#include "base/file_watch.hpp"
#include "base/json.hpp"
#include "base/version.hpp"
#include "commissioning/logbook/observed.hpp"
#include "commissioning/logbook/place.hpp"
#include "commissioning/logbook/store.hpp"

namespace ecs::commissioning {
namespace {

std::atomic<bool> keeping{false};

/// What is to be said, and what was said before.
struct Words {
  std::mutex mutex;
  std::vector<LogbookWord> waiting;
  std::set<std::string> said;
};

Words& words() {
  static Words all;
  return all;
}

void say_once(bool warning, std::string text) {
  const std::lock_guard lock(words().mutex);
  if (words().said.insert(text).second) words().waiting.push_back({warning, std::move(text)});
}

/// Of several threads one after the other: SQLite would let them wait for each other by polling.
std::mutex& writing() {
  static std::mutex one;
  return one;
}

void complete(LogRecord& record) {
  if (const ObservedFiles* seen = ObservedFiles::current()) {
    std::vector<SeenFile> files = seen->files();
    files.insert(files.end(), std::make_move_iterator(record.files.begin()),
                 std::make_move_iterator(record.files.end()));
    record.files = std::move(files);
  }
  if (record.machine.empty()) {
    const LogOwner owner = owner_of(record.files);
    record.machine = owner.machine;
    if (record.serial_number.empty()) record.serial_number = owner.serial_number;
  }
  if (record.time.empty()) record.time = now_utc();
  if (record.instrument.empty()) record.instrument = instrument_json(instrument_of(record.files), record.time);
  if (record.operator_name.empty()) record.operator_name = operator_name();
  Json content = Json::parse(record.content, nullptr, false);
  if (!content.is_object()) content = Json::object();
  content["program"] = program_version_and_commit();
  record.content = one_line(content);
}

/// A measurement set that no entry has brought yet gets one of its own, whichever verb reads it first.
Result<void> add_new_measurements(Logbook& book, const LogRecord& by) {
  if (by.kind == "measurement") return {};
  for (const SeenFile& file : by.files) {
    if (file.role != "input" || !is_measurement_set(*file.content) || book.holds(sha256_hex(*file.content))) continue;
    LogRecord record;
    record.kind = "measurement";
    record.machine = by.machine;
    record.serial_number = by.serial_number;
    record.time = by.time;
    record.operator_name = by.operator_name;
    record.instrument = instrument_json(instrument_of({file}), by.time);
    record.summary = fmt::format("{}, read for the next entry", std::filesystem::path(file.name).filename().string());
    record.content = one_line(Json{{"program", program_version_and_commit()}});
    record.files = {file};
    if (const auto entry = book.append(record); !entry) return tl::unexpected(entry.error());
  }
  return {};
}

Result<std::optional<std::filesystem::path>> place_of(const LogRecord& record) {
  const auto setting = logbook_setting();
  if (!setting) return tl::unexpected(setting.error());
  return logbook_of(*setting, {record.machine, record.serial_number});
}

Result<LogbookEntry> written(const std::filesystem::path& path, const LogRecord& record) {
  auto book = Logbook::open(path);
  if (!book) return tl::unexpected(book.error());
  if (const auto added = add_new_measurements(*book, record); !added) return tl::unexpected(added.error());
  auto entry = book->append(record);
  if (!entry) return tl::unexpected(entry.error());
  if (book->is_new())
    say_once(false, fmt::format("a logbook of {} was begun: {} (docs/logbook.md; ECS_LOGBOOK=off keeps none)",
                                in_words({record.machine, record.serial_number}), path.string()));
  return entry;
}

std::optional<LogbookEntry> said_if_failed(Result<LogbookEntry> entry) {
  if (entry) return std::move(*entry);
  say_once(true, fmt::format("not in the logbook: {}", to_text(entry.error())));
  return std::nullopt;
}

}  // namespace

void keep_logbook(bool keep) {
  const auto setting = logbook_setting();
  keeping = keep && (!setting || !setting->off);
}

bool logbook_is_kept() { return keeping; }

std::optional<LogbookEntry> record(LogRecord record) {
  if (!keeping) return std::nullopt;
  const std::lock_guard lock(writing());
  complete(record);
  const Unwatched own_files;
  const auto path = place_of(record);
  if (path && !*path) return std::nullopt;
  return said_if_failed(path ? written(**path, record) : tl::unexpected(path.error()));
}

std::optional<LogbookEntry> record_in(const std::filesystem::path& path, LogRecord record) {
  if (!keeping) return std::nullopt;
  const std::lock_guard lock(writing());
  complete(record);
  const Unwatched own_files;
  return said_if_failed(written(path, record));
}

std::optional<LogbookEnd> logbook_end() {
  const ObservedFiles* seen = ObservedFiles::current();
  if (!keeping || seen == nullptr) return std::nullopt;
  LogRecord about;
  const LogOwner owner = owner_of(seen->files());
  about.machine = owner.machine;
  about.serial_number = owner.serial_number;
  const Unwatched own_files;
  const auto path = place_of(about);
  if (!path || !*path) return std::nullopt;
  const auto book = Logbook::open_to_read(**path);
  const auto count = book ? book->count() : tl::unexpected(book.error());
  auto hash = book ? book->last_hash() : tl::unexpected(book.error());
  if (!count || !hash || *count == 0) return std::nullopt;
  return LogbookEnd{**path, *count, std::move(*hash)};
}

std::vector<LogbookWord> logbook_words() {
  const std::lock_guard lock(words().mutex);
  return std::exchange(words().waiting, {});
}

}  // namespace ecs::commissioning
