#include "modules/logbook/sqlite.hpp"

#include <chrono>
#include <condition_variable>
#include <mutex>

#include <fmt/format.h>
#include <zlib.h>

#include "base/file.hpp"

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
      return file_fault(path, ProblemKind::bad_input, "is no logbook of ECS");
    default:
      return file_fault(path, ProblemKind::output,
                        fmt::format("the logbook: {}", file == nullptr ? "out of memory" : sqlite3_errmsg(file)));
  }
}

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

}  // namespace ecs::commissioning
