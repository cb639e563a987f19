#include "commissioning/session/remembered.hpp"

#include <algorithm>
#include <filesystem>
#include <mutex>

#include "base/file.hpp"
#include "base/text.hpp"

namespace ecs::commissioning {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t kMostKept = 40;

fs::path list_file() {
  const auto folder = state_folder();
  return folder ? *folder / "recent-files" : fs::path();
}

}  // namespace

std::vector<std::string> recent_files() {
  const auto text = read_file(list_file());
  std::vector<std::string> files;
  if (!text) return files;
  std::error_code fault;
  for (const std::string_view line : lines_of(*text))
    if (!line.empty() && fs::is_regular_file(fs::path(line), fault)) files.emplace_back(line);
  return files;
}

void remember_file(const std::string& path) {
  std::error_code fault;
  const std::string whole = fs::absolute(path, fault).lexically_normal().string();
  if (fault || path.empty() || whole.find('\n') != std::string::npos || list_file().empty()) return;
  std::vector<std::string> files = recent_files();
  std::erase(files, whole);
  files.insert(files.begin(), whole);
  files.resize(std::min(files.size(), kMostKept));
  std::string text;
  for (const std::string& file : files) text += file + "\n";
  (void)write_file(list_file(), text);
}

namespace {

std::mutex phases_guard;
MeasuredPhases phases_remembered;

}  // namespace

void remember_measured_phases(const MeasuredPhases& phases) {
  const std::lock_guard lock(phases_guard);
  phases_remembered = phases;
}

MeasuredPhases measured_phases() {
  const std::lock_guard lock(phases_guard);
  return phases_remembered;
}

}  // namespace ecs::commissioning
