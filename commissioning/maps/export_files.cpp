#include "commissioning/maps/export_files.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include "base/file.hpp"

namespace ecs::commissioning {
namespace {

namespace fs = std::filesystem;

/// One file on its way: where it goes, the new content beside it, and what was there.
struct Staged {
  std::string name;  ///< as it was given
  fs::path target;   ///< where a symbolic link leads
  fs::path beside;
  std::optional<std::string> old;
};

tl::unexpected<Problem> output_problem(const std::string& path, std::string why) {
  return tl::unexpected(Problem{ProblemKind::output, std::move(why), path, 0, 0, {}});
}

/// Takes away what was staged and not renamed.
class StagedFiles {
 public:
  StagedFiles() = default;
  StagedFiles(const StagedFiles&) = delete;
  StagedFiles& operator=(const StagedFiles&) = delete;
  ~StagedFiles() {
    std::error_code ignored;
    for (const Staged& one : all) fs::remove(one.beside, ignored);
  }
  std::vector<Staged> all;
};

Result<void> check_target(const Staged& one, const StagedFiles& before) {
  std::error_code ignored;
  const auto status = fs::status(one.target, ignored);
  if (fs::is_directory(status))
    return output_problem(one.name, "cannot write: a folder of that name is there; no file was changed");
  if (fs::is_other(status)) return output_problem(one.name, "cannot write: it is no file; no file was changed");
  const auto place = [&](const Staged& staged) { return fs::weakly_canonical(staged.target, ignored); };
  for (const Staged& other : before.all)
    if (place(other) == place(one))
      return output_problem(one.name,
                            fmt::format("cannot write: {} leads to the same file; no file was changed", other.name));
  return {};
}

Result<void> stage(const OutputFile& file, StagedFiles& staged) {
  std::error_code ignored;
  Staged one{file.path, led_to(file.path), {}, std::nullopt};
  if (const auto fits = check_target(one, staged); !fits) return fits;
  if (fs::exists(one.target, ignored)) {
    auto old = read_file(one.target);
    if (!old)
      return output_problem(
          file.path, fmt::format("what is there cannot be kept in case another file fails ({}); no file was changed",
                                 old.error().message));
    one.old = std::move(*old);
  }
  one.beside = one.target.string() + fmt::format(".new-{}", ::getpid());
  staged.all.push_back(one);
  if (const auto written = write_file(one.beside, file.content); !written)
    return output_problem(file.path, written.error().message + "; no file was changed");
  if (one.old) fs::permissions(one.beside, fs::status(one.target, ignored).permissions(), ignored);
  return {};
}

/// What a failure in the middle leaves: everything as it was, or named what is not.
std::string taken_back(const std::vector<Staged>& all, std::size_t renamed) {
  std::vector<std::string> stuck;
  for (std::size_t i = 0; i < renamed; ++i) {
    const Staged& one = all[i];
    std::error_code failed;
    const bool back = one.old ? write_file(one.target, *one.old).has_value() : fs::remove(one.target, failed);
    if (!back) stuck.push_back(one.name);
  }
  if (stuck.empty() && renamed == 0) return "no file was changed";
  if (stuck.empty()) return "the files before it were restored: nothing has changed";
  return fmt::format(
      "{} could not be taken back and hold{} the new content, the others what they held: do not use them together",
      fmt::join(stuck, ", "), stuck.size() == 1 ? "s" : "");
}

}  // namespace

Result<std::vector<WrittenFile>> write_together(const std::vector<OutputFile>& files) {
  std::error_code ignored;
  std::vector<WrittenFile> written;
  if (files.size() == 1) {
    const bool there = fs::exists(files.front().path, ignored);
    ECS_DO(write_file(files.front().path, files.front().content));
    written.push_back({files.front().path, there});
    return written;
  }
  StagedFiles staged;
  for (const OutputFile& file : files) ECS_DO(stage(file, staged));
  for (std::size_t i = 0; i < staged.all.size(); ++i) {
    const Staged& one = staged.all[i];
    if (std::rename(one.beside.c_str(), one.target.c_str()) != 0) {
      const std::string why = std::strerror(errno);
      return output_problem(one.name, fmt::format("cannot write: {}; {}", why, taken_back(staged.all, i)));
    }
    written.push_back({one.name, one.old.has_value()});
  }
  return written;
}

std::vector<std::string> left_from_before(const std::string& folder, const std::vector<WrittenFile>& written,
                                          const std::function<bool(std::string_view)>& is_ours) {
  std::vector<std::string> left;
  std::error_code ignored;
  for (fs::directory_iterator at(folder, ignored), end; at != end; at.increment(ignored)) {
    const std::string name = at->path().filename().string();
    const auto is_it = [&](const WrittenFile& file) { return fs::path(file.path).filename() == name; };
    if (is_ours(name) && !at->is_directory(ignored) && std::none_of(written.begin(), written.end(), is_it))
      left.push_back(name);
  }
  std::sort(left.begin(), left.end());
  return left;
}

}  // namespace ecs::commissioning
