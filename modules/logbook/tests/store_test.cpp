// The file of a logbook: the chain of hashes, damage, crashes, two writers, no room, no permission.
#include "modules/logbook/store.hpp"

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <random>
#include <thread>

#include <fmt/format.h>
#include <sqlite3.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/file.hpp"
#include "modules/logbook/sqlite.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/ordinary_user.hpp"
#include "tests/support/test.hpp"

namespace ecs::commissioning {
namespace {

LogRecord entry_of(const std::string& summary, const std::string& content = "") {
  LogRecord record{.kind = "measurement",
                   .machine = "short lathe",
                   .serial_number = "MCM-0107",
                   .summary = summary,
                   .content = R"({"verb":"laser import"})",
                   .operator_name = "Jo Fitter"};
  if (!content.empty()) record.files.push_back({"input", "exx.csv", std::make_shared<const std::string>(content)});
  return record;
}

/// Readings of about this many bytes, another text for every seed.
std::string readings_of(int seed, std::size_t bytes) {
  std::mt19937 chance(static_cast<unsigned>(seed));
  std::string text = "axis,sense,x_mm,reading\n";
  while (text.size() < bytes)
    text += fmt::format("X,EX,{},{}\n", chance() % 4000, static_cast<int>(chance() % 2000) / 100.0);
  return text;
}

Logbook book_of(const std::string& path, int entries) {
  auto book = must(Logbook::open(path));
  for (int i = 0; i < entries; ++i) REQUIRE(book.append(entry_of(fmt::format("run {}", i + 1), readings_of(i, 600))));
  return book;
}

/// A number of the environment, for the long runs of scripts/logbook_endurance.
int count_or(const char* name, int otherwise) {
  const char* set = std::getenv(name);
  return set == nullptr ? otherwise : std::atoi(set);
}

TEST_CASE("each entry holds the hash of the one before, the first one zeros") {
  const Folder folder;
  const Logbook book = book_of(folder / "a.ecslog", 3);
  const auto entries = must(book.entries());
  REQUIRE(entries.size() == 3);
  CHECK(entries[0].previous == std::string(64, '0'));
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(entries[i].number == static_cast<std::int64_t>(i) + 1);
    CHECK(entries[i].hash == hash_of(entries[i]));
    if (i > 0) CHECK(entries[i].previous == entries[i - 1].hash);
  }
  CHECK(book.verified().whole());
  CHECK(book.verified().last_hash == entries[2].hash);
}

TEST_CASE("a file comes back as it was, and is named by its hash") {
  const Folder folder;
  auto book = must(Logbook::open(folder / "a.ecslog"));
  const std::string text = readings_of(7, 5000);
  const auto entry = must(book.append(entry_of("one", text)));
  const auto files = files_of(entry);
  CHECK(only(files).sha256 == sha256_hex(text));
  CHECK(files[0].bytes == text.size());
  CHECK(files[0].kept);
  CHECK(book.original(files[0].sha256) == text);
}

TEST_CASE("a logbook takes no entry of another machine") {
  const Folder folder;
  Logbook book = book_of(folder / "a.ecslog", 1);
  LogRecord other = entry_of("other");
  other.serial_number = "MCM-0999";
  const auto refused = must_fail(book.append(other));
  CHECK(refused.kind == ProblemKind::refused);
  check_holds(refused.message, {"short lathe, serial number MCM-0107", "MCM-0999"});
  CHECK(book.count() == 1U);
}

TEST_CASE("a file that is no logbook is told, and left as it is") {
  const Folder folder;
  const std::string path = folder.with("a.ecslog", "axis,sense,reading\nX,EX,1\n");
  for (const auto& opened : {Logbook::open(path), Logbook::open_to_read(path)}) {
    REQUIRE_FALSE(opened);
    CHECK(contains(opened.error().message, "not a logbook of ECS"));
  }
  CHECK(content_of(path) == "axis,sense,reading\nX,EX,1\n");
}

TEST_CASE("an end that was removed is found by the last hash") {
  const Folder folder;
  { const Logbook three = book_of(folder / "a.ecslog", 3); }
  std::filesystem::copy_file(folder / "a.ecslog", folder / "shorter.ecslog");
  auto book = must(Logbook::open(folder / "a.ecslog"));
  const auto last = must(book.append(entry_of("the last")));
  CHECK(book.verified(last.hash).whole());
  const auto shorter = must(Logbook::open_to_read(folder / "shorter.ecslog"));
  CHECK(shorter.verified().whole());
  const LogVerdict verdict = shorter.verified(last.hash);
  CHECK_FALSE(verdict.whole());
  CHECK(verdict.first == 4);
}

/// All that a reader sees of a logbook.
struct Seen {
  std::vector<LogbookEntry> entries;
  std::vector<std::string> files;
  friend bool operator==(const Seen&, const Seen&) = default;
};

std::optional<Seen> seen_in(const Logbook& book) {
  auto entries = book.entries();
  if (!entries) return std::nullopt;
  Seen seen{std::move(*entries), {}};
  for (const LogbookEntry& entry : seen.entries)
    for (const LogFile& file : files_of(entry)) {
      auto content = book.original(file.sha256);
      if (!content) return std::nullopt;
      seen.files.push_back(std::move(*content));
    }
  return seen;
}

TEST_CASE("every flipped byte that changes an entry is found") {
  const Folder folder;
  Seen whole;
  {
    const Logbook book = book_of(folder / "a.ecslog", 12);
    whole = seen_in(book).value();
  }
  const std::string bytes = content_of(folder / "a.ecslog");
  const int flips = count_or("ECS_LOGBOOK_FLIPS", 300);
  std::mt19937 chance(static_cast<unsigned>(count_or("ECS_LOGBOOK_SEED", 1)));
  int changed = 0, found = 0, found_elsewhere = 0;
  const std::string path = folder / "flipped.ecslog";
  for (int i = 0; i < flips; ++i) {
    std::string flipped = bytes;
    const std::size_t at = chance() % flipped.size();
    flipped[at] = static_cast<char>(flipped[at] ^ static_cast<char>(1 + chance() % 255));
    std::ofstream(path, std::ios::binary) << flipped;
    const auto book = Logbook::open_to_read(path);
    const bool is_changed = !book || seen_in(*book) != whole;
    const bool is_found = !book || !book->verified().whole();
    changed += is_changed ? 1 : 0;
    found += is_changed && is_found ? 1 : 0;
    found_elsewhere += !is_changed && is_found ? 1 : 0;
    if (is_changed) CHECK_MESSAGE(is_found, "byte ", at);
  }
  CHECK(found == changed);
  CHECK(changed > flips / 10);
  MESSAGE(flips, " flips in ", bytes.size(), " bytes: ", changed, " changed an entry, ", found, " of them found; ",
          found_elsewhere, " found that changed none");
}

TEST_CASE("a logbook that nobody has open is one file, whoever closed it last") {
  const Folder folder;
  const std::string path = folder / "a.ecslog";
  const auto files = [&] {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path))
      names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
  };
  {
    const Logbook book = book_of(path, 2);
    CHECK(files() == std::vector<std::string>{"a.ecslog", "a.ecslog-shm", "a.ecslog-wal"});
    CHECK(must(Logbook::open_to_read(path)).count() == 2U);
  }
  CHECK(files() == std::vector<std::string>{"a.ecslog"});
  {
    const auto reads = must(Logbook::open_to_read(path));
    auto writes = Logbook::open(path);
    REQUIRE(writes);
    REQUIRE(writes->append(entry_of("while another reads")));
    writes = problem(ProblemKind::output, "closed");
    CHECK(reads.count() == 3U);
  }
  CHECK(files() == std::vector<std::string>{"a.ecslog"});
  CHECK(Logbook::open_to_read(path)->verified().entries == 3);
}

TEST_CASE("several entries are one step: all of them, chained, or none") {
  const Folder folder;
  auto book = must(Logbook::open(folder / "a.ecslog"));
  REQUIRE(book.append_all({entry_of("first"), entry_of("second"), entry_of("third")}));
  LogRecord other = entry_of("of another machine");
  other.machine = "another machine";
  CHECK_FALSE(book.append_all({entry_of("fourth"), other}));
  CHECK(book.count() == 3U);
  CHECK(book.verified().entries == 3);
}

TEST_CASE("a logbook of the time before the write-ahead log is read, and goes on") {
  const Folder folder;
  const std::string path = folder / "a.ecslog";
  { const Logbook book = book_of(path, 2); }
  std::string bytes = content_of(path);
  REQUIRE(bytes[18] == 2);
  bytes[18] = bytes[19] = 1;  // of the header: a rollback journal
  std::ofstream(path, std::ios::binary) << bytes;
  CHECK(Logbook::open_to_read(path)->verified().entries == 2);
  auto book = must(Logbook::open(path));
  REQUIRE(book.append(entry_of("then")));
  CHECK(book.verified().entries == 3);
}

/// Leaves a logbook as a crash leaves it: its last entries beside it.
void crash_with(const std::string& path, int entries) {
  const pid_t child = ::fork();
  if (child == 0) {
    auto book = Logbook::open(path);
    for (int i = 0; book && i < entries; ++i)
      (void)book->append(entry_of(fmt::format("run {}", i), readings_of(i, 50)));
    ::kill(::getpid(), SIGKILL);
  }
  ::waitpid(child, nullptr, 0);
}

TEST_CASE("what a crash left beside a logbook is read where nothing can be written, and belongs to it afterwards") {
  SKIP_UNLESS(::geteuid() == 0, "needs root, to become an ordinary user");
  const Folder folder;
  const std::string path = folder / "a.ecslog";
  crash_with(path, 3);
  REQUIRE(std::filesystem::file_size(path + "-wal") > 0);
  std::filesystem::remove(path + "-shm");  // as on a medium that the two files were copied to
  for (const char* ending : {"", "-wal"}) ::chmod((path + ending).c_str(), 0444);
  ::chmod(folder.path.c_str(), 0555);
  {
    const OrdinaryUser somebody;
    CHECK(must(Logbook::open_to_read(path)).verified().entries == 3);
  }
  ::chmod(folder.path.c_str(), 0755);
  { CHECK(Logbook::open_to_read(path)->count() == 3U); }
  CHECK_FALSE(std::filesystem::exists(path + "-wal"));
}

/// Adds entries until it is killed, and says the number of each when it is committed.
[[noreturn]] void write_without_end(const std::string& path, int say) {
  auto book = Logbook::open(path);
  for (int i = 0; book; ++i) {
    const auto entry = book->append(entry_of(fmt::format("run {}", i), readings_of(i, 400)));
    const std::int64_t number = entry ? entry->number : -1;
    if (::write(say, &number, sizeof number) != sizeof number || !entry) break;
  }
  ::_exit(1);
}

TEST_CASE("kill -9 at any moment loses no entry that was committed") {
  const int kills = count_or("ECS_LOGBOOK_KILLS", 40);
  constexpr int kKillsInOneFile = 50;
  std::mt19937 chance(static_cast<unsigned>(count_or("ECS_LOGBOOK_SEED", 1)));
  std::int64_t committed = 0;
  int lost = 0, not_whole = 0;
  Folder folder;
  for (int i = 0; i < kills; ++i) {
    const std::string path = folder / fmt::format("{}.ecslog", i / kKillsInOneFile);
    int pipe[2];
    REQUIRE(::pipe(pipe) == 0);
    const pid_t child = ::fork();
    if (child == 0) write_without_end(path, pipe[1]);
    ::close(pipe[1]);
    std::this_thread::sleep_for(std::chrono::microseconds(chance() % 25'000));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    std::int64_t last = 0;
    for (std::int64_t number = 0; ::read(pipe[0], &number, sizeof number) == sizeof number; last = number) ++committed;
    ::close(pipe[0]);
    const auto book = must(Logbook::open(path));
    const auto count = must(book.count());
    if (static_cast<std::int64_t>(count) < last) ++lost;
    const LogVerdict verdict = book.verified();
    if (!verdict.whole() || verdict.entries != count) ++not_whole;
    if (i % kKillsInOneFile == kKillsInOneFile - 1) std::filesystem::remove(path);
  }
  CHECK(lost == 0);
  CHECK(not_whole == 0);
  MESSAGE(kills, " kills, ", committed, " entries committed, logbooks that lost one: ", lost,
          ", not whole: ", not_whole);
}

TEST_CASE("two programs that write at once wait for each other, and the chain stays whole") {
  const Folder folder;
  const std::string path = folder / "a.ecslog";
  constexpr int kEach = 25;
  std::vector<pid_t> children;
  for (int writer = 0; writer < 3; ++writer) {
    children.push_back(::fork());
    if (children.back() != 0) continue;
    for (int i = 0; i < kEach; ++i) {
      auto book = Logbook::open(path);
      if (!book || !book->append(entry_of(fmt::format("writer {} run {}", writer, i)))) ::_exit(1);
    }
    ::_exit(0);
  }
  for (const pid_t child : children) {
    int status = 1;
    ::waitpid(child, &status, 0);
    CHECK(status == 0);
  }
  const auto book = must(Logbook::open_to_read(path));
  const LogVerdict verdict = book.verified();
  CHECK_MESSAGE(verdict.whole(), verdict.why);
  CHECK(verdict.entries == 3 * kEach);
}

TEST_CASE("without room for an entry the logbook stays as it was, and takes one when there is room again") {
  const Folder folder;
  const std::string path = folder / "a.ecslog";
  { const Logbook book = book_of(path, 4); }
  const auto size = std::filesystem::file_size(path);
  const pid_t child = ::fork();
  if (child == 0) {
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit no_more{size, size};
    ::setrlimit(RLIMIT_FSIZE, &no_more);
    auto book = Logbook::open(path);
    const auto entry =
        book ? book->append(entry_of("too much", readings_of(99, 200'000))) : tl::unexpected(book.error());
    ::_exit(entry || entry.error().kind != ProblemKind::output ? 1 : 0);
  }
  int status = 1;
  ::waitpid(child, &status, 0);
  CHECK(status == 0);
  auto book = must(Logbook::open(path));
  CHECK(book.verified().whole());
  CHECK(book.count() == 4U);
  CHECK(book.append(entry_of("again")));
  CHECK(book.verified().entries == 5);
}

TEST_CASE("on a full disc nothing is half written, and nothing that was committed is lost") {
  SKIP_UNLESS(::geteuid() == 0, "needs root, to mount a small file system");
  const Folder folder;
  const std::string disc = folder / "disc";
  std::filesystem::create_directory(disc);
  SKIP_UNLESS(::mount("none", disc.c_str(), "tmpfs", 0, "size=400k") == 0, "no file system can be mounted here");
  const std::string path = disc + "/a.ecslog";
  std::size_t committed = 0;
  {
    auto book = must(Logbook::open(path));
    Result<LogbookEntry> entry = book.append(entry_of("the first"));
    for (int i = 0; entry && i < 1000; ++i, ++committed)
      entry = book.append(entry_of(fmt::format("run {}", i), readings_of(i, 2'000)));
    REQUIRE_FALSE(entry);
    CHECK(entry.error().kind == ProblemKind::output);
    CHECK(contains(entry.error().message, "disc is full"));
    CHECK(book.count() == committed);
  }
  { CHECK(must(Logbook::open_to_read(path)).verified().entries == committed); }
  REQUIRE(::mount("none", disc.c_str(), "tmpfs", MS_REMOUNT, "size=4m") == 0);
  {
    auto book = must(Logbook::open(path));
    REQUIRE(book.append(entry_of("with room again")));
    CHECK(book.verified().entries == committed + 1);
  }
  CHECK_FALSE(std::filesystem::exists(path + "-wal"));
  ::umount2(disc.c_str(), MNT_DETACH);
}

TEST_CASE("in a folder without permission to write a logbook is read, and says that it cannot be written") {
  SKIP_UNLESS(::geteuid() == 0, "needs root, to become an ordinary user");
  const Folder folder;
  const std::string path = folder / "a.ecslog";
  { const Logbook book = book_of(path, 2); }
  ::chmod(path.c_str(), 0444);
  ::chmod(folder.path.c_str(), 0555);
  {
    const OrdinaryUser somebody;
    CHECK(must(Logbook::open_to_read(path)).verified().whole());
    auto book = Logbook::open(path);
    const auto entry = must_fail(book ? book->append(entry_of("no")) : tl::unexpected(book.error()));
    CHECK(entry.kind == ProblemKind::output);
    CHECK(contains(entry.message, "permission"));
  }
  ::chmod(folder.path.c_str(), 0755);
}

/// What another program does to the file.
void changed_by(const std::string& path, const std::string& sql) {
  sqlite3* file = nullptr;
  REQUIRE(sqlite3_open(path.c_str(), &file) == SQLITE_OK);
  char* fault = nullptr;
  sqlite3_exec(file, sql.c_str(), nullptr, nullptr, &fault);
  CHECK_MESSAGE(fault == nullptr, fault);
  sqlite3_free(fault);
  sqlite3_close(file);
}

TEST_CASE("a logbook with a trigger, a view or another table is refused by name, before anything is read or added") {
  constexpr const char* kRename = "PRAGMA writable_schema=ON; ALTER TABLE entry RENAME TO entries; ";
  const std::pair<std::string, const char*> changes[] = {
      {"CREATE TRIGGER empties AFTER INSERT ON entry BEGIN DELETE FROM entry; END", "trigger \"empties\""},
      {"CREATE VIEW seen AS SELECT * FROM entry", "view \"seen\""},
      {"CREATE TABLE more(x)", "table \"more\""},
      {"CREATE INDEX by_time ON entry(time)", "index \"by_time\""},
      {"ALTER TABLE entry ADD COLUMN more TEXT", "table \"entry\""},
      {"DROP TABLE original", "no table original"},
      {std::string(kRename) + "CREATE VIEW entry AS WITH RECURSIVE c(n) AS (SELECT 1 UNION ALL SELECT n + 1 FROM c) "
                              "SELECT n AS number FROM c WHERE n < 0",
       "table \"entries\""},
      {"PRAGMA writable_schema=ON; UPDATE sqlite_master SET sql='nonsense' WHERE name='entry'", "malformed"}};
  for (const auto& [sql, named] : changes) {
    CAPTURE(sql);
    const Folder folder;
    const std::string path = folder / "a.ecslog";
    { const Logbook book = book_of(path, 2); }
    changed_by(path, sql);
    const std::string before = content_of(path);
    for (const auto& opened : {Logbook::open(path), Logbook::open_to_read(path)}) {
      REQUIRE_FALSE(opened);
      CHECK(opened.error().kind == ProblemKind::bad_input);
      CHECK(contains(opened.error().message, "changed by another program"));
      CHECK_MESSAGE(contains(opened.error().message, named), opened.error().message);
    }
    CHECK(content_of(path) == before);
  }
}

TEST_CASE("the check of a logbook ends soon after it was asked to stop") {
  const Folder folder;
  const std::string path = folder / "a.ecslog";
  { const Logbook book = book_of(path, 1); }
  // 400 files of 32 MiB of one letter, each to be unpacked and hashed: minutes, from a file of 13 MB
  const std::string zeros = packed(std::string(kLargestKept, 'x'));
  {
    sqlite3* file = nullptr;
    REQUIRE(sqlite3_open(path.c_str(), &file) == SQLITE_OK);
    for (int i = 0; i < 400; ++i) {
      Statement row(file, "INSERT INTO original VALUES(?, ?, ?)");
      REQUIRE(row.with(fmt::format("{:064}", i)).with(std::int64_t{kLargestKept}).with_bytes(zeros).step() ==
              SQLITE_DONE);
    }
    sqlite3_close(file);
  }
  const auto book = must(Logbook::open_to_read(path));
  std::atomic<bool> asked{false};
  std::jthread later([&asked] {
    std::this_thread::sleep_for(std::chrono::milliseconds(600));
    asked = true;
  });
  const auto begun = std::chrono::steady_clock::now();
  const LogVerdict verdict = book.verified({}, asked);
  CHECK(std::chrono::steady_clock::now() - begun < std::chrono::seconds(20));
  CHECK_FALSE(verdict.whole());
  CHECK(contains(verdict.why, "stopped before the end"));
  CHECK(book.count() == 1U);  // what is short is answered all the same
}

TEST_CASE("a logbook that gives more rows than its file can hold is damaged, not read without end") {
  const Folder folder;
  const std::string path = folder / "a.ecslog";
  { const Logbook book = book_of(path, 60); }
  std::string bytes = content_of(path);
  const auto byte = [&bytes](std::size_t at) { return static_cast<unsigned char>(bytes[at]); };
  const auto put_two = [&bytes](std::size_t at, std::size_t value) {
    bytes[at] = static_cast<char>(value >> 8);
    bytes[at + 1] = static_cast<char>(value & 0xFF);
  };
  // The root of the table entry, page 2 (sqlite.org/fileformat2.html, 1.6): 600 cells in place of its few, all of
  // them the first one, which leads to one leaf.
  constexpr std::size_t kRoot = 4096, kCells = 600;
  REQUIRE(byte(kRoot) == 5);  // an interior page
  const std::size_t first = byte(kRoot + 12) * std::size_t{256} + byte(kRoot + 13);
  put_two(kRoot + 3, kCells);
  for (std::size_t i = 0; i < kCells; ++i) put_two(kRoot + 12 + 2 * i, first);
  std::ofstream(path, std::ios::binary) << bytes;
  const auto book = must(Logbook::open_to_read(path));
  CHECK(contains(must_fail(book.entries()).message, "it gives more than it contains"));
  CHECK_FALSE(book.verified().whole());
}

TEST_CASE("a value longer than any entry of ECS is refused, not read") {
  const Folder folder;
  const std::string path = folder / "a.ecslog";
  { const Logbook book = book_of(path, 1); }
  changed_by(path, "UPDATE entry SET summary = printf('%.*c', 70000000, 'x')");
  const auto book = must(Logbook::open_to_read(path));
  CHECK(contains(must_fail(book.entries()).message, "longer than 64 MiB"));
  CHECK_FALSE(book.verified().whole());
}

TEST_CASE("bytes that are no UTF-8 are replaced, and the entry fits its hash") {
  const Folder folder;
  auto book = must(Logbook::open(folder / "a.ecslog"));
  LogRecord odd = entry_of(std::string("sp\xFFot\0te", 8));
  REQUIRE(book.append(odd));
  const LogVerdict verdict = book.verified();
  CHECK_MESSAGE(verdict.whole(), verdict.why);
}

}  // namespace
}  // namespace ecs::commissioning
