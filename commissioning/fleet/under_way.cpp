#include "commissioning/fleet/under_way.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.hpp"
#include "base/text.hpp"
#include "commissioning/manifest/manifest.hpp"

namespace ecs::commissioning {
namespace {

/// A place holds "W 2 id": under way, twice before; or "K 2 id": known from before, not yet begun again.
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
      path + " is there and no file of `ecs fleet diagnose`: remove it, or give another name for the results");
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

UnderWay::UnderWay(UnderWay&& other) noexcept
    : path_(std::move(other.path_)), handle_(std::exchange(other.handle_, -1)), ends_(std::move(other.ends_)) {}

UnderWay::~UnderWay() {
  if (handle_ >= 0) ::close(handle_);
}

Result<UnderWay> UnderWay::open(const std::string& path, int threads) {
  UnderWay file;
  file.path_ = path;
  for (;;) {
    file.handle_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
    if (file.handle_ < 0 && errno == ELOOP)
      return problem(ProblemKind::refused,
                     path +
                         " is a symbolic link: what it leads to would be overwritten. Remove it, or give another "
                         "name for the results");
    if (file.handle_ < 0)
      return tl::unexpected(
          Problem{ProblemKind::output, fmt::format("cannot write: {}", std::strerror(errno)), path, 0, 0, {}});
    if (::flock(file.handle_, LOCK_EX | LOCK_NB) != 0)
      return problem(ProblemKind::refused, path + ": another `ecs fleet diagnose` writes these results");
    struct stat there {};
    if (::fstat(file.handle_, &there) == 0 && there.st_nlink > 0) {
      if (!S_ISREG(there.st_mode) || there.st_nlink > 1) return not_ours(path);
      break;
    }
    ::close(file.handle_);  // the other run has just ended and removed it
  }
  const auto text = read_file(fmt::format("/proc/self/fd/{}", file.handle_));  // whatever has that name by now
  if (!text) return tl::unexpected(text.error());
  if (!is_under_way(*text)) return not_ours(path);
  file.ends_ = ends_in(*text);
  int place = threads;
  for (const auto& [id, times] : file.ends_) file.put(place++, fmt::format("K {} {}", times, id));
  for (int thread = 0; thread < threads; ++thread) file.finish(thread);
  if (::ftruncate(file.handle_, static_cast<off_t>(kPlace) * place) != 0) file.ends_.clear();
  return file;
}

void UnderWay::put(int place, const std::string& text) const {
  const std::string line = fmt::format("{:<{}}\n", text, kPlace - 1);
  // a write that fails loses a precaution, no result
  [[maybe_unused]] const auto written =
      ::pwrite(handle_, line.data(), kPlace, static_cast<off_t>(kPlace) * static_cast<off_t>(place));
}

void UnderWay::begin(int thread, const std::string& id) const {
  const auto known = ends_.find(id);
  put(thread, fmt::format("W {} {}", known == ends_.end() ? 0 : known->second, id));
}

void UnderWay::finish(int thread) const { put(thread, ""); }

void UnderWay::remove() { ::unlink(path_.c_str()); }

}  // namespace ecs::commissioning
