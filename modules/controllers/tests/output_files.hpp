// Three files of an export, and how many files a folder holds.
#pragma once

#include <filesystem>
#include <vector>

#include "modules/controllers/export.hpp"
#include "tests/support/folder.hpp"

namespace ecs::commissioning {

inline std::vector<OutputFile> three(const Folder& folder) {
  return {{folder / "x.comp", "new x"}, {folder / "y.comp", "new y"}, {folder / "z.comp", "new z"}};
}

inline std::size_t entries_in(const Folder& folder) {
  const std::filesystem::directory_iterator all(folder / "");
  return static_cast<std::size_t>(std::distance(begin(all), end(all)));
}

}  // namespace ecs::commissioning
