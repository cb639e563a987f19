// A logbook: entries (what was done, when, by whom, with which files, and the hash that ties each to the one before)
// and the file that holds them (SQLite) with the files that they name. Entries are added, never changed; each is
// committed whole and on the disc before append() returns. While a program has it open the newest entries are in the
// write-ahead log beside it (NAME.ecslog-wal); the last program that closes it carries them into the file and removes
// the log, after a crash the next one does. Does not live here: what is written when (recorder.hpp).
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/process.hpp"
#include "base/result.hpp"
#include "commissioning/session/records.hpp"

struct sqlite3;

namespace ecs::commissioning {

/// A file that took part, as it was then.
struct LogFile {
  std::string role;  ///< "input", "output", or "image" for the bytes that a unit holds
  std::string name;  ///< as the verb was given it, or its absolute path
  std::string sha256;
  std::uint64_t bytes = 0;
  bool kept = false;  ///< the logbook holds its bytes

  friend bool operator==(const LogFile&, const LogFile&) = default;
};

struct LogbookEntry {
  std::int64_t number = 0;  ///< from 1, without a gap
  std::string time;         ///< "2026-05-04T09:30:00Z"
  std::string kind;         ///< "measurement", "map", "activation", …: kLogKinds
  std::string machine;      ///< empty: not stated
  std::string serial_number;
  std::string operator_name;
  std::string instrument;  ///< JSON object (place.hpp); empty: none took part
  std::string summary;     ///< one line
  std::string content;     ///< JSON object: program, folder, words, files, answer …
  std::string previous;    ///< hash of the entry before; of the first 64 zeros
  std::string hash;        ///< hash_of() the others

  friend bool operator==(const LogbookEntry&, const LogbookEntry&) = default;
};

/// What the kinds are, in the order in which a commissioning meets them.
inline constexpr const char* kLogKinds[] = {
    "measurement",  "processing", "map",       "parameters", "transfer",           "activation",
    "rollback",     "model",      "diagnosis", "test",       "investigation step", "investigation",
    "memory write", "export",     "report",    "certificate"};

/// How the summary of a measurement ends that a verb read for the first time: the entry of that verb follows it and
/// those of its other files.
inline constexpr std::string_view kInputOfNext = ", input of the next entry";

/// SHA-256 over every other member, each as its length, a colon and its bytes: 64 hexadecimal digits.
[[nodiscard]] std::string hash_of(const LogbookEntry& entry);

/// Of the entry before the first.
[[nodiscard]] std::string no_previous();

/// The files that the content lists; none where it is no such JSON.
[[nodiscard]] std::vector<LogFile> files_of(const LogbookEntry& entry);
/// The words of the verb that wrote it, and the folder it ran in; empty where no verb did.
[[nodiscard]] std::vector<std::string> words_of(const LogbookEntry& entry);
[[nodiscard]] std::string folder_of(const LogbookEntry& entry);

inline constexpr std::string_view kLogbookExtension = ".ecslog";

/// Whose logbook it is: as the first entries that state them say.
struct LogOwner {
  std::string machine;
  std::string serial_number;
};

/// Whether an entry about `of` belongs into a logbook of `owner`: nothing that both state differs, and something
/// agrees, or the logbook is empty. A machine's name may be cut as the unit's identity cuts it.
[[nodiscard]] bool belongs(const LogOwner& owner, const LogOwner& of);
/// "moving column mill, serial number MCM-0107"
[[nodiscard]] std::string in_words(const LogOwner& owner);

/// A file that begins as SQLite files do, or did before its beginning was damaged: its size is that of whole pages.
[[nodiscard]] bool is_damaged_logbook(const std::filesystem::path& path);

/// What verify() found.
struct LogVerdict {
  std::size_t entries = 0;            ///< that fit, from the first
  std::string last_hash;              ///< of the last of them; empty: none
  std::optional<std::int64_t> first;  ///< number of the first entry that does not fit
  std::string why;                    ///< empty: all fit
  [[nodiscard]] bool whole() const { return why.empty(); }
};

class Logbook {
 public:
  /// For reading and adding; made if it is missing. Refused, saying why, if the file is no logbook, or holds a table, a
  /// trigger or a view that is none of a logbook.
  [[nodiscard]] static Result<Logbook> open(const std::filesystem::path& path);
  /// For reading, also where nothing can be written; `bad_input` where it is missing.
  [[nodiscard]] static Result<Logbook> open_to_read(const std::filesystem::path& path);

  /// Number, hashes and, where it is empty, the time are added. @pre each file of the record has its content
  /// @return the entry as it was written. Refused if the record is about another machine; `output` if it cannot be
  /// written: then the logbook is as it was.
  [[nodiscard]] Result<LogbookEntry> append(const LogRecord& record);
  /// Several, all of them or none: the disc is waited for once.
  [[nodiscard]] Result<std::vector<LogbookEntry>> append_all(const std::vector<LogRecord>& records);

  /// All in order, or with `without_content` all but that.
  [[nodiscard]] Result<std::vector<LogbookEntry>> entries(bool without_content = false) const;
  [[nodiscard]] Result<LogbookEntry> entry(std::int64_t number) const;
  /// The last one of a kind; nothing: none. @param until  not after this time; empty: whenever
  [[nodiscard]] Result<std::optional<LogbookEntry>> last_of(std::string_view kind, std::string_view until = {}) const;
  /// What became active, in order: activations and rollbacks.
  [[nodiscard]] Result<std::vector<LogbookEntry>> activations() const;
  /// Whether the bytes of a file with that hash are kept.
  [[nodiscard]] bool holds(const std::string& sha256) const;
  /// The bytes of a file that is kept. Refused if they are not those of this hash.
  [[nodiscard]] Result<std::string> original(const std::string& sha256) const;
  [[nodiscard]] Result<LogOwner> owner() const;
  [[nodiscard]] Result<std::size_t> count() const;
  /// Of the last entry; empty: none.
  [[nodiscard]] Result<std::string> last_hash() const;

  /// Reads everything: each entry against its hash and the one before, each kept file against its hash, then the
  /// structure of the file.
  /// @param expected  a hash that an entry must have, as a report or certificate states it; empty: none
  [[nodiscard]] LogVerdict verified(const std::string& expected = {},
                                    const std::atomic<bool>& cancelled = interrupted()) const;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Its file has still its name: nobody removed it or put another in its place.
  [[nodiscard]] bool is_in_place() const;
  /// open() made the file.
  [[nodiscard]] bool is_new() const { return is_new_; }

 private:
  struct Close {
    void operator()(sqlite3* file) const noexcept;
  };
  /// A folder that goes with it.
  struct Copy {
    std::filesystem::path folder;
    ~Copy();
  };
  Logbook(std::filesystem::path path, sqlite3* file) : path_(std::move(path)), file_(file) {}
  /// @param name  for SQLite  @param flags  of sqlite3_open_v2
  [[nodiscard]] static Result<Logbook> opened(const std::filesystem::path& path, const std::string& name, int flags);
  [[nodiscard]] static Result<Logbook> opened_unwritable(const std::filesystem::path& path);

  std::filesystem::path path_;
  std::unique_ptr<Copy> copy_;  ///< read in place of the file; null: the file itself is; outlives `file_`
  std::unique_ptr<sqlite3, Close> file_;
  bool is_new_ = false;
};

}  // namespace ecs::commissioning
