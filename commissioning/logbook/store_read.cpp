// What a logbook holds: entries, files, whether all of it still fits.
#include <set>

#include <fmt/format.h>

#include "commissioning/logbook/packing.hpp"
#include "commissioning/logbook/sqlite.hpp"
#include "commissioning/logbook/store.hpp"

namespace ecs::commissioning {
namespace {

constexpr const char* kColumns =
    "SELECT number, time, kind, machine, serial_number, operator, instrument, summary, content, previous, hash FROM "
    "entry ";
constexpr const char* kColumnsWithoutContent =
    "SELECT number, time, kind, machine, serial_number, operator, instrument, summary, '', previous, hash FROM entry ";

LogbookEntry entry_in(const Statement& row) {
  return {row.number(0), row.text(1), row.text(2), row.text(3), row.text(4), row.text(5),
          row.text(6),   row.text(7), row.text(8), row.text(9), row.text(10)};
}

bool is_as_written(const Statement& row) {
  if (row.type(0) != SQLITE_INTEGER) return false;
  for (int column = 1; column <= 10; ++column)
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

Result<std::vector<LogbookEntry>> Logbook::entries(bool without_content) const {
  Statement rows(file_.get(), std::string(without_content ? kColumnsWithoutContent : kColumns) + "ORDER BY number");
  std::vector<LogbookEntry> all;
  int step = rows.step();
  for (; step == SQLITE_ROW; step = rows.step()) all.push_back(entry_in(rows));
  if (step != SQLITE_DONE) return tl::unexpected(sqlite_fault(path_, file_.get()));
  return all;
}

Result<std::vector<LogbookEntry>> Logbook::activations() const {
  Statement rows(file_.get(), std::string(kColumns) + "WHERE kind IN ('activation', 'rollback') ORDER BY number");
  std::vector<LogbookEntry> all;
  int step = rows.step();
  for (; step == SQLITE_ROW; step = rows.step()) all.push_back(entry_in(rows));
  if (step != SQLITE_DONE) return tl::unexpected(sqlite_fault(path_, file_.get()));
  return all;
}

Result<LogbookEntry> Logbook::entry(std::int64_t number) const {
  Statement row(file_.get(), std::string(kColumns) + "WHERE number = ?");
  const int step = row.with(number).step();
  if (step == SQLITE_ROW) return entry_in(row);
  if (step != SQLITE_DONE) return tl::unexpected(sqlite_fault(path_, file_.get()));
  const auto held = count();
  return tl::unexpected(file_fault(path_, ProblemKind::refused,
                                   fmt::format("there is no entry {}; it holds {}", number, held ? *held : 0)));
}

Result<std::optional<LogbookEntry>> Logbook::last_of(std::string_view kind, std::string_view until) const {
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
        file_fault(path_, ProblemKind::refused, fmt::format("it does not hold the file with hash {}", sha256)));
  if (step != SQLITE_ROW) return tl::unexpected(sqlite_fault(path_, file_.get()));
  auto content = unpacked(row.text(1), row.number(0), sha256);
  if (!content)
    return tl::unexpected(
        file_fault(path_, ProblemKind::refused, fmt::format("the file with hash {} is damaged in it", sha256)));
  return std::move(*content);
}

Result<LogOwner> Logbook::owner() const {
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

/// Hashes of the files that are held whole.
std::set<std::string> whole_originals(sqlite3* file) {
  std::set<std::string> whole;
  Statement rows(file, "SELECT sha256, bytes, packed FROM original");
  while (rows.step() == SQLITE_ROW)
    if (std::string sha256 = rows.text(0); unpacked(rows.text(2), rows.number(1), sha256))
      whole.insert(std::move(sha256));
  return whole;
}

/// Why the entry does not follow the one before; empty: it does.
std::string misfit(const Statement& row, const LogbookEntry& entry, std::int64_t expected, const std::string& previous,
                   const std::set<std::string>& originals) {
  if (entry.number != expected) return fmt::format("entry {} is missing", expected);
  if (!is_as_written(row)) return "a field of it is damaged";
  if (entry.previous != previous) return "it does not name the hash of the entry before";
  if (hash_of(entry) != entry.hash) return "its hash is not that of its fields: it was changed";
  for (const LogFile& file : files_of(entry))
    if (file.kept && !originals.contains(file.sha256))
      return fmt::format("its file {} is missing or was changed", file.name);
  return {};
}

}  // namespace

LogVerdict Logbook::verified(const std::string& expected) const {
  sqlite3* file = file_.get();
  LogVerdict verdict;
  bool found = expected.empty();
  {
    const std::set<std::string> originals = whole_originals(file);
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
  if (check.step() != SQLITE_ROW)
    verdict.why = fmt::format("every entry fits, but the file cannot be checked: {}", sqlite3_errmsg(file));
  else if (const std::string said = check.text(0); said != "ok")
    verdict.why = fmt::format("every entry fits, but the file is damaged: {}", said);
  return verdict;
}

}  // namespace ecs::commissioning
