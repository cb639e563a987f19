#include "ecs_emulator/unit/battery_lock.hpp"

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <string>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/text.hpp"

namespace ecs::emulator {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds kPatience{1};
constexpr std::chrono::milliseconds kBetweenTries{20};

/// The name still leads to the open file: nobody has removed it between opening and locking.
bool still_named(int file, const std::filesystem::path& path) {
  struct stat opened {};
  struct stat named {};
  return ::fstat(file, &opened) == 0 && ::stat(path.c_str(), &named) == 0 && opened.st_ino == named.st_ino &&
         opened.st_dev == named.st_dev;
}

std::string content_of(int file) {
  std::array<char, 64> text{};
  const ssize_t got = ::pread(file, text.data(), text.size(), 0);
  return std::string(trimmed(std::string_view(text.data(), got > 0 ? static_cast<std::size_t>(got) : 0)));
}

/// A plain file, empty or signed by an emulator.
bool is_ours(int file) {
  struct stat opened {};
  const std::string text = content_of(file);
  return ::fstat(file, &opened) == 0 && S_ISREG(opened.st_mode) && (text.empty() || text.starts_with("pid "));
}

void sign(int file) {
  const std::string text = fmt::format("pid {}\n", ::getpid());
  if (::ftruncate(file, 0) == 0) (void)!::pwrite(file, text.data(), text.size(), 0);
}

}  // namespace

Result<BatteryLock> BatteryLock::take(const std::filesystem::path& battery) {
  std::error_code error;
  std::filesystem::path path = std::filesystem::weakly_canonical(battery, error);
  if (error) path = battery;
  path += ".in-use";
  for (const auto end = Clock::now() + kPatience;;) {
    Descriptor file(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0644));
    if (file.get() < 0)
      return problem(ProblemKind::output,
                     fmt::format("{}: cannot make this file: {}", path.string(), std::strerror(errno)));
    if (!is_ours(file.get()))
      return problem(ProblemKind::output,
                     fmt::format("{}: expected the mark of an ecs-emulator that uses the memory, found another file; "
                                 "remove it, or name another file for the memory",
                                 path.string()));
    const bool locked = ::flock(file.get(), LOCK_EX | LOCK_NB) == 0;
    if (locked && still_named(file.get(), path)) {
      sign(file.get());
      return BatteryLock(std::move(file), std::move(path));
    }
    if (!locked && Clock::now() > end) {
      const std::string holder = content_of(file.get());
      return problem(ProblemKind::output,
                     fmt::format("{}: another ecs-emulator ({}) works with this memory; end it, or name another file",
                                 battery.string(), holder.empty() ? "unknown" : holder));
    }
    std::this_thread::sleep_for(kBetweenTries);
  }
}

BatteryLock::~BatteryLock() {
  if (file_.get() >= 0) ::unlink(path_.c_str());
}

}  // namespace ecs::emulator
