// Entries and their hashes, whose logbook it is, and the file: opened, made, added to.
#include "modules/logbook/store.hpp"

#include <fmt/format.h>

#include "base/answer_table.hpp"
#include "base/clock.hpp"
#include "base/file.hpp"
#include "modules/logbook/sqlite.hpp"

namespace ecs::commissioning {
namespace {

constexpr std::string_view kHashed = "ecs-logbook-1";  // changes with what is hashed

Json content_json(const LogbookEntry& entry) {
  Json content = json_in(entry.content);
  return content.is_object() ? content : Json::object();
}

}  // namespace

std::string hash_of(const LogbookEntry& entry) {
  std::string bytes;
  const auto add = [&bytes](std::string_view part) { bytes += fmt::format("{}:", part.size()).append(part); };
  add(kHashed);
  add(fmt::format("{}", entry.number));
  for (const std::string* part : {&entry.time, &entry.kind, &entry.machine, &entry.serial_number, &entry.operator_name,
                                  &entry.instrument, &entry.summary, &entry.content, &entry.previous})
    add(*part);
  return sha256_hex(bytes);
}

std::string no_previous() { return std::string(64, '0'); }

std::vector<LogFile> files_of(const LogbookEntry& entry) {
  std::vector<LogFile> files;
  const Json content = content_json(entry);
  const auto found = content.find("files");
  if (found == content.end() || !found->is_array()) return files;
  for (const Json& one : *found) {
    if (!one.is_object()) continue;
    LogFile file{text_at(one, "role"), text_at(one, "name"), text_at(one, "sha256"), 0, false};
    if (const auto bytes = one.find("bytes"); bytes != one.end() && bytes->is_number_unsigned())
      file.bytes = bytes->get<std::uint64_t>();
    if (const auto kept = one.find("kept"); kept != one.end() && kept->is_boolean()) file.kept = kept->get<bool>();
    files.push_back(std::move(file));
  }
  return files;
}

std::vector<std::string> words_of(const LogbookEntry& entry) {
  std::vector<std::string> words;
  const Json content = content_json(entry);
  const auto found = content.find("words");
  if (found == content.end() || !found->is_array()) return words;
  for (const Json& word : *found)
    if (word.is_string()) words.push_back(word.get<std::string>());
  return words;
}

std::string folder_of(const LogbookEntry& entry) { return text_at(content_json(entry), "folder"); }

namespace {

constexpr std::size_t kLeastMachineCut = 37;  // bytes; a unit's identity cuts longer names (core/memory_image.hpp)

bool same_machine(const std::string& a, const std::string& b) {
  if (a == b) return true;
  const auto& [shorter, longer] = a.size() < b.size() ? std::pair(a, b) : std::pair(b, a);
  return shorter.size() >= kLeastMachineCut && longer.starts_with(shorter);
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

namespace {

namespace fs = std::filesystem;

constexpr int kApplication = 0x4543534C;  // "ECSL", in the header of the file
constexpr int kFormat = 1;
constexpr int kMostWaiting_ms = 5000;  // for another program that writes
constexpr const char* kWriteAhead = "-wal";

constexpr const char* kEntryTable =
    "CREATE TABLE entry(number INTEGER PRIMARY KEY, time TEXT NOT NULL, kind TEXT NOT NULL, machine TEXT NOT NULL, "
    "serial_number TEXT NOT NULL, operator TEXT NOT NULL, instrument TEXT NOT NULL, summary TEXT NOT NULL, content "
    "TEXT NOT NULL, previous TEXT NOT NULL, hash TEXT NOT NULL)";
constexpr const char* kOriginalTable =
    "CREATE TABLE original(sha256 TEXT PRIMARY KEY, bytes INTEGER NOT NULL, packed BLOB NOT NULL) WITHOUT ROWID";

/// A new file, or one whose beginning was cut by a crash and is taken back.
bool is_empty(sqlite3* file) {
  Statement tables(file, "SELECT count(*) FROM sqlite_master");
  return tables.step() == SQLITE_ROW && tables.number(0) == 0 && pragma(file, "application_id") == 0 &&
         pragma(file, "user_version") == 0;
}

/// Why a logbook holds something else than its two tables, word for word; nothing: it does not. A trigger acts with the
/// next entry, and a view answers in the place of a table: entries that fit prove nothing then.
std::optional<Problem> schema_fault(const fs::path& path, sqlite3* file) {
  constexpr std::size_t kLongestName = 60;
  const auto changed = [&path](std::string_view found) {
    return file_fault(
        path, ProblemKind::bad_input,
        fmt::format("is damaged, or was changed by another program: expected the tables entry and original of a "
                    "logbook and nothing else, found {}. Restore an older copy, or inspect it with `sqlite3`",
                    found));
  };
  Statement rows(file, "SELECT type, name, sql FROM sqlite_master");
  bool entry = false, original = false;
  int step = rows.step();
  for (; step == SQLITE_ROW; step = rows.step()) {
    bool& known = rows.text(2) == kEntryTable ? entry : original;
    if (known || (rows.text(2) != kEntryTable && rows.text(2) != kOriginalTable))
      return changed(fmt::format("{} \"{}\"{}", rows.text(0).substr(0, kLongestName),
                                 rows.text(1).substr(0, kLongestName),
                                 rows.text(1) == "entry" ? " with another definition" : ""));
    known = true;
  }
  const int code = sqlite3_errcode(file);
  if (code == SQLITE_CORRUPT || code == SQLITE_ERROR) return changed(sqlite3_errmsg(file));
  if (step != SQLITE_DONE) return sqlite_fault(path, file);
  if (!entry || !original) return changed(entry ? "no table original" : "no table entry");
  return std::nullopt;
}

bool done(sqlite3* file, const char* sql) { return sqlite3_exec(file, sql, nullptr, nullptr, nullptr) == SQLITE_OK; }

/// The write-ahead log beside the file; where its file system has none (shared memory over a network), the rollback
/// journal, whose directory is then synchronised as well.
void choose_journal(sqlite3* file) {
  Statement wanted(file, "PRAGMA journal_mode=WAL");
  const bool ahead = wanted.step() == SQLITE_ROW && wanted.text(0) == "wal";
  (void)done(file, ahead ? "PRAGMA synchronous=FULL" : "PRAGMA synchronous=EXTRA");
}

fs::path beside(const fs::path& path, const char* ending) { return path.string() + ending; }

/// As a URI of SQLite.
std::string uri_of(const fs::path& path, const char* options) {
  std::string uri = "file:";
  for (const char c : path.string()) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '%' || c == '?' || c == '#' || byte < 0x21)
      uri += fmt::format("%{:02X}", byte);
    else
      uri += c;
  }
  return uri + options;
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
  Json object = json_in(content);
  if (!object.is_object()) object = Json::object();
  Json list = Json::array();
  for (const PackedFile& one : files)
    list.push_back(object_of("role"_is(one.file.role), "name"_is(one.file.name), "sha256"_is(one.file.sha256),
                             "bytes"_is(one.file.bytes), "kept"_is(one.file.kept)));
  object["files"] = std::move(list);
  return one_line(object);
}

/// One line of text that is UTF-8: SQLite hands back what it was given only then.
std::string clean(const std::string& text) {
  const Json word = Json::parse(one_line(Json(text)), nullptr, false);
  return word.is_string() ? word.get<std::string>() : std::string();
}

/// An entry that is complete but for its place in the chain.
struct NextEntry {
  LogbookEntry entry;
  std::vector<PackedFile> files;
};

NextEntry next_entry(const LogRecord& record) {
  NextEntry next{{}, packed_files(record)};
  next.entry.time = record.time.empty() ? now_utc() : record.time;
  next.entry.kind = clean(record.kind);
  next.entry.machine = clean(record.machine);
  next.entry.serial_number = clean(record.serial_number);
  next.entry.operator_name = clean(record.operator_name);
  next.entry.instrument = clean(record.instrument);
  next.entry.summary = clean(record.summary);
  next.entry.content = content_with(record.content, next.files);
  return next;
}

/// Number and hash of the last entry; false: they cannot be read.
bool take_last(sqlite3* file, std::int64_t& number, std::string& hash) {
  Statement last(file, "SELECT number, hash FROM entry ORDER BY number DESC LIMIT 1");
  const int step = last.step();
  number = step == SQLITE_ROW ? last.number(0) : 0;
  hash = step == SQLITE_ROW ? last.text(1) : no_previous();
  return step == SQLITE_ROW || step == SQLITE_DONE;
}

bool put(sqlite3* file, const NextEntry& next) {
  for (const PackedFile& one : next.files) {
    if (!one.file.kept) continue;
    Statement row(file, "INSERT OR IGNORE INTO original VALUES(?, ?, ?)");
    if (row.with(one.file.sha256).with(static_cast<std::int64_t>(one.file.bytes)).with_bytes(one.bytes).step() !=
        SQLITE_DONE)
      return false;
  }
  const LogbookEntry& entry = next.entry;
  Statement row(file, "INSERT INTO entry VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  row.with(entry.number);
  for (const std::string* part : {&entry.time, &entry.kind, &entry.machine, &entry.serial_number, &entry.operator_name,
                                  &entry.instrument, &entry.summary, &entry.content, &entry.previous, &entry.hash})
    row.with(*part);
  return row.step() == SQLITE_DONE;
}

}  // namespace

Logbook::Copy::~Copy() {
  if (!folder.empty()) disc::remove_all(folder);
}

void Logbook::Close::operator()(sqlite3* file) const noexcept { sqlite3_close_v2(file); }

/// The log beside the file is carried into it by the last program that closes it, and by no other: SQLite before 3.51.3
/// can lose pages where one carries over while others write (sqlite.org/wal.html, "the WAL-reset bug").
Result<Logbook> Logbook::opened(const fs::path& path, const std::string& name, int flags) {
  sqlite3* file = nullptr;
  const int result = sqlite3_open_v2(name.c_str(), &file, flags, nullptr);
  Logbook book(path, file);
  if (result != SQLITE_OK) return tl::unexpected(sqlite_fault(path, file));
  sqlite3_busy_timeout(file, kMostWaiting_ms);
  sqlite3_limit(file, SQLITE_LIMIT_LENGTH, kLongestLogValue);
  const StopsReading stops(file);
  if (!done(file,
            "PRAGMA synchronous=EXTRA; PRAGMA wal_autocheckpoint=0; PRAGMA cell_size_check=ON; PRAGMA "
            "trusted_schema=OFF")) {
    const int code = sqlite3_errcode(file);
    if (code == SQLITE_CORRUPT || code == SQLITE_ERROR)  // the definitions of its tables are no SQL
      if (auto changed = schema_fault(path, file)) return tl::unexpected(std::move(*changed));
    return tl::unexpected(sqlite_fault(path, file));
  }
  return book;
}

/// Where nothing can be made beside the file: as it is, or with its write-ahead log as a copy.
Result<Logbook> Logbook::opened_unwritable(const fs::path& path) {
  std::error_code error;
  const auto ahead = fs::file_size(beside(path, kWriteAhead), error);
  if (error || ahead == 0) return opened(path, uri_of(path, "?immutable=1"), SQLITE_OPEN_READONLY | SQLITE_OPEN_URI);
  std::string name = (fs::temp_directory_path(error) / "ecs-logbook-XXXXXX").string();
  const char* made = error ? nullptr : ::mkdtemp(name.data());
  auto copy = std::make_unique<Copy>();
  if (made != nullptr) copy->folder = made;
  const fs::path there = copy->folder / "copy.ecslog";
  if (made == nullptr || !fs::copy_file(path, there, error) ||
      !fs::copy_file(beside(path, kWriteAhead), beside(there, kWriteAhead), error))
    return tl::unexpected(file_fault(path, ProblemKind::output,
                                     "cannot be read here: its last entries are in a second file in the same folder, "
                                     "and there is no space for a copy of both"));
  auto book = opened(path, there.string(), SQLITE_OPEN_READWRITE);
  if (book) book->copy_ = std::move(copy);
  return book;
}

Result<Logbook> Logbook::open(const fs::path& path) {
  if (disc::is_folder(path))
    return tl::unexpected(file_fault(path, ProblemKind::output, "expected a file, found a folder"));
  auto book = opened(path, path.string(), SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE);
  if (!book) return book;
  sqlite3* file = book->file_.get();
  const StopsReading stops(file);
  if (is_empty(file)) {
    Transaction all(file);
    if (!all.open()) return tl::unexpected(sqlite_fault(path, file));
    if (is_empty(file)) {  // no other program was faster
      const std::string begun = fmt::format("{}; {}; PRAGMA application_id={}; PRAGMA user_version={};", kEntryTable,
                                            kOriginalTable, kApplication, kFormat);
      if (!done(file, begun.c_str())) return tl::unexpected(sqlite_fault(path, file));
      book->is_new_ = true;
    }
    if (!all.commit()) return tl::unexpected(sqlite_fault(path, file));
  }
  if (pragma(file, "application_id") != kApplication) {
    const int code = sqlite3_errcode(file);
    const bool unreadable = code == SQLITE_BUSY || code == SQLITE_CANTOPEN || code == SQLITE_READONLY;
    return tl::unexpected(unreadable ? sqlite_fault(path, file)
                                     : file_fault(path, ProblemKind::bad_input, "not a logbook of ECS"));
  }
  if (const auto format = pragma(file, "user_version"); format != kFormat)
    return tl::unexpected(
        file_fault(path, ProblemKind::bad_input,
                   fmt::format("is a logbook of format {}; this program writes format {}", format, kFormat)));
  if (auto changed = schema_fault(path, file)) return tl::unexpected(std::move(*changed));
  choose_journal(file);
  return book;
}

Result<Logbook> Logbook::open_to_read(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error)) return tl::unexpected(file_fault(path, ProblemKind::bad_input, "no such logbook"));
  if (fs::is_directory(path, error) || fs::file_size(path, error) == 0)
    return tl::unexpected(file_fault(path, ProblemKind::bad_input, "not a logbook of ECS"));
  auto book = opened(path, path.string(), SQLITE_OPEN_READWRITE);
  const bool readable = book && (pragma(book->file_.get(), "application_id") != -1 ||
                                 sqlite3_errcode(book->file_.get()) == SQLITE_NOTADB ||
                                 sqlite3_errcode(book->file_.get()) == SQLITE_BUSY);
  if (!readable) {
    auto as_it_is = opened_unwritable(path);
    if (!book || as_it_is) book = std::move(as_it_is);
    if (!book) return book;
  }
  sqlite3* file = book->file_.get();
  const StopsReading stops(file);
  const std::int64_t application = pragma(file, "application_id");
  if (application == -1 && sqlite3_errcode(file) != SQLITE_NOTADB) return tl::unexpected(sqlite_fault(path, file));
  if (application != kApplication || pragma(file, "user_version") != kFormat)
    return tl::unexpected(file_fault(path, ProblemKind::bad_input, "not a logbook of ECS, or of another format"));
  if (auto changed = schema_fault(path, file)) return tl::unexpected(std::move(*changed));
  return book;
}

Result<LogbookEntry> Logbook::append(const LogRecord& record) {
  ECS_TRY(entries, append_all({record}));
  return std::move(entries.front());
}

Result<std::vector<LogbookEntry>> Logbook::append_all(const std::vector<LogRecord>& records) {
  sqlite3* file = file_.get();
  std::vector<NextEntry> next;
  for (const LogRecord& record : records) next.push_back(next_entry(record));
  Transaction all(file);
  if (!all.open()) return tl::unexpected(sqlite_fault(path_, file));
  ECS_TRY(of, owner());
  std::int64_t number = 0;
  std::string previous;
  if (!take_last(file, number, previous)) return tl::unexpected(sqlite_fault(path_, file));
  std::vector<LogbookEntry> written;
  for (NextEntry& one : next) {
    LogbookEntry& entry = one.entry;
    const LogOwner about{entry.machine, entry.serial_number};
    if (!belongs(of, about))
      return tl::unexpected(
          file_fault(path_, ProblemKind::refused,
                     fmt::format("this is the logbook of {}, not of {}", in_words(of), in_words(about))));
    if (of.machine.empty()) of.machine = about.machine;
    if (of.serial_number.empty()) of.serial_number = about.serial_number;
    entry.number = ++number;
    entry.previous = previous;
    previous = entry.hash = hash_of(entry);
    if (!put(file, one)) return tl::unexpected(sqlite_fault(path_, file));
    written.push_back(std::move(entry));
  }
  if (!all.commit()) return tl::unexpected(sqlite_fault(path_, file));
  return written;
}

}  // namespace ecs::commissioning
