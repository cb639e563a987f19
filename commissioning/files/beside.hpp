// Files that belong to a model, found in its folder: what forms fill in.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace ecs::commissioning {

/// Empty: none was found.
struct FilesBeside {
  std::string machine;
  std::string parameters;
  std::vector<std::string> data;  ///< that the model was fitted to, else the measured file that is alone there
};

/// @param model  file, or one that does not exist yet: its folder counts
[[nodiscard]] FilesBeside files_beside(const std::filesystem::path& model);

}  // namespace ecs::commissioning
