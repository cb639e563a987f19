// Files of real machines: those of samples/real and tests/data/real, and those that may not be passed on, in the folder
// $ECS_REAL_DATA.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

namespace ecs {

inline constexpr const char* kNoRealData = "ECS_REAL_DATA names no folder that holds this set";

/// A set or a file of one; empty where it is in none of the folders.
inline std::filesystem::path real_data(const std::string& name) {
  const char* const more = std::getenv("ECS_REAL_DATA");
  for (const std::filesystem::path root : {"samples/real", "tests/data/real", more == nullptr ? "" : more})
    if (!root.empty() && std::filesystem::exists(root / name)) return root / name;
  return {};
}

}  // namespace ecs
