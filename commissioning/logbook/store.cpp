#include "commissioning/logbook/store.hpp"

#include <set>

#include <fmt/format.h>
#include <sqlite3.h>
#include <zlib.h>

#include "base/clock.hpp"
#include "base/file.hpp"
#include "base/json.hpp"

namespace ecs::commissioning {
namespace {

constexpr int kApplication = 0x4543534C;  // "ECSL", in the header of the file
constexpr int kFormat = 1;
constexpr int kMostWaiting_ms = 5000;            // for another program that writes
constexpr std::size_t kLargestKept = 32u << 20;  // of a file that is named by its hash alone
constexpr std::size_t kLeastMachineCut = 37;     // bytes; a unit's identity cuts longer names (core/identity.cpp)

constexpr const char* kTables =
    "CREATE TABLE entry(number INTEGER PRIMARY KEY, time TEXT NOT NULL, kind TEXT NOT NULL, machine TEXT NOT NULL, "
    "serial_number TEXT NOT NULL, operator TEXT NOT NULL, instrument TEXT NOT NULL, summary TEXT NOT NULL, "
    "content TEXT NOT NULL, previous TEXT NOT NULL, hash TEXT NOT NULL);"
    "CREATE TABLE original(sha256 TEXT PRIMARY KEY, bytes INTEGER NOT NULL, packed BLOB NOT NULL) WITHOUT ROWID;";
constexpr const char* kColumns =
    "SELECT number, time, kind, machine, serial_number, operator, instrument, summary, content, previous, hash FROM "
    "entry ";
constexpr const char* kColumnsWithoutContent =
    "SELECT number, time, kind, machine, serial_number, operator, instrument, summary, '', previous, hash FROM entry ";

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
    case SQLITE_NOTADB:
      return file_fault(path, ProblemKind::bad_input, "is no logbook of ECS");
    default:
      return file_fault(path, ProblemKind::output,
                        fmt::format("the logbook: {}", file == nullptr ? "out of memory" : sqlite3_errmsg(file)));
  }
}

/// A statement with its values.
class Statement {
 public:
  Statement(sqlite3* file, const std::string& sql) {
    if (sqlite3_prepare_v2(file, sql.c_str(), -1, &statement_, nullptr) != SQLITE_OK) statement_ = nullptr;
  }
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;
  ~Statement() { sqlite3_finalize(statement_); }

  Statement& with(std::string_view text) {
    const char* bytes = text.data() == nullptr ? "" : text.data();  // no bytes are an empty text, not NULL
    sqlite3_bind_text(statement_, ++bound_, bytes, static_cast<int>(text.size()), SQLITE_TRANSIENT);
    return *this;
  }
  Statement& with_bytes(const std::string& bytes) {
    sqlite3_bind_blob(statement_, ++bound_, bytes.data(), static_cast<int>(bytes.size()), SQLITE_TRANSIENT);
    return *this;
  }
  Statement& with(std::int64_t number) {
    sqlite3_bind_int64(statement_, ++bound_, number);
    return *this;
  }
  /// SQLITE_ROW, SQLITE_DONE or what went wrong.
  [[nodiscard]] int step() { return statement_ == nullptr ? SQLITE_ERROR : sqlite3_step(statement_); }
  [[nodiscard]] std::string text(int column) const {
    const auto* bytes = static_cast<const char*>(sqlite3_column_blob(statement_, column));
    return bytes == nullptr ? std::string()
                            : std::string(bytes, static_cast<std::size_t>(sqlite3_column_bytes(statement_, column)));
  }
  [[nodiscard]] std::int64_t number(int column) const { return sqlite3_column_int64(statement_, column); }
  [[nodiscard]] int type(int column) const { return sqlite3_column_type(statement_, column); }

 private:
  sqlite3_stmt* statement_ = nullptr;
  int bound_ = 0;
};

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

std::int64_t pragma(sqlite3* file, const char* name) {
  Statement one(file, fmt::format("PRAGMA {}", name));
  return one.step() == SQLITE_ROW ? one.number(0) : -1;
}

/// A new file, or one whose beginning was cut by a crash and is taken back.
bool is_empty(sqlite3* file) {
  Statement tables(file, "SELECT count(*) FROM sqlite_master");
  return tables.step() == SQLITE_ROW && tables.number(0) == 0 && pragma(file, "application_id") == 0 &&
         pragma(file, "user_version") == 0;
}

std::string packed(std::string_view content) {
  uLongf length = ::compressBound(content.size());
  std::string bytes(length, '\0');
  ::compress2(reinterpret_cast<Bytef*>(bytes.data()), &length, reinterpret_cast<const Bytef*>(content.data()),
              content.size(), Z_DEFAULT_COMPRESSION);
  bytes.resize(length);
  return bytes;
}

/// Nothing where it is not the file of that hash.
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

/// Takes back what was begun, unless it is committed.
class Transaction {
 public:
  explicit Transaction(sqlite3* file)
      : file_(file), open_(sqlite3_exec(file, "BEGIN IMMEDIATE", nullptr, nullptr, nullptr) == SQLITE_OK) {}
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  ~Transaction() {
    if (open_) sqlite3_exec(file_, "ROLLBACK", nullptr, nullptr, nullptr);
  }
  [[nodiscard]] bool open() const { return open_; }
  [[nodiscard]] bool commit() {
    if (sqlite3_exec(file_, "COMMIT", nullptr, nullptr, nullptr) != SQLITE_OK) return false;
    open_ = false;
    return true;
  }

 private:
  sqlite3* file_;
  bool open_;
};

bool same_machine(const std::string& a, const std::string& b) {
  if (a == b) return true;
  const auto& [shorter, longer] = a.size() < b.size() ? std::pair(a, b) : std::pair(b, a);
  return shorter.size() >= kLeastMachineCut && longer.starts_with(shorter);
}

struct PackedFile {
  LogFile file;
  std::string bytes;
};

/// Before the transaction begins: others need not wait for it.
std::vector<PackedFile> packed_files(const LogRecord& record) {
  std::vector<PackedFile> files;
  for (const SeenFile& seen : record.files) {
    const std::string& content = *seen.content;
    PackedFile one{{seen.role, seen.name, sha256_hex(content), content.size(), content.size() <= kLargestKept}, {}};
    if (one.file.kept) one.bytes = packed(content);
    files.push_back(std::move(one));
  }
  return files;
}

std::string content_with(const std::string& content, const std::vector<PackedFile>& files) {
  Json object = Json::parse(content, nullptr, false);
  if (!object.is_object()) object = Json::object();
  Json list = Json::array();
  for (const PackedFile& one : files)
    list.push_back({{"role", one.file.role},
                    {"name", one.file.name},
                    {"sha256", one.file.sha256},
                    {"bytes", one.file.bytes},
                    {"kept", one.file.kept}});
  object["files"] = std::move(list);
  return one_line(object);
}

/// One line of text that is UTF-8: SQLite hands back what it was given only then.
std::string clean(const std::string& text) {
  const Json word = Json::parse(one_line(Json(text)), nullptr, false);
  return word.is_string() ? word.get<std::string>() : std::string();
}

}  // namespace

bool belongs(const LogOwner& owner, const LogOwner& of) {
  const bool empty = owner.machine.empty() && owner.serial_number.empty();
  const bool both_named = !owner.machine.empty() && !of.machine.empty();
  const bool both_numbered = !owner.serial_number.empty() && !of.serial_number.empty();
  if (both_named && !same_machine(owner.machine, of.machine)) return false;
  if (both_numbered && owner.serial_number != of.serial_number) return false;
  return empty || both_named || both_numbered;
}

std::string in_words(const LogOwner& owner) {
  if (owner.machine.empty() && owner.serial_number.empty()) return "no machine yet";
  if (owner.serial_number.empty()) return owner.machine;
  if (owner.machine.empty()) return fmt::format("the unit with serial number {}", owner.serial_number);
  return fmt::format("{}, serial number {}", owner.machine, owner.serial_number);
}

bool is_damaged_logbook(const std::filesystem::path& path) {
  constexpr std::uintmax_t kLeastPage = 512;
  std::error_code error;
  const auto size = std::filesystem::file_size(path, error);
  return !error && size > 0 && size % kLeastPage == 0;
}

void Logbook::Close::operator()(sqlite3* file) const noexcept { sqlite3_close_v2(file); }

Result<Logbook> Logbook::opened(const std::filesystem::path& path, bool create) {
  sqlite3* file = nullptr;
  const int result =
      sqlite3_open_v2(path.c_str(), &file, SQLITE_OPEN_READWRITE | (create ? SQLITE_OPEN_CREATE : 0), nullptr);
  Logbook book(path, file);
  if (result != SQLITE_OK) return tl::unexpected(sqlite_fault(path, file));
  sqlite3_busy_timeout(file, kMostWaiting_ms);
  // A committed entry is on the disc, the end of its journal as well.
  if (sqlite3_exec(file, "PRAGMA synchronous=EXTRA; PRAGMA cell_size_check=ON; PRAGMA trusted_schema=OFF", nullptr,
                   nullptr, nullptr) != SQLITE_OK)
    return tl::unexpected(sqlite_fault(path, file));
  return book;
}

Result<Logbook> Logbook::open(const std::filesystem::path& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    return tl::unexpected(file_fault(path, ProblemKind::output, "expected a file, found a folder"));
  auto book = opened(path, true);
  if (!book) return book;
  sqlite3* file = book->file_.get();
  if (is_empty(file)) {
    Transaction all(file);
    if (!all.open()) return tl::unexpected(sqlite_fault(path, file));
    if (is_empty(file)) {  // no other program was faster
      const std::string begun =
          fmt::format("{} PRAGMA application_id={}; PRAGMA user_version={};", kTables, kApplication, kFormat);
      if (sqlite3_exec(file, begun.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK)
        return tl::unexpected(sqlite_fault(path, file));
      book->is_new_ = true;
    }
    if (!all.commit()) return tl::unexpected(sqlite_fault(path, file));
  }
  if (pragma(file, "application_id") != kApplication)
    return tl::unexpected(sqlite3_errcode(file) == SQLITE_BUSY || sqlite3_errcode(file) == SQLITE_CANTOPEN
                              ? sqlite_fault(path, file)
                              : file_fault(path, ProblemKind::bad_input, "is no logbook of ECS"));
  if (const auto format = pragma(file, "user_version"); format != kFormat)
    return tl::unexpected(
        file_fault(path, ProblemKind::bad_input,
                   fmt::format("is a logbook of format {}; this program writes format {}", format, kFormat)));
  return book;
}

Result<Logbook> Logbook::open_to_read(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error))
    return tl::unexpected(file_fault(path, ProblemKind::bad_input, "no such logbook"));
  if (std::filesystem::is_directory(path, error) || std::filesystem::file_size(path, error) == 0)
    return tl::unexpected(file_fault(path, ProblemKind::bad_input, "is no logbook of ECS"));
  auto book = opened(path, false);
  if (!book) return book;
  sqlite3* file = book->file_.get();
  const std::int64_t application = pragma(file, "application_id");
  if (application == -1 && sqlite3_errcode(file) != SQLITE_NOTADB) return tl::unexpected(sqlite_fault(path, file));
  if (application != kApplication || pragma(file, "user_version") != kFormat)
    return tl::unexpected(file_fault(path, ProblemKind::bad_input, "is no logbook of ECS, or of another format"));
  return book;
}

Result<LogbookEntry> Logbook::append(const LogRecord& record) {
  sqlite3* file = file_.get();
  const std::vector<PackedFile> files = packed_files(record);
  LogbookEntry entry;
  entry.time = record.time.empty() ? now_utc() : record.time;
  entry.kind = clean(record.kind);
  entry.machine = clean(record.machine);
  entry.serial_number = clean(record.serial_number);
  entry.operator_name = clean(record.operator_name);
  entry.instrument = clean(record.instrument);
  entry.summary = clean(record.summary);
  entry.content = content_with(record.content, files);
  Transaction all(file);
  if (!all.open()) return tl::unexpected(sqlite_fault(path_, file));
  const auto of = owner();
  if (!of) return tl::unexpected(of.error());
  if (!belongs(*of, {entry.machine, entry.serial_number}))
    return tl::unexpected(file_fault(
        path_, ProblemKind::refused,
        fmt::format("is the logbook of {}, not of {}", in_words(*of), in_words({entry.machine, entry.serial_number}))));
  {
    Statement last(file, "SELECT number, hash FROM entry ORDER BY number DESC LIMIT 1");
    const int step = last.step();
    if (step != SQLITE_ROW && step != SQLITE_DONE) return tl::unexpected(sqlite_fault(path_, file));
    entry.number = step == SQLITE_ROW ? last.number(0) + 1 : 1;
    entry.previous = step == SQLITE_ROW ? last.text(1) : no_previous();
  }
  entry.hash = hash_of(entry);
  for (const PackedFile& one : files) {
    if (!one.file.kept) continue;
    Statement put(file, "INSERT OR IGNORE INTO original VALUES(?, ?, ?)");
    if (put.with(one.file.sha256).with(static_cast<std::int64_t>(one.file.bytes)).with_bytes(one.bytes).step() !=
        SQLITE_DONE)
      return tl::unexpected(sqlite_fault(path_, file));
  }
  {
    Statement put(file, "INSERT INTO entry VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
    put.with(entry.number);
    for (const std::string* part :
         {&entry.time, &entry.kind, &entry.machine, &entry.serial_number, &entry.operator_name, &entry.instrument,
          &entry.summary, &entry.content, &entry.previous, &entry.hash})
      put.with(*part);
    if (put.step() != SQLITE_DONE) return tl::unexpected(sqlite_fault(path_, file));
  }
  if (!all.commit()) return tl::unexpected(sqlite_fault(path_, file));
  return entry;
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
