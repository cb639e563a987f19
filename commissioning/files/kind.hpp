// What a file is, by what is in it: for choosing among files, and for opening whatever is given.
#pragma once

#include <filesystem>
#include <string>

#include "base/file_kind.hpp"

namespace ecs::commissioning {

/// What is known of a file after a look into it.
struct FileLook {
  FileKind kind = FileKind::other;
  std::string what;            ///< in a few words: "EXX, 498 readings  measurement CSV"
  bool wants_answers = false;  ///< measurements that do not say enough
  std::string why_not;         ///< of a file that nothing reads
};
/// Reads it as far as needed; what is too large is taken for what its beginning says.
[[nodiscard]] FileLook looked_at(const std::filesystem::path& path);

}  // namespace ecs::commissioning
