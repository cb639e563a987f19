// Statements and transactions of SQLite, and the compressed bytes of a kept file, for the files of this folder that
// open a logbook. Not for others.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <thread>

#include <sqlite3.h>

#include "base/process.hpp"
#include "base/result.hpp"

namespace ecs::commissioning {

inline constexpr std::size_t kLargestKept = 32u << 20;  // of a file that is named by its hash alone

[[nodiscard]] std::string packed(std::string_view content);
/// Nothing where it is not the file of that hash.
[[nodiscard]] std::optional<std::string> unpacked(const std::string& bytes, std::int64_t length,
                                                  const std::string& sha256);

/// Longest text or blob in a logbook, twice the longest file that it keeps (kLargestKept).
inline constexpr int kLongestLogValue = 64 << 20;

[[nodiscard]] Problem file_fault(const std::filesystem::path& path, ProblemKind kind, std::string what);
/// What went wrong last, in words.
[[nodiscard]] Problem sqlite_fault(const std::filesystem::path& path, sqlite3* file);

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
    too_long_ |=
        sqlite3_bind_text64(statement_, ++bound_, bytes, text.size(), SQLITE_TRANSIENT, SQLITE_UTF8) == SQLITE_TOOBIG;
    return *this;
  }
  Statement& with_bytes(const std::string& bytes) {
    too_long_ |=
        sqlite3_bind_blob64(statement_, ++bound_, bytes.data(), bytes.size(), SQLITE_TRANSIENT) == SQLITE_TOOBIG;
    return *this;
  }
  Statement& with(std::int64_t number) {
    sqlite3_bind_int64(statement_, ++bound_, number);
    return *this;
  }
  /// SQLITE_ROW, SQLITE_DONE or what went wrong.
  [[nodiscard]] int step() {
    if (too_long_) return SQLITE_TOOBIG;
    return statement_ == nullptr ? SQLITE_ERROR : sqlite3_step(statement_);
  }
  [[nodiscard]] std::string text(int column) const {
    const auto* bytes = static_cast<const char*>(sqlite3_column_blob(statement_, column));
    return bytes == nullptr ? std::string()
                            : std::string(bytes, static_cast<std::size_t>(sqlite3_column_bytes(statement_, column)));
  }
  [[nodiscard]] std::int64_t number(int column) const { return sqlite3_column_int64(statement_, column); }
  [[nodiscard]] int bytes(int column) const { return sqlite3_column_bytes(statement_, column); }
  [[nodiscard]] int type(int column) const { return sqlite3_column_type(statement_, column); }

 private:
  sqlite3_stmt* statement_ = nullptr;
  int bound_ = 0;
  bool too_long_ = false;
};

/// While it lives, reading that takes long ends with SQLITE_INTERRUPT once the flag is set: a file made to that end
/// keeps SQLite busy for ever. What is read in no time is read also after a signal, for the entry about what it has
/// ended.
/// @pre the file stays open
class StopsReading {
 public:
  explicit StopsReading(sqlite3* file, const std::atomic<bool>& asked = interrupted());

 private:
  std::jthread watch_;
};

/// The value of a pragma that is a number; -1: it cannot be asked.
[[nodiscard]] std::int64_t pragma(sqlite3* file, const char* name);

/// Takes back what was started, unless it is committed.
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

}  // namespace ecs::commissioning
