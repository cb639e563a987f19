#include "commissioning/link/emulator_process.hpp"

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <mutex>
#include <random>
#include <string_view>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/file.hpp"
#include "base/process.hpp"
#include "base/text.hpp"
#include "commissioning/session/commands.hpp"

namespace ecs::commissioning {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kLongestSocketName = 100;  // sockaddr_un holds 107 characters
constexpr const char* kShared = ".shared";
constexpr const char* kToken = ".token";
constexpr auto kStartLimit = 15s;
constexpr auto kStopLimit = 2s;
constexpr auto kLockLimit = 5s;

auto failed(const std::string& what) { return problem(ProblemKind::link, "the bundled emulator: {}", what); }

/// An open file without a name, for what the child says on stderr.
int nameless_file() {
  char name[] = "/tmp/ecs-emulator-XXXXXX";
  const int file = ::mkostemp(name, O_CLOEXEC);
  if (file >= 0) ::unlink(name);
  return file;
}

std::string content_of(int file) {
  std::string text(2000, '\0');
  const ssize_t length = ::pread(file, text.data(), text.size(), 0);
  text.resize(length > 0 ? static_cast<std::size_t>(length) : 0);
  return std::string(trimmed(text));
}

std::filesystem::path with_ending(const std::filesystem::path& memory, const char* ending) {
  return memory.string() + ending;
}

/// A file that only this user can read, written again.
Result<void> write_private(const std::filesystem::path& path, const std::string& text) {
  const std::filesystem::path draft = path.string() + ".new";
  ::unlink(draft.c_str());
  const int file = ::open(draft.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0600);
  const bool written = file >= 0 && ::write(file, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  if (file >= 0) ::close(file);
  if (!written || ::rename(draft.c_str(), path.c_str()) != 0)
    return problem(ProblemKind::output, "{}: {}", path.string(), std::strerror(errno));
  return {};
}

std::string token_by_chance() {
  std::random_device chance;
  return fmt::format("{:08x}{:08x}{:08x}{:08x}\n", chance(), chance(), chance(), chance());
}

/// A second `ecs` must not use the same memory file at the same time.
Result<int> locked(const std::filesystem::path& memory) {
  const std::string path = memory.string() + ".lock";
  const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (file < 0) return problem(ProblemKind::output, "{}: {}", path, std::strerror(errno));
  for (const auto end = Clock::now() + kLockLimit; ::flock(file, LOCK_EX | LOCK_NB) != 0;) {
    if (Clock::now() > end || interrupted() || shared_emulator(memory)) {
      ::close(file);
      return failed("another `ecs` is using it with this machine; wait for it, or stop it");
    }
    std::this_thread::sleep_for(50ms);
  }
  return file;
}

std::mutex started_guard;
std::optional<std::filesystem::path> started_machine;

/// In the child, between fork and exec: only async-signal-safe calls.
[[noreturn]] void become(const std::vector<char*>& words, int output, int errors) {
  ::setpgid(0, 0);  // Ctrl-C is for `ecs`, which stops the child in its own time
  ::dup2(output, STDOUT_FILENO);
  ::dup2(errors, STDERR_FILENO);
  const int nothing = ::open("/dev/null", O_RDONLY);
  if (nothing >= 0) ::dup2(nothing, STDIN_FILENO);
  ::execv(words.front(), words.data());
  ::_exit(127);
}

}  // namespace

Result<std::unique_ptr<EmulatorProcess>> EmulatorProcess::start(const EmulatorOptions& options) {
  std::unique_ptr<EmulatorProcess> process(new EmulatorProcess());
  ECS_TRY(lock, locked(options.memory));
  process->lock_ = lock;
  disc::remove(with_ending(options.memory, kShared));  // of one that was killed
  if (options.shared) {
    process->shared_in_ = with_ending(options.memory, kShared);
    ECS_DO(write_private(with_ending(options.memory, kToken), token_by_chance()));
  }
  ECS_DO(process->launch(options));
  ECS_DO(process->read_greeting());
  const std::lock_guard guard(started_guard);
  started_machine = options.machine;
  return process;
}

std::optional<std::filesystem::path> emulated_machine() {
  const std::lock_guard guard(started_guard);
  return started_machine;
}

Result<void> EmulatorProcess::launch(const EmulatorOptions& options) {
  int ends[2];
  errors_ = nameless_file();
  if (errors_ < 0 || ::pipe2(ends, O_CLOEXEC) != 0)
    return problem(ProblemKind::output, "cannot start a program: {}", std::strerror(errno));
  output_ = ends[0];
  std::vector<std::string> words{options.program.string(), "serve",  "--machine", options.machine.string(), "--memory",
                                 options.memory.string(),  "--mode", "integrate", "--with-parent"};
  if (options.shared)
    words.insert(words.end(), {"--also-tcp", "--token", with_ending(options.memory, kToken).string()});
  const std::string socket = options.memory.string() + ".workshop";
  if (socket.size() <= kLongestSocketName) words.insert(words.end(), {"--workshop", socket});
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  child_ = ::fork();
  if (child_ == 0) become(pointers, ends[1], errors_);
  ::close(ends[1]);
  if (child_ < 0) return problem(ProblemKind::output, "cannot start a program: {}", std::strerror(errno));
  return {};
}

Result<void> EmulatorProcess::read_greeting() {
  std::string line;
  for (const auto end = Clock::now() + kStartLimit; line.find('\n') == std::string::npos;) {
    if (interrupted()) return failed("stopped while it started");
    if (Clock::now() > end) return failed("it did not report its link within 15 s");
    pollfd readable{output_, POLLIN, 0};
    if (::poll(&readable, 1, 100) <= 0) continue;
    char piece[512];
    const ssize_t length = ::read(output_, piece, sizeof piece);
    if (length <= 0) {
      const std::string said = content_of(errors_);
      return failed(said.empty() ? "it ended at once without a message" : said);
    }
    line.append(piece, static_cast<std::size_t>(length));
  }
  const Json greeting = Json::parse(line.substr(0, line.find('\n')), nullptr, false);
  if (!greeting.is_object() || !greeting.contains("pty") || !greeting["pty"].is_string())
    return failed(fmt::format("expected one JSON object with \"pty\", got {}", trimmed(line)));
  pty_ = greeting["pty"].get<std::string>();
  if (greeting.contains("arm_code") && greeting["arm_code"].is_string()) arm_code_ = greeting["arm_code"];
  if (greeting.contains("workshop") && greeting["workshop"].is_string()) workshop_ = greeting["workshop"];
  return shared_in_.empty() ? Result<void>() : share(greeting.value("second_link", ""));
}

Result<void> EmulatorProcess::share(const std::string& second_link) const {
  const Json told{{"process", ::getpid()}, {"link", second_link}, {"arm_code", arm_code_}, {"workshop", workshop_}};
  return write_private(shared_in_, one_line(told));
}

std::optional<SharedEmulator> shared_emulator(const std::filesystem::path& memory) {
  const auto text = read_file(with_ending(memory, kShared));
  const Json told = text ? Json::parse(*text, nullptr, false) : Json();
  if (!told.is_object()) return std::nullopt;
  const auto process = told.value("process", 0);
  const std::string link = told.value("link", "");
  if (link.empty() || process <= 0 || process == ::getpid() || ::kill(process, 0) != 0) return std::nullopt;
  return SharedEmulator{link, told.value("arm_code", ""), told.value("workshop", "")};
}

bool EmulatorProcess::running() {
  if (child_ > 0 && ::waitpid(child_, nullptr, WNOHANG) != 0) {
    child_ = -1;
    if (lock_ >= 0) ::close(lock_);
    lock_ = -1;
  }
  return child_ > 0;
}

EmulatorProcess::~EmulatorProcess() {
  if (!shared_in_.empty()) disc::remove(shared_in_);
  if (child_ > 0) {
    ::kill(child_, SIGTERM);
    const auto end = Clock::now() + kStopLimit;
    while (::waitpid(child_, nullptr, WNOHANG) == 0) {
      if (Clock::now() > end) {
        ::kill(child_, SIGKILL);
        ::waitpid(child_, nullptr, 0);
        break;
      }
      std::this_thread::sleep_for(5ms);
    }
  }
  for (const int file : {output_, errors_, lock_})
    if (file >= 0) ::close(file);
}

Result<std::filesystem::path> memory_file_of(const std::filesystem::path& machine) {
  ECS_TRY(folder, state_folder());
  std::error_code error;
  std::filesystem::path real = std::filesystem::canonical(machine, error);
  if (error) real = machine;
  return folder / fmt::format("emulator-{}.memory", sha256_hex(real.string()).substr(0, 16));
}

namespace {

constexpr int kLook_ms = 100;  ///< between two looks at the flag

tl::unexpected<Problem> no_link(std::string message) { return problem(ProblemKind::link, std::move(message)); }

/// An open socket.
class Line {
 public:
  Line() : fd_(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {}
  Line(const Line&) = delete;
  Line& operator=(const Line&) = delete;
  ~Line() {
    if (fd_ >= 0) ::close(fd_);
  }

  [[nodiscard]] bool connect(const std::string& path) const {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    if (path.size() >= sizeof(address.sun_path)) {
      errno = ENAMETOOLONG;
      return false;
    }
    path.copy(static_cast<char*>(address.sun_path), path.size());
    return fd_ >= 0 && ::connect(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
  }

  [[nodiscard]] bool send(std::string_view text) const {
    while (!text.empty()) {
      const ssize_t sent = ::send(fd_, text.data(), text.size(), MSG_NOSIGNAL);
      if (sent < 0 && errno == EINTR) continue;
      if (sent <= 0) return false;
      text.remove_prefix(static_cast<std::size_t>(sent));
    }
    return true;
  }

  /// The next line without its end; nothing where the other side closed it or the flag was set.
  [[nodiscard]] std::optional<std::string> line(const std::atomic<bool>& cancelled) {
    for (;;) {
      if (const std::size_t end = received_.find('\n'); end != std::string::npos) {
        std::string text = received_.substr(0, end);
        received_.erase(0, end + 1);
        return text;
      }
      if (cancelled) return std::nullopt;
      pollfd ready{fd_, POLLIN, 0};
      if (::poll(&ready, 1, kLook_ms) <= 0) continue;
      std::array<char, 65536> piece{};
      const ssize_t got = ::recv(fd_, piece.data(), piece.size(), 0);
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) return std::nullopt;
      received_.append(piece.data(), static_cast<std::size_t>(got));
    }
  }

 private:
  int fd_;
  std::string received_;
};

ProblemKind kind_of(int exit_code) {
  switch (exit_code) {
    case 1:
      return ProblemKind::refused;
    case 2:
      return ProblemKind::usage;
    case 3:
      return ProblemKind::bad_input;
    case 4:
      return ProblemKind::link;
    default:
      return ProblemKind::output;
  }
}

}  // namespace

Result<Json> WorkshopClient::ask(const Json& request, const std::function<void(double)>& progress) const {
  Line line;
  if (!line.connect(socket_.string()))
    return no_link(fmt::format("{}: no workshop listens here ({}); start one with `{}`", socket_.string(),
                               std::strerror(errno),
                               shell_command({"ecs-emulator", "serve", "--workshop", socket_.string()})));
  if (!line.send(one_line(request) + "\n")) return no_link("the workshop closed the connection");
  for (;;) {
    const auto text = line.line(*cancelled_);
    if (!text && *cancelled_) return problem(ProblemKind::refused, "the work was stopped before its end");
    if (!text) return no_link("the workshop closed the connection before it answered");
    const Json answer = Json::parse(*text, nullptr, false);
    if (!answer.is_object()) return no_link("the answer of the workshop is not a JSON object");
    if (answer.contains("progress")) {
      if (progress) progress(answer.value("progress", 0.0));
      continue;
    }
    if (answer.value("ok", false)) return answer;
    const Json error = answer.value("error", Json::object());
    return problem(kind_of(answer.value("exit", 4)), error.value("message", std::string("refused without a reason")));
  }
}

}  // namespace ecs::commissioning
