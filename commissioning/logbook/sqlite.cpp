#include "commissioning/logbook/sqlite.hpp"

#include <fmt/format.h>

namespace ecs::commissioning {

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

std::int64_t pragma(sqlite3* file, const char* name) {
  Statement one(file, fmt::format("PRAGMA {}", name));
  return one.step() == SQLITE_ROW ? one.number(0) : -1;
}

}  // namespace ecs::commissioning
