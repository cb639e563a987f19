// What a thread reads and writes through base/file.hpp, seen by whoever keeps a record of it, or answered from a record
// in place of the disc.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "base/result.hpp"

namespace ecs {

/// From its construction to its end it sees the whole files that this thread reads and writes. One inside another takes
/// its place until it ends.
class FileWatch {
 public:
  FileWatch();
  FileWatch(const FileWatch&) = delete;
  FileWatch& operator=(const FileWatch&) = delete;
  virtual ~FileWatch();

  /// Of this thread; null: none.
  [[nodiscard]] static FileWatch* current();

  /// It answers in place of the disc: nothing is read from there and nothing written to it.
  [[nodiscard]] virtual bool replaces_disc() const { return false; }
  /// Only where it replaces the disc: the content, or why there is none.
  [[nodiscard]] virtual Result<std::string> content(const std::filesystem::path& path);

  virtual void was_read(const std::filesystem::path& path, std::string_view content) = 0;
  /// Also what would have been written, where it replaces the disc.
  virtual void was_written(const std::filesystem::path& path, std::string_view content) = 0;

 private:
  FileWatch* before_;
};

/// Nothing of this thread is seen, and all of it comes from the disc, to its end: for keys and tokens.
class Unwatched {
 public:
  Unwatched();
  Unwatched(const Unwatched&) = delete;
  Unwatched& operator=(const Unwatched&) = delete;
  ~Unwatched();

 private:
  FileWatch* before_;
};

/// Whether there is such a file, on the disc or in what replaces it.
[[nodiscard]] bool is_there(const std::filesystem::path& path);

/// At most that many bytes from its beginning, from the disc or from what replaces it; empty where it cannot be read.
/// Not seen by a watch.
[[nodiscard]] std::string head_of(const std::filesystem::path& path, std::size_t bytes);

}  // namespace ecs
