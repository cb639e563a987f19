#include "commissioning/fleet/results_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <functional>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "base/file.hpp"
#include "base/text.hpp"

namespace ecs::commissioning {
namespace {

std::size_t labels_of(const FleetResult& result) { return std::hash<std::string>{}(result.type + '\n' + result.batch); }

std::array<std::uint8_t, 32> bytes_of(const std::string& hex) {
  std::array<std::uint8_t, 32> bytes{};
  const auto nibble = [&](std::size_t i) {
    const char c = i < hex.size() ? hex[i] : '0';
    return static_cast<std::uint8_t>(c >= 'a' ? c - 'a' + 10 : c - '0');
  };
  for (std::size_t i = 0; i < bytes.size(); ++i)
    bytes[i] = static_cast<std::uint8_t>(nibble(2 * i) << 4U | (nibble(2 * i + 1) & 0xFU));
  return bytes;
}

}  // namespace

ResultLines result_lines(std::string_view text, bool keep_errors) {
  ResultLines lines;
  std::unordered_map<std::string, std::size_t> place_of;
  std::vector<bool> kept;
  int number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    ++number;
    const std::size_t end = text.find('\n', begin);
    const std::size_t length = (end == std::string_view::npos ? text.size() : end) - begin;
    auto result = end == std::string_view::npos ? std::nullopt : result_in(text.substr(begin, length));
    const std::size_t at = std::exchange(begin, begin + length + 1);
    if (!result) {
      if (length > 0 && ++lines.unreadable == 1) lines.first_unreadable = number;
      continue;
    }
    if (!result->error.empty()) {
      ++lines.errors;
      if (!keep_errors) continue;
    }
    if (result->id.empty() || result->doubled) {  // of a row without a machine of its own
      lines.results.push_back({at, static_cast<std::uint32_t>(length), std::move(*result)});
      kept.push_back(true);
      continue;
    }
    const auto [known, is_new] = place_of.try_emplace(result->id, lines.results.size());
    if (!is_new) {
      kept[known->second] = false;
      known->second = lines.results.size();
      ++lines.replaced;
    }
    lines.results.push_back({at, static_cast<std::uint32_t>(length), std::move(*result)});
    kept.push_back(true);
  }
  std::size_t i = 0;
  std::erase_if(lines.results, [&](const auto&) { return !kept[i++]; });
  return lines;
}

ResultsFile::ResultsFile(ResultsFile&& other) noexcept
    : path_(std::move(other.path_)),
      handle_(std::exchange(other.handle_, -1)),
      held_(std::move(other.held_)),
      synced_(other.synced_) {}

ResultsFile::~ResultsFile() {
  if (handle_ >= 0) ::close(handle_);
}

Problem ResultsFile::failed(const char* what) const {
  return {ProblemKind::output, fmt::format("cannot {}: {}", what, std::strerror(errno)), path_, 0, 0, {}};
}

Result<ResultsFile> ResultsFile::open(const std::string& path) {
  ResultsFile file;
  file.path_ = path;
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
    return problem(ProblemKind::usage, path + ": expected a file for the results, found a folder or a device");
  if (std::filesystem::exists(status)) {
    ECS_TRY(text, read_file(path));
    ResultLines lines = result_lines(text, false);
    if (lines.first_unreadable == 1 && (text.find('\n') != std::string::npos || !text.starts_with("{\"id\":")))
      return problem(ProblemKind::usage,
                     path + " exists and holds no results of `ecs fleet diagnose`: give another name");
    const bool rewrite = lines.errors + lines.unreadable + lines.replaced > 0;
    std::string kept;
    for (auto& one : lines.results) {
      Known known{bytes_of(one.result.hash), labels_of(one.result), one.offset, one.length};
      if (rewrite) {
        known.offset = kept.size();
        kept.append(text, one.offset, one.length);
        kept += '\n';
      }
      file.held_.emplace(std::move(one.result.id), known);
    }
    if (rewrite) ECS_DO(write_file(path, kept));
  }
  file.handle_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (file.handle_ < 0) return tl::unexpected(file.failed("write"));
  return file;
}

ResultsFile::Held ResultsFile::holds(const FleetResult& labels, const std::string& hash) const {
  const auto found = held_.find(labels.id);
  if (found == held_.end() || found->second.hash != bytes_of(hash)) return Held::no;
  return found->second.labels == labels_of(labels) ? Held::yes : Held::other_labels;
}

Result<FleetResult> ResultsFile::held(const std::string& id) const {
  const Known& known = held_.at(id);
  std::string line(known.length, ' ');
  const auto read = ::pread(handle_, line.data(), line.size(), static_cast<off_t>(known.offset));
  auto result = read == static_cast<ssize_t>(line.size()) ? result_in(line) : std::nullopt;
  if (!result) return problem(ProblemKind::output, path_ + " was changed by another program: run the verb again");
  return std::move(*result);
}

Result<void> ResultsFile::append(const FleetResult& result) {
  const std::string line = to_line(result) + '\n';
  const std::lock_guard lock(mutex_);
  synced_ = false;
  ssize_t written = 0;
  do written = ::write(handle_, line.data(), line.size());
  while (written < 0 && errno == EINTR);
  if (written < 0) return tl::unexpected(failed("write"));
  if (written == static_cast<ssize_t>(line.size())) return {};
  errno = ENOSPC;  // cut: the next run leaves the line out
  return tl::unexpected(failed("write"));
}

Result<void> ResultsFile::sync() {
  {
    const std::lock_guard lock(mutex_);
    if (std::exchange(synced_, true)) return {};
  }
  if (::fsync(handle_) != 0 && errno != EINVAL && errno != EROFS) return tl::unexpected(failed("write"));
  return {};
}

}  // namespace ecs::commissioning
