// What a file is, by what is in it, for choosing among files and opening whatever is given; and the files that belong
// to a model, found in its folder.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

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

/// Why a file is of no use where one of this kind is asked for; empty: it is of this kind. "" is accepted.
[[nodiscard]] std::string refusal_as(FileKind wanted, const std::filesystem::path& path);

/// Empty: none was found.
struct FilesBeside {
  std::string machine;
  std::string parameters;
  std::vector<std::string> data;  ///< that the model was fitted to, else the measured file that is alone there
};

/// @param model  file, or one that does not exist yet: its folder counts
[[nodiscard]] FilesBeside files_beside(const std::filesystem::path& model);

}  // namespace ecs::commissioning
