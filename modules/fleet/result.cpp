#include "modules/fleet/result.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <functional>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/answer_table.hpp"
#include "base/file.hpp"
#include "base/text.hpp"
#include "modules/fleet/run.hpp"

namespace ecs::commissioning {
std::string to_line(const FleetResult& result) {
  if (!result.error.empty()) {
    Json error = object_of("id"_is(text_or_null(result.id)), "error"_is(result.error));
    if (result.doubled) error["doubled"] = true;
    return one_line(error);
  }
  Json causes = Json::array();
  for (const FleetCause& cause : result.causes)
    causes.push_back(object_of("name"_is(cause.name), "probability"_is(cause.probability), "e_value"_is(cause.e_value),
                               "false_naming"_is(cause.false_naming), "p_value"_is(cause.p_value),
                               "standing"_is(cause.standing), "indistinguishable_from"_is(cause.rivals)));
  return one_line(object_of("id"_is(result.id), "hash"_is(result.hash), "verdict"_is(result.verdict),
                            "p_value"_is(result.p_value), "causes"_is(std::move(causes)),
                            "type"_is(text_or_null(result.type)), "batch"_is(text_or_null(result.batch)),
                            "processor_s"_is(result.processor_s)));
}

std::optional<FleetResult> result_in(std::string_view line) {
  const Json object = Json::parse(line, nullptr, false);
  if (!object.is_object() || !object.contains("id")) return std::nullopt;
  FleetResult result;
  result.id = text_at(object, "id");
  result.error = text_at(object, "error");
  result.doubled = !result.error.empty() && object.contains("doubled");
  if (!result.error.empty()) return result;
  result.hash = text_at(object, "hash");
  result.verdict = text_at(object, "verdict");
  if (result.id.empty() || result.hash.empty() || result.verdict.empty()) return std::nullopt;
  result.type = text_at(object, "type");
  result.batch = text_at(object, "batch");
  result.processor_s = number_at(object, "processor_s").value_or(0.0);
  result.p_value = number_at(object, "p_value");
  const auto causes = object.find("causes");
  if (causes == object.end() || !causes->is_array()) return std::nullopt;
  for (const Json& one : *causes) {
    FleetCause cause;
    cause.name = one.is_object() ? text_at(one, "name") : std::string();
    if (cause.name.empty()) return std::nullopt;
    cause.probability = number_at(one, "probability").value_or(0.0);
    cause.e_value = number_at(one, "e_value");
    cause.false_naming = number_at(one, "false_naming").value_or(1.0);
    cause.p_value = number_at(one, "p_value");
    if (const std::string standing = text_at(one, "standing"); !standing.empty()) cause.standing = standing;
    if (const auto rivals = one.find("indistinguishable_from"); rivals != one.end() && rivals->is_array())
      for (const Json& rival : *rivals)
        if (rival.is_string()) cause.rivals.push_back(rival.get<std::string>());
    result.causes.push_back(std::move(cause));
  }
  return result;
}

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
                     path + " exists and contains no results of `ecs fleet diagnose`: give another name");
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
  file.handle_ = Descriptor(::open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666));
  if (!file.handle_) return tl::unexpected(file.failed("write"));
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
  const auto read = ::pread(handle_.get(), line.data(), line.size(), static_cast<off_t>(known.offset));
  auto result = read == static_cast<ssize_t>(line.size()) ? result_in(line) : std::nullopt;
  if (!result) return problem(ProblemKind::output, path_ + " was changed by another program: run the verb again");
  return std::move(*result);
}

Result<void> ResultsFile::append(const FleetResult& result) {
  const std::string line = to_line(result) + '\n';
  const std::lock_guard lock(*mutex_);
  synced_ = false;
  ssize_t written = 0;
  do written = ::write(handle_.get(), line.data(), line.size());
  while (written < 0 && errno == EINTR);
  if (written < 0) return tl::unexpected(failed("write"));
  if (written == static_cast<ssize_t>(line.size())) return {};
  errno = ENOSPC;  // cut: the next run leaves the line out
  return tl::unexpected(failed("write"));
}

Result<void> ResultsFile::sync() {
  {
    const std::lock_guard lock(*mutex_);
    if (std::exchange(synced_, true)) return {};
  }
  if (::fsync(handle_.get()) != 0 && errno != EINVAL && errno != EROFS) return tl::unexpected(failed("write"));
  return {};
}

namespace {

/// A place holds "W 2 id": under way, twice before; or "K 2 id": known from before, not yet started again.
constexpr std::size_t kPlace = Manifest::kLongestId + 24;

/// A file of another program that happens to have the name is not overwritten.
bool is_under_way(const std::string& text) {
  const auto lines = lines_of(text);
  return std::all_of(lines.begin(), lines.end(), [](std::string_view line) {
    return trimmed(line).empty() || line.starts_with("W ") || line.starts_with("K ");
  });
}

tl::unexpected<Problem> not_ours(const std::string& path) {
  return problem(
      ProblemKind::refused,
      path + " exists and is not a file of `ecs fleet diagnose`: remove it, or give another name for the results");
}

std::map<std::string, int> ends_in(const std::string& text) {
  std::map<std::string, int> ends;
  for (const std::string_view line : lines_of(text)) {
    const bool was_under_way = line.starts_with("W ");
    if (!was_under_way && !line.starts_with("K ")) continue;
    const std::string_view rest = trimmed(line.substr(2));
    const auto blank = rest.find(' ');
    const auto times = integer_in(rest.substr(0, blank));
    if (blank == std::string_view::npos || !times) continue;
    int& known = ends[std::string(trimmed(rest.substr(blank)))];
    known = std::max(known, static_cast<int>(*times) + (was_under_way ? 1 : 0));
  }
  return ends;
}

}  // namespace

Result<UnderWay> UnderWay::open(const std::string& path, int threads) {
  UnderWay file;
  file.path_ = path;
  for (;;) {
    file.handle_ = Descriptor(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666));
    if (!file.handle_ && errno == ELOOP)
      return problem(
          ProblemKind::refused,
          path +
              " is a symbolic link: its target would be overwritten. Remove it, or give another name for the results");
    if (!file.handle_)
      return tl::unexpected(
          Problem{ProblemKind::output, fmt::format("cannot write: {}", std::strerror(errno)), path, 0, 0, {}});
    if (::flock(file.handle_.get(), LOCK_EX | LOCK_NB) != 0)
      return problem(ProblemKind::refused, path + ": another `ecs fleet diagnose` is writing these results");
    struct stat there {};
    if (::fstat(file.handle_.get(), &there) == 0 && there.st_nlink > 0) {
      if (!S_ISREG(there.st_mode) || there.st_nlink > 1) return not_ours(path);
      break;
    }  // else the other run has just ended and removed it
  }
  const auto text = read_file(fmt::format("/proc/self/fd/{}", file.handle_.get()));  // whatever has that name by now
  if (!text) return tl::unexpected(text.error());
  if (!is_under_way(*text)) return not_ours(path);
  file.ends_ = ends_in(*text);
  int place = threads;
  for (const auto& [id, times] : file.ends_) file.put(place++, fmt::format("K {} {}", times, id));
  for (int thread = 0; thread < threads; ++thread) file.finish(thread);
  if (::ftruncate(file.handle_.get(), static_cast<off_t>(kPlace) * place) != 0) file.ends_.clear();
  return file;
}

void UnderWay::put(int place, const std::string& text) const {
  const std::string line = fmt::format("{:<{}}\n", text, kPlace - 1);
  // a write that fails loses a precaution, no result
  [[maybe_unused]] const auto written =
      ::pwrite(handle_.get(), line.data(), kPlace, static_cast<off_t>(kPlace) * static_cast<off_t>(place));
}

void UnderWay::begin(int thread, const std::string& id) const {
  const auto known = ends_.find(id);
  put(thread, fmt::format("W {} {}", known == ends_.end() ? 0 : known->second, id));
}

void UnderWay::finish(int thread) const { put(thread, ""); }

void UnderWay::remove() { ::unlink(path_.c_str()); }

}  // namespace ecs::commissioning
