#include "base/process.hpp"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <thread>

#include <fmt/format.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>

#include "base/text.hpp"

namespace ecs {
namespace {

/// A file in memory without a name; closes itself.
class MemoryFile {
 public:
  MemoryFile() : file_(::memfd_create("ecs-child", MFD_CLOEXEC)) {}
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  ~MemoryFile() {
    if (file_ >= 0) ::close(file_);
  }
  [[nodiscard]] int number() const { return file_; }

  [[nodiscard]] bool fill(std::string_view text) {
    while (!text.empty()) {
      const ssize_t written = ::write(file_, text.data(), text.size());
      if (written <= 0) return false;
      text.remove_prefix(static_cast<std::size_t>(written));
    }
    return ::lseek(file_, 0, SEEK_SET) == 0;
  }

  [[nodiscard]] std::string content() const {
    const off_t size = ::lseek(file_, 0, SEEK_END);
    std::string text(size > 0 ? static_cast<std::size_t>(size) : 0, '\0');
    std::size_t done = 0;
    while (done < text.size()) {
      const ssize_t got = ::pread(file_, text.data() + done, text.size() - done, static_cast<off_t>(done));
      if (got <= 0) break;
      done += static_cast<std::size_t>(got);
    }
    text.resize(done);
    return text;
  }

 private:
  int file_ = -1;
};

auto failed(const ChildWords& child, std::string_view what) {
  return problem(ProblemKind::output, "{}: {}", child.name, what);
}

Result<pid_t> spawned(std::vector<std::string>& words, const ChildWords& child, const MemoryFile& in,
                      const MemoryFile& out, const MemoryFile& errors) {
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, in.number(), STDIN_FILENO);
  ::posix_spawn_file_actions_adddup2(&actions, out.number(), STDOUT_FILENO);
  ::posix_spawn_file_actions_adddup2(&actions, errors.number(), STDERR_FILENO);
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  pid_t process = -1;
  const int fault = ::posix_spawnp(&process, pointers.front(), &actions, nullptr, pointers.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (fault == ENOENT) return failed(child, fmt::format("not found; {}", child.when_missing));
  if (fault != 0) return failed(child, std::strerror(fault));
  return process;
}

/// Its wait status; a child that outstays its time is killed.
Result<int> ended(pid_t process, const ChildWords& child) {
  using Clock = std::chrono::steady_clock;
  using namespace std::chrono_literals;
  int status = 0;
  const auto end = Clock::now() + std::chrono::duration<double>(child.limit_s);
  while (::waitpid(process, &status, WNOHANG) == 0) {
    const bool late = Clock::now() > end;
    if (late || interrupted()) {
      ::kill(process, SIGKILL);
      ::waitpid(process, &status, 0);
      return failed(child, late ? fmt::format("did not finish within {} s", child.limit_s) : "stopped");
    }
    std::this_thread::sleep_for(5ms);
  }
  return status;
}

}  // namespace

Result<std::string> output_of(std::vector<std::string> words, std::string_view input, const ChildWords& child) {
  MemoryFile in, out, errors;
  if (!in.fill(input) || out.number() < 0 || errors.number() < 0) return failed(child, std::strerror(errno));
  ECS_TRY(process, spawned(words, child, in, out, errors));
  ECS_TRY(status, ended(process, child));
  std::string said = out.content();
  if (status != 0 || said.empty()) return failed(child, trimmed(errors.content()));
  return said;
}

namespace {

std::atomic<bool> flag{false};
std::atomic<int> number{0};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free);

extern "C" void remember(int signal) {
  int none = 0;
  number.compare_exchange_strong(none, signal);
  flag.store(true);
}

}  // namespace

void catch_signals() {
  struct sigaction action {};
  action.sa_handler = remember;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) ::sigaction(signal, &action, nullptr);
  action.sa_handler = SIG_IGN;
  for (const int signal : {SIGPIPE, SIGXFSZ}) ::sigaction(signal, &action, nullptr);
}

const std::atomic<bool>& interrupted() { return flag; }
void ask_to_stop() { flag.store(true); }
void stop_asking() { flag.store(number.load() != 0); }
int interrupting_signal() { return number.load(); }

}  // namespace ecs
