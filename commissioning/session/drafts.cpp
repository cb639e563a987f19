#include "commissioning/session/drafts.hpp"

#include <atomic>
#include <filesystem>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include "base/file.hpp"
#include "commissioning/session/event_log.hpp"

namespace ecs::commissioning {
namespace {

std::atomic<bool> failed{false};

std::filesystem::path file_of(const std::string& name) {
  const auto folder = state_folder();
  return folder ? *folder / "drafts" / (name + ".draft") : std::filesystem::path();
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

void drop_draft(const std::string& name) {
  std::error_code error;
  std::filesystem::remove(file_of(name), error);
}

}  // namespace ecs::commissioning
