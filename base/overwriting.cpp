#include "base/overwriting.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include <fmt/format.h>

#include "base/file_watch.hpp"

namespace ecs {

namespace {

Result<void> unless_there(const std::vector<std::string>& files, const std::vector<std::string>& own,
                          std::string_view instead) {
  for (const std::string& file : files)
    if (would_overwrite(file, own))
      return problem(ProblemKind::usage, fmt::format("{} exists already: {}", file, instead));
  return {};
}

}  // namespace

bool would_overwrite(const std::string& path, const std::vector<std::string>& own) {
  std::error_code error;
  if (const FileWatch* watch = FileWatch::current(); watch != nullptr && watch->replaces_disc()) return false;
  if (path.empty() || !std::filesystem::is_regular_file(path, error)) return false;
  if (std::filesystem::file_size(path, error) == 0 && !error) return false;
  return std::none_of(own.begin(), own.end(), [&](const std::string& file) {
    std::error_code missing;
    return std::filesystem::equivalent(file, path, missing);
  });
}

Result<void> spared(const std::vector<std::string>& files, bool force, const std::vector<std::string>& own) {
  return force ? Result<void>() : unless_there(files, own, "give another name, or --force to overwrite it");
}

Result<void> none_there(const std::vector<std::string>& files, std::string_view instead) {
  return unless_there(files, {}, instead);
}

}  // namespace ecs
