#include "base/file.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nettle/sha2.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include "base/process.hpp"

namespace ecs {
namespace {

constexpr std::uintmax_t kLargest = 256ull << 20;

Problem file_problem(ProblemKind kind, const std::filesystem::path& path, const std::string& what) {
  return Problem{kind, what, path.string(), 0, 0, {}};
}

Problem write_problem(const std::filesystem::path& path, int error) {
  return file_problem(ProblemKind::output, path, fmt::format("cannot write: {}", std::strerror(error)));
}

bool write_all(int handle, std::string_view content) {
  while (!content.empty()) {
    const ssize_t written = ::write(handle, content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    content.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

/// "; it holds a.csv, b.csv and 3 more: give a file, as in DIR/a.csv", in the order of the names; empty: no files.
std::string files_in_words(const std::filesystem::path& folder) {
  constexpr std::size_t kShown = 6;
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (const std::string name = entry.path().filename().string(); entry.is_regular_file(error) && name[0] != '.')
      names.push_back(name);
  std::sort(names.begin(), names.end());
  if (names.empty()) return {};
  const auto is_data = [](const std::string& name) { return !name.ends_with(".md"); };
  const auto data = std::find_if(names.begin(), names.end(), is_data);
  const std::string first = (folder / (data == names.end() ? names.front() : *data)).string();
  const std::size_t more = names.size() - std::min(names.size(), kShown);
  names.resize(names.size() - more);
  return fmt::format("; it contains {}{}: give a file, as in {}", fmt::join(names, ", "),
                     more > 0 ? fmt::format(" and {} more", more) : "", first);
}

/// A serial line, or the terminal of an emulated unit: reading it would wait without end.
bool is_terminal(const std::filesystem::path& path) {
  const int handle = ::open(path.c_str(), O_RDONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  const bool terminal = handle >= 0 && ::isatty(handle) == 1;
  if (handle >= 0) ::close(handle);
  return terminal;
}

Result<std::string> read_from_disc(const std::filesystem::path& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status))
    return tl::unexpected(file_problem(ProblemKind::bad_input, path, "no such file"));
  if (std::filesystem::is_directory(status))
    return tl::unexpected(
        file_problem(ProblemKind::bad_input, path, "expected a file, found a directory" + files_in_words(path)));
  if (std::filesystem::is_character_file(status) && is_terminal(path))
    return tl::unexpected(
        file_problem(ProblemKind::bad_input, path, "expected a file, found a serial line or terminal"));
  if (std::filesystem::is_regular_file(status) && std::filesystem::file_size(path, error) > kLargest)
    return tl::unexpected(file_problem(ProblemKind::bad_input, path, "larger than 256 MiB: not read"));
  std::ifstream in(path, std::ios::binary);
  std::string content;
  std::array<char, 1 << 16> piece{};
  while (in.is_open() && content.size() <= kLargest && (in.read(piece.data(), piece.size()), in.gcount() > 0))
    content.append(piece.data(), static_cast<std::size_t>(in.gcount()));
  if (in.bad() || !in.is_open())
    return tl::unexpected(file_problem(ProblemKind::bad_input, path, "cannot read: permission denied or I/O error"));
  if (content.size() > kLargest)
    return tl::unexpected(file_problem(ProblemKind::bad_input, path, "larger than 256 MiB: not read"));
  return content;
}

}  // namespace

Result<std::string> read_file(const std::filesystem::path& path) {
  FileWatch* watch = FileWatch::current();
  auto content = watch != nullptr && watch->replaces_disc() ? watch->content(path) : read_from_disc(path);
  if (watch != nullptr && content) watch->was_read(path, *content);
  return content;
}

namespace {

/// A device, FIFO or socket is written into, never replaced.
Result<void> write_into(const std::filesystem::path& path, std::string_view content) {
  const int handle = ::open(path.c_str(), O_WRONLY | O_NOCTTY | O_CLOEXEC);
  if (handle < 0) return tl::unexpected(write_problem(path, errno));
  const bool written = write_all(handle, content);
  const int error = errno;
  ::close(handle);
  if (!written) return tl::unexpected(write_problem(path, error));
  return {};
}

/// Mode of the file that is replaced, or what the process gives to new files.
mode_t mode_for(const std::filesystem::path& path) {
  struct stat old {};
  if (::stat(path.c_str(), &old) == 0) return old.st_mode & 07777;
  const mode_t mask = ::umask(0);
  ::umask(mask);
  return 0666 & ~mask;
}

}  // namespace

std::filesystem::path led_to(const std::filesystem::path& path) {
  namespace fs = std::filesystem;
  constexpr int kMostLinks = 40;  // as the kernel follows
  std::error_code error;
  if (!fs::is_symlink(path, error)) return path;
  fs::path target = path;
  if (!fs::exists(path, error)) {
    for (int i = 0; i < kMostLinks && fs::is_symlink(target, error); ++i)
      target = target.parent_path() / fs::read_symlink(target, error);
    if (fs::is_symlink(target, error)) return path;
  }
  target = fs::weakly_canonical(target, error);
  return error ? path : target;
}

namespace {

bool fill(int handle, const std::filesystem::path& path, std::string_view content) {
  return write_all(handle, content) && ::fchmod(handle, mode_for(path)) == 0 && ::fsync(handle) == 0;
}

/// rename(), or else nothing is left under the old name. @return errno; 0: done
int rename_or_remove(const std::string& from, const std::filesystem::path& to) {
  if (::rename(from.c_str(), to.c_str()) == 0) return 0;
  const int error = errno;
  ::unlink(from.c_str());
  return error;
}

/// In a file that has no name until it is whole, so that a program killed meanwhile leaves nothing behind (open(2),
/// O_TMPFILE). A file that exists is replaced by rename() from a second name, always the same: what a program killed
/// between the two system calls has left there, the next one removes.
/// @return errno; 0: done; ENOTSUP: not on this file system, or others write the same file all the time
int write_nameless(const std::filesystem::path& path, std::string_view content) {
  constexpr int kMostOthers = 20;
  const std::filesystem::path folder = path.parent_path();
  const Descriptor file(::open(folder.empty() ? "." : folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0600));
  if (!file) return ENOTSUP;
  if (!fill(file.get(), path, content)) return errno;
  const std::string whole = fmt::format("/proc/self/fd/{}", file.get());
  const auto name_it = [&whole](const std::string& name) {
    return ::linkat(AT_FDCWD, whole.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0 ? 0 : errno;
  };
  if (const int error = name_it(path.string()); error != EEXIST) return error == 0 ? 0 : ENOTSUP;
  const std::string beside = (folder / fmt::format(".{}.ecs-new", path.filename().string())).string();
  for (int others = 0; others < kMostOthers; ++others) {
    if (const int error = name_it(beside); error == 0) {
      const int renamed = rename_or_remove(beside, path);
      return renamed == ENOENT ? ENOTSUP : renamed;  // another program has removed it
    } else if (error != EEXIST) {
      return ENOTSUP;
    }
    ::unlink(beside.c_str());
  }
  return ENOTSUP;
}

/// In a file with a name of its own. @return errno; 0: done
int write_beside(const std::filesystem::path& path, std::string_view content) {
  std::string beside = path.string() + ".XXXXXX";
  const Descriptor file(::mkstemp(beside.data()));
  if (!file) return errno;
  if (fill(file.get(), path, content)) return rename_or_remove(beside, path);
  const int error = errno;
  ::unlink(beside.c_str());
  return error;
}

Result<void> write_to_disc(const std::filesystem::path& name, std::string_view content) {
  const std::filesystem::path path = led_to(name);
  std::error_code ignored;
  const auto status = std::filesystem::status(path, ignored);
  if (std::filesystem::is_other(status)) return write_into(path, content);
  int error = write_nameless(path, content);
  if (error == ENOTSUP) error = write_beside(path, content);
  if (error != 0) return tl::unexpected(write_problem(name, error));
  return {};
}

}  // namespace

Result<void> write_file(const std::filesystem::path& path, std::string_view content) {
  FileWatch* watch = FileWatch::current();
  const bool replaced = watch != nullptr && watch->replaces_disc();
  ECS_DO(replaced ? watch->may_write(path) : write_to_disc(path, content));
  if (watch != nullptr) watch->was_written(path, content);
  return {};
}

Result<void> keep_name(const std::filesystem::path& path) {
  if (FileWatch* watch = FileWatch::current(); watch != nullptr && watch->replaces_disc())
    return watch->keeps_name(path);
  const std::filesystem::path folder = led_to(path).parent_path();
  const int handle = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const bool kept = handle >= 0 && (::fsync(handle) == 0 || errno == EINVAL);  // EINVAL: it has nothing to write
  const int error = errno;
  if (handle >= 0) ::close(handle);
  if (kept) return {};
  return problem(ProblemKind::output, "{}: cannot write: {}", folder.string(), std::strerror(error));
}

std::string sha256_hex(std::string_view content) {
  sha256_ctx context;
  sha256_init(&context);
  sha256_update(&context, content.size(), reinterpret_cast<const std::uint8_t*>(content.data()));
  std::array<std::uint8_t, SHA256_DIGEST_SIZE> digest{};
  sha256_digest(&context, digest.size(), digest.data());
  std::string hex;
  for (const std::uint8_t byte : digest) hex += fmt::format("{:02x}", byte);
  return hex;
}

std::uint32_t crc32_of(std::span<const std::uint8_t> bytes) {
  return static_cast<std::uint32_t>(::crc32_z(0, bytes.data(), bytes.size()));
}

std::uint32_t crc32_of_both(std::uint32_t first, std::uint32_t second, std::size_t second_bytes) {
  return static_cast<std::uint32_t>(::crc32_combine(first, second, static_cast<z_off_t>(second_bytes)));
}

Result<std::filesystem::path> state_folder() {
  const auto from = [](const char* name) -> std::filesystem::path {
    const char* value = std::getenv(name);
    return value == nullptr ? "" : value;
  };
  std::filesystem::path folder = from("ECS_STATE_DIR");
  if (folder.empty() && !from("XDG_STATE_HOME").empty()) folder = from("XDG_STATE_HOME") / "ecs";
  if (folder.empty() && !from("HOME").empty()) folder = from("HOME") / ".local/state/ecs";
  if (folder.empty()) return problem(ProblemKind::output, "no state folder: set ECS_STATE_DIR or HOME");
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return tl::unexpected(file_problem(ProblemKind::output, folder, "cannot create: " + error.message()));
  return folder;
}

namespace {

thread_local FileWatch* watch_of_thread = nullptr;

}  // namespace

FileWatch::FileWatch() : before_(std::exchange(watch_of_thread, this)) {}
FileWatch::~FileWatch() { watch_of_thread = before_; }

Unwatched::Unwatched() : before_(std::exchange(watch_of_thread, nullptr)) {}
Unwatched::~Unwatched() { watch_of_thread = before_; }

FileWatch* FileWatch::current() { return watch_of_thread; }

Result<std::string> FileWatch::content(const std::filesystem::path& path) {
  return problem_at(path.string(), 0, 0, "no such file");
}

bool is_there(const std::filesystem::path& path) {
  if (FileWatch* watch = FileWatch::current(); watch != nullptr && watch->replaces_disc())
    return watch->content(path).has_value();
  return disc::exists(path);
}

std::string head_of(const std::filesystem::path& path, std::size_t bytes) {
  if (FileWatch* watch = FileWatch::current(); watch != nullptr && watch->replaces_disc())
    return watch->content(path).value_or("").substr(0, bytes);
  std::string head(bytes, '\0');
  std::ifstream stream(path, std::ios::binary);
  stream.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(std::max<std::streamsize>(0, stream.gcount())));
  return head;
}

namespace {

Result<void> unless_there(const std::vector<std::string>& files, const std::vector<std::string>& own,
                          std::string_view instead) {
  for (const std::string& file : files)
    if (would_overwrite(file, own)) return problem(ProblemKind::usage, "{} already exists: {}", file, instead);
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

namespace disc {

bool exists(const Path& path) {
  std::error_code ignored;
  return std::filesystem::exists(path, ignored);
}

bool is_file(const Path& path) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(path, ignored);
}

bool is_folder(const Path& path) {
  std::error_code ignored;
  return std::filesystem::is_directory(path, ignored);
}

Path absolute(const Path& path) {
  std::error_code ignored;
  return std::filesystem::absolute(path, ignored);
}

bool remove(const Path& path) {
  std::error_code ignored;
  return std::filesystem::remove(path, ignored);
}

void remove_all(const Path& path) {
  std::error_code ignored;
  std::filesystem::remove_all(path, ignored);
}

void make_folders(const Path& path) {
  std::error_code ignored;
  std::filesystem::create_directories(path, ignored);
}

}  // namespace disc
}  // namespace ecs
