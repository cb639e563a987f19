// The file of a logbook (SQLite): entries, each with the hash of the one before, and the files that they name.
// Entries are added, never changed; each is committed whole before append() returns. The only user of sqlite3.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "commissioning/logbook/entry.hpp"

struct sqlite3;

namespace ecs::commissioning {

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
  /// For reading and adding; made if it is missing. Refused, saying why, if the file is no logbook.
  [[nodiscard]] static Result<Logbook> open(const std::filesystem::path& path);
  /// For reading; `bad_input` where it is missing.
  [[nodiscard]] static Result<Logbook> open_to_read(const std::filesystem::path& path);

  /// @return the entry as it was written. Refused if the record is about another machine; `output` if it cannot be
  /// written: then the logbook is as it was.
  [[nodiscard]] Result<LogbookEntry> append(const LogRecord& record);

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
  [[nodiscard]] LogVerdict verified(const std::string& expected = {}) const;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// open() made the file.
  [[nodiscard]] bool is_new() const { return is_new_; }

 private:
  struct Close {
    void operator()(sqlite3* file) const noexcept;
  };
  Logbook(std::filesystem::path path, sqlite3* file) : path_(std::move(path)), file_(file) {}
  [[nodiscard]] static Result<Logbook> opened(const std::filesystem::path& path, bool create);

  std::filesystem::path path_;
  std::unique_ptr<sqlite3, Close> file_;
  bool is_new_ = false;
};

}  // namespace ecs::commissioning
