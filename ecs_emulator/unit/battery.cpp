#include "ecs_emulator/unit/battery.hpp"

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

#include "base/file.hpp"
#include "base/text.hpp"

namespace ecs::emulator {
namespace {

constexpr std::string_view kMagic = "ECS battery 1\n";

struct Part {
  Address first = 0;
  std::uint32_t size = 0;
};

std::array<Part, 3> parts_of(const UnitMemory& memory) {
  const std::uint32_t bank = bank_bytes(memory.modules());
  return {{{kCommitRecords.first, kCommitRecords.size}, {kBankA.first, bank}, {kBankB.first, bank}}};
}

/// The name of a file lasts over a loss of power once its folder is on the disk.
Result<void> keep_name(const std::filesystem::path& path) {
  const std::filesystem::path folder = led_to(path).parent_path();
  const int handle = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const bool kept = handle >= 0 && (::fsync(handle) == 0 || errno == EINVAL);  // EINVAL: it has nothing to write
  const int error = errno;
  if (handle >= 0) ::close(handle);
  if (kept) return {};
  return problem(ProblemKind::output, fmt::format("{}: cannot write: {}", folder.string(), std::strerror(error)));
}

}  // namespace

Result<void> restore(UnitMemory& memory, const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return {};
  ECS_TRY(content, read_file(path));
  std::size_t wanted = kMagic.size();
  for (const Part& part : parts_of(memory)) wanted += part.size;
  if (!content.starts_with(kMagic) || content.size() != wanted)
    return problem_at(path.string(), 0, 0,
                      fmt::format("expected the battery memory of a unit with {} memory module(s), {} bytes, got {} "
                                  "bytes; name another file, or delete it to begin with an empty memory",
                                  memory.modules(), wanted, content.size()));
  std::size_t at = kMagic.size();
  for (const Part& part : parts_of(memory)) {
    const ByteView bytes(reinterpret_cast<const std::uint8_t*>(content.data()) + at, part.size);
    memory.write(part.first, bytes);
    at += part.size;
  }
  memory.kept();
  return {};
}

Result<void> keep(UnitMemory& memory, const std::filesystem::path& path) {
  std::string content(kMagic);
  for (const Part& part : parts_of(memory)) {
    const ByteView bytes = memory.view(part.first, part.size);
    content.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }
  ECS_DO(write_file(path, content));
  ECS_DO(keep_name(path));
  memory.kept();
  return {};
}

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
