// Folders in place of the files of a verb that takes several. Does not live here: reading them (files.hpp).
#pragma once

#include <string>
#include <vector>

#include "base/result.hpp"

namespace ecs::commissioning {

/// The files of a verb that takes several: in place of a folder stand the measurements in it, in the order of their
/// names. A folder without any is refused.
struct GivenFiles {
  std::vector<std::string> files;
  std::vector<std::string> notes;  ///< which were taken of a folder
};
/// @param with_paths  files of circles and diagonals are measurements too
[[nodiscard]] Result<GivenFiles> given_files(const std::vector<std::string>& words, bool with_paths = false);

}  // namespace ecs::commissioning
