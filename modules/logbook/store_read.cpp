// Statements of SQLite; what a logbook holds: entries, files, whether all of it still fits.

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <set>

#include <fmt/format.h>
#include <zlib.h>

#include "base/file.hpp"
#include "modules/logbook/sqlite.hpp"
#include "modules/logbook/store.hpp"

namespace ecs::commissioning {

std::string packed(std::string_view content) {
  uLongf length = ::compressBound(content.size());
  std::string bytes(length, '\0');
  ::compress2(reinterpret_cast<Bytef*>(bytes.data()), &length, reinterpret_cast<const Bytef*>(content.data()),
              content.size(), Z_DEFAULT_COMPRESSION);
  bytes.resize(length);
  return bytes;
}

std::optional<std::string> unpacked(const std::string& bytes, std::int64_t length, const std::string& sha256) {
  if (length < 0 || static_cast<std::size_t>(length) > kLargestKept) return std::nullopt;
  std::string content(static_cast<std::size_t>(length), '\0');
  uLongf got = content.size();
  if (::uncompress(reinterpret_cast<Bytef*>(content.data()), &got, reinterpret_cast<const Bytef*>(bytes.data()),
                   bytes.size()) != Z_OK ||
      got != content.size() || sha256_hex(content) != sha256)
    return std::nullopt;
  return content;
}

Problem file_fault(const std::filesystem::path& path, ProblemKind kind, std::string what) {
  return {kind, std::move(what), path.string(), 0, 0, {}};
}

Problem sqlite_fault(const std::filesystem::path& path, sqlite3* file) {
  switch (file == nullptr ? SQLITE_NOMEM : sqlite3_errcode(file)) {
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return file_fault(path, ProblemKind::output, "another program has been writing to this logbook for 5 s");
    case SQLITE_FULL:
      return file_fault(path, ProblemKind::output, "the disc is full");
    case SQLITE_READONLY:
    case SQLITE_PERM:
    case SQLITE_CANTOPEN:
      return file_fault(path, ProblemKind::output, "no permission to write it, or to make files in its folder");
    case SQLITE_INTERRUPT:
      return file_fault(path, ProblemKind::output, "reading the logbook was stopped before its end");
    case SQLITE_TOOBIG:
      return file_fault(
          path, ProblemKind::bad_input,
          fmt::format("a value is longer than {} MiB: it is damaged, or no entry of ECS", kLongestLogValue >> 20));
    case SQLITE_NOTADB:
      return file_fault(path, ProblemKind::bad_input, "not a logbook of ECS");
    default:
      return file_fault(path, ProblemKind::output,
                        fmt::format("the logbook: {}", file == nullptr ? "out of memory" : sqlite3_errmsg(file)));
  }
}

/// No progress handler: SQLite 3.40 calls none while `integrity_check` walks the pages, a second for 190 MB.
StopsReading::StopsReading(sqlite3* file, const std::atomic<bool>& asked)
    : watch_([file, &asked](const std::stop_token& over) {
        using namespace std::chrono_literals;
        constexpr auto kLook = 50ms, kInNoTime = 500ms;
        const auto begun = std::chrono::steady_clock::now();
        std::mutex mutex;
        std::condition_variable_any never;
        std::unique_lock lock(mutex);
        while (!never.wait_for(lock, over, kLook, [] { return false; }) && !over.stop_requested())
          if (asked && std::chrono::steady_clock::now() - begun > kInNoTime) sqlite3_interrupt(file);
      }) {}

std::int64_t pragma(sqlite3* file, const char* name) {
  Statement one(file, fmt::format("PRAGMA {}", name));
  return one.step() == SQLITE_ROW ? one.number(0) : -1;
}

namespace {

constexpr const char* kColumns =
    "SELECT number, time, kind, machine, serial_number, operator, instrument, summary, content, previous, hash FROM "
    "entry ";
constexpr const char* kColumnsWithoutContent =
    "SELECT number, time, kind, machine, serial_number, operator, instrument, summary, '', previous, hash FROM entry ";

constexpr int kFields = 11;  ///< of an entry

LogbookEntry entry_in(const Statement& row) {
  return {row.number(0), row.text(1), row.text(2), row.text(3), row.text(4), row.text(5),
          row.text(6),   row.text(7), row.text(8), row.text(9), row.text(10)};
}

bool is_as_written(const Statement& row) {
  if (row.type(0) != SQLITE_INTEGER) return false;
  for (int column = 1; column < kFields; ++column)
    if (row.type(column) != SQLITE_TEXT) return false;
  return true;
}

}  // namespace

bool is_damaged_logbook(const std::filesystem::path& path) {
  constexpr std::uintmax_t kLeastPage = 512;
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  return !error && size > 0 && size % kLeastPage == 0;
}

bool Logbook::is_in_place() const {
  int moved = 1;
  return sqlite3_file_control(file_.get(), "main", SQLITE_FCNTL_HAS_MOVED, &moved) == SQLITE_OK && moved == 0;
}

namespace {

/// Rows cannot be longer than the file that holds them; those of pages that are linked in a ring are.
class RowsWithinFile {
 public:
  explicit RowsWithinFile(sqlite3* file) : file_(file) {}
  /// @param columns  of the row at hand  @pre that row is being read: the file does not grow for it meanwhile
  [[nodiscard]] bool hold(const Statement& row, int columns) {
    if (left_ < 0) left_ = pragma(file_, "page_count") * pragma(file_, "page_size");
    constexpr std::int64_t kLeastRow = 4;
    left_ -= kLeastRow;
    for (int column = 0; column < columns; ++column)
      if (row.type(column) == SQLITE_TEXT || row.type(column) == SQLITE_BLOB) left_ -= row.bytes(column);
    return left_ >= 0;
  }

 private:
  sqlite3* file_;
  std::int64_t left_ = -1;
};

constexpr const char* kMoreThanFile = "the file is damaged: it gives more than it contains";

/// All that the statement gives.
Result<std::vector<LogbookEntry>> entries_of(Statement rows, sqlite3* file, const std::filesystem::path& path) {
  std::vector<LogbookEntry> all;
  RowsWithinFile within(file);
  int step = rows.step();
  for (; step == SQLITE_ROW; step = rows.step()) {
    if (!within.hold(rows, kFields)) return tl::unexpected(file_fault(path, ProblemKind::bad_input, kMoreThanFile));
    all.push_back(entry_in(rows));
  }
  if (step != SQLITE_DONE) return tl::unexpected(sqlite_fault(path, file));
  return all;
}

}  // namespace

Result<std::vector<LogbookEntry>> Logbook::entries(bool without_content) const {
  const StopsReading stops(file_.get());
  return entries_of({file_.get(), std::string(without_content ? kColumnsWithoutContent : kColumns) + "ORDER BY number"},
                    file_.get(), path_);
}

Result<std::vector<LogbookEntry>> Logbook::activations() const {
  const StopsReading stops(file_.get());
  return entries_of({file_.get(), std::string(kColumns) + "WHERE kind IN ('activation', 'rollback') ORDER BY number"},
                    file_.get(), path_);
}

Result<LogbookEntry> Logbook::entry(std::int64_t number) const {
  const StopsReading stops(file_.get());
  Statement row(file_.get(), std::string(kColumns) + "WHERE number = ?");
  const int step = row.with(number).step();
  if (step == SQLITE_ROW) return entry_in(row);
  if (step != SQLITE_DONE) return tl::unexpected(sqlite_fault(path_, file_.get()));
  const auto held = count();
  return tl::unexpected(file_fault(path_, ProblemKind::refused,
                                   fmt::format("there is no entry {}; it contains {}", number, held ? *held : 0)));
}

Result<std::optional<LogbookEntry>> Logbook::last_of(std::string_view kind, std::string_view until) const {
  const StopsReading stops(file_.get());
  Statement row(file_.get(),
                std::string(kColumns) + "WHERE kind = ? AND (? = '' OR time <= ?) ORDER BY number DESC LIMIT 1");
  const int step = row.with(kind).with(until).with(until).step();
  if (step == SQLITE_ROW) return std::optional(entry_in(row));
  if (step != SQLITE_DONE) return tl::unexpected(sqlite_fault(path_, file_.get()));
  return std::optional<LogbookEntry>();
}

bool Logbook::holds(const std::string& sha256) const {
  Statement row(file_.get(), "SELECT 1 FROM original WHERE sha256 = ?");
  return row.with(sha256).step() == SQLITE_ROW;
}

Result<std::string> Logbook::original(const std::string& sha256) const {
  Statement row(file_.get(), "SELECT bytes, packed FROM original WHERE sha256 = ?");
  const int step = row.with(sha256).step();
  if (step == SQLITE_DONE)
    return tl::unexpected(
        file_fault(path_, ProblemKind::refused, fmt::format("it does not contain the file with hash {}", sha256)));
  if (step != SQLITE_ROW) return tl::unexpected(sqlite_fault(path_, file_.get()));
  auto content = unpacked(row.text(1), row.number(0), sha256);
  if (!content)
    return tl::unexpected(
        file_fault(path_, ProblemKind::refused, fmt::format("the file with hash {} is damaged in it", sha256)));
  return std::move(*content);
}

Result<LogOwner> Logbook::owner() const {
  const StopsReading stops(file_.get());
  LogOwner found;
  for (auto& [column, into] :
       {std::pair<const char*, std::string*>{"machine", &found.machine}, {"serial_number", &found.serial_number}}) {
    Statement row(file_.get(), fmt::format("SELECT {0} FROM entry WHERE {0} <> '' ORDER BY number LIMIT 1", column));
    const int step = row.step();
    if (step == SQLITE_ROW)
      *into = row.text(0);
    else if (step != SQLITE_DONE)
      return tl::unexpected(sqlite_fault(path_, file_.get()));
  }
  return found;
}

Result<std::size_t> Logbook::count() const {
  const StopsReading stops(file_.get());
  Statement row(file_.get(), "SELECT count(*) FROM entry");
  if (row.step() != SQLITE_ROW) return tl::unexpected(sqlite_fault(path_, file_.get()));
  return static_cast<std::size_t>(row.number(0));
}

Result<std::string> Logbook::last_hash() const {
  Statement row(file_.get(), "SELECT hash FROM entry ORDER BY number DESC LIMIT 1");
  const int step = row.step();
  if (step == SQLITE_ROW) return row.text(0);
  if (step == SQLITE_DONE) return std::string();
  return tl::unexpected(sqlite_fault(path_, file_.get()));
}

namespace {

/// Hashes of the files that are held whole, up to where the table can be read.
/// @return SQLITE_DONE, or what went wrong
int whole_originals(sqlite3* file, std::set<std::string>& whole) {
  Statement rows(file, "SELECT sha256, bytes, packed FROM original");
  RowsWithinFile within(file);
  int step = rows.step();
  for (; step == SQLITE_ROW && within.hold(rows, 3); step = rows.step())
    if (std::string sha256 = rows.text(0); unpacked(rows.text(2), rows.number(1), sha256))
      whole.insert(std::move(sha256));
  return step;
}

/// Why the entry does not follow the one before; empty: it does.
std::string misfit(const Statement& row, const LogbookEntry& entry, std::int64_t expected, const std::string& previous,
                   const std::set<std::string>& originals) {
  if (entry.number != expected) return "it is missing";
  if (!is_as_written(row)) return "one of its fields is damaged";
  if (entry.previous != previous) return "it does not contain the hash of the previous entry";
  if (hash_of(entry) != entry.hash) return "its hash does not match its fields, so it was changed";
  for (const LogFile& file : files_of(entry))
    if (file.kept && !originals.contains(file.sha256))
      return fmt::format("its file {} is missing or was changed", file.name);
  return {};
}

}  // namespace

LogVerdict Logbook::verified(const std::string& expected, const std::atomic<bool>& cancelled) const {
  sqlite3* file = file_.get();
  const StopsReading stops(file, cancelled);
  constexpr const char* kStopped = "stopped before the end";
  LogVerdict verdict;
  bool found = expected.empty();
  {
    std::set<std::string> originals;
    if (whole_originals(file, originals) == SQLITE_INTERRUPT) {
      verdict.why = kStopped;
      return verdict;
    }
    Statement rows(file, std::string(kColumns) + "ORDER BY number");
    std::string previous = no_previous();
    int step = rows.step();
    for (; step == SQLITE_ROW; step = rows.step()) {
      const LogbookEntry entry = entry_in(rows);
      const auto next = static_cast<std::int64_t>(verdict.entries) + 1;
      verdict.why = misfit(rows, entry, next, previous, originals);
      if (!verdict.why.empty()) {
        verdict.first = next;
        return verdict;
      }
      previous = verdict.last_hash = entry.hash;
      found = found || entry.hash == expected;
      ++verdict.entries;
    }
    if (step == SQLITE_INTERRUPT) {
      verdict.why = fmt::format("{}: {} entries fit so far", kStopped, verdict.entries);
      return verdict;
    }
    if (step != SQLITE_DONE) {
      verdict.first = static_cast<std::int64_t>(verdict.entries) + 1;
      verdict.why = fmt::format("it cannot be read: {}", sqlite3_errmsg(file));
      return verdict;
    }
  }
  if (!found) {
    verdict.first = static_cast<std::int64_t>(verdict.entries) + 1;
    verdict.why =
        fmt::format("no entry has the hash {}: entries at the end are missing, or it is another logbook", expected);
    return verdict;
  }
  Statement check(file, "PRAGMA integrity_check(1)");
  if (const int step = check.step(); step == SQLITE_INTERRUPT)
    verdict.why = fmt::format("{}: every entry fits, the structure of the file was not checked", kStopped);
  else if (step != SQLITE_ROW)
    verdict.why = fmt::format("every entry fits, but the file cannot be checked: {}", sqlite3_errmsg(file));
  else if (const std::string said = check.text(0); said != "ok")
    verdict.why = fmt::format("every entry fits, but the file is damaged: {}", said);
  return verdict;
}

}  // namespace ecs::commissioning
