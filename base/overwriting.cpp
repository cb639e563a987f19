#include "base/overwriting.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>

namespace ecs {

bool would_overwrite(const std::string& path, const std::vector<std::string>& own) {
  std::error_code error;
  if (path.empty() || !std::filesystem::is_regular_file(path, error)) return false;
  if (std::filesystem::file_size(path, error) == 0 && !error) return false;
  return std::none_of(own.begin(), own.end(), [&](const std::string& file) {
    std::error_code missing;
    return std::filesystem::equivalent(file, path, missing);
  });
}

}  // namespace ecs
