#include "commissioning/session/remembered.hpp"

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <mutex>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "commissioning/session/message.hpp"

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
  for (const std::string_view line : lines_of(*text))
    if (!line.empty() && disc::is_file(fs::path(line))) files.emplace_back(line);
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

namespace {

std::atomic<bool> failed{false};

std::filesystem::path file_of(const std::string& name) {
  const auto folder = state_folder();
  return folder ? *folder / "drafts" / (name + ".draft") : std::filesystem::path();
}

/// Those set aside, oldest first: laser.aside-0001.draft, laser.aside-0002.draft …
std::vector<std::filesystem::path> aside_of(const std::string& name) {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(file_of(name).parent_path(), error))
    if (entry.path().filename().string().starts_with(name + ".aside-")) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

Result<void> keep_draft(const std::string& name, const std::string& text) {
  const auto folder = state_folder();
  std::error_code error;
  if (folder) std::filesystem::create_directories(*folder / "drafts", error);
  auto kept = folder ? write_file(file_of(name), text) : tl::unexpected(folder.error());
  failed = !kept;
  if (!kept) log_event(Tone::bad, "unsaved work cannot be kept: " + to_text(kept.error()));
  return kept;
}

bool drafts_fail() { return failed; }

std::optional<Draft> draft_of(const std::string& name) {
  const std::filesystem::path path = file_of(name);
  struct stat facts {};
  if (path.empty() || ::stat(path.c_str(), &facts) != 0) return std::nullopt;
  auto text = read_file(path);
  if (!text) return std::nullopt;
  return Draft{fmt::format("{:%Y-%m-%d %H:%M}", fmt::localtime(facts.st_mtime)), std::move(*text)};
}

void drop_draft(const std::string& name) { disc::remove(file_of(name)); }

void set_draft_aside(const std::string& name) {
  const auto aside = aside_of(name);
  const std::size_t digits = name.size() + std::string_view(".aside-").size();
  const std::string last = aside.empty() ? "0" : aside.back().filename().string().substr(digits, 4);
  std::error_code error;  // the time of writing stays: it says when the work was done
  std::filesystem::rename(file_of(name), file_of(fmt::format("{}.aside-{:04}", name, integer_in(last).value_or(0) + 1)),
                          error);
}

std::size_t drafts_aside(const std::string& name) { return aside_of(name).size(); }

void exchange_draft(const std::string& name) {
  const auto aside = aside_of(name);
  if (aside.empty()) return;
  set_draft_aside(name);
  std::error_code error;
  std::filesystem::rename(aside.front(), file_of(name), error);
}

std::optional<Draft> offered_draft(const std::string& name) {
  if (const auto aside = aside_of(name); !aside.empty() && !draft_of(name)) {
    std::error_code error;
    std::filesystem::rename(aside.back(), file_of(name), error);
  }
  return draft_of(name);
}

}  // namespace ecs::commissioning
