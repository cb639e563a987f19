#include "commissioning/utility/reference.hpp"

#include <chrono>
#include <csignal>
#include <cstring>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/text.hpp"
#include "commissioning/link/choice.hpp"

namespace ecs::commissioning {
namespace {

using namespace std::chrono_literals;

/// What the program said on stderr, without a file name to clean up.
class Said {
 public:
  Said() {
    char name[] = "/tmp/ecs-reference-XXXXXX";
    file_ = ::mkostemp(name, O_CLOEXEC);
    if (file_ >= 0) ::unlink(name);
  }
  Said(const Said&) = delete;
  Said& operator=(const Said&) = delete;
  ~Said() {
    if (file_ >= 0) ::close(file_);
  }
  [[nodiscard]] int number() const { return file_; }
  [[nodiscard]] std::string text() const {
    std::string text(500, '\0');
    const ssize_t length = ::pread(file_, text.data(), text.size(), 0);
    text.resize(length > 0 ? static_cast<std::size_t>(length) : 0);
    return std::string(trimmed(text));
  }

 private:
  int file_ = -1;
};

Result<pid_t> spawned(const std::vector<std::string>& words, const Said& said) {
  std::vector<std::string> copies = words;
  std::vector<char*> pointers;
  for (std::string& word : copies) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  posix_spawn_file_actions_t files;
  ::posix_spawn_file_actions_init(&files);
  ::posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  ::posix_spawn_file_actions_adddup2(&files, said.number(), STDERR_FILENO);
  pid_t child = -1;
  const int fault = ::posix_spawn(&child, pointers.front(), &files, nullptr, pointers.data(), environ);
  ::posix_spawn_file_actions_destroy(&files);
  if (fault != 0)
    return problem(ProblemKind::output, fmt::format("{} cannot be started: {}", words.front(), std::strerror(fault)));
  return child;
}

Result<void> referenced(const std::string& workshop, const std::vector<Axis>& axes, const JobControl& control) {
  const auto program = emulator_program();
  if (!program) return problem(ProblemKind::link, "`ecs-emulator` is not found beside `ecs` nor on PATH");
  std::vector<std::string> words{program->string(), "workshop", workshop, "reference"};
  for (const Axis a : axes) words.insert(words.end(), {"--axes", std::string(1, letter_of(a))});
  const Said said;
  const auto child = spawned(words, said);
  if (!child) return tl::unexpected(child.error());
  int status = 0;
  bool asked_to_end = false;
  while (::waitpid(*child, &status, WNOHANG) == 0) {
    if (control.cancelled && !asked_to_end) ::kill(*child, SIGKILL);
    asked_to_end = control.cancelled;
    std::this_thread::sleep_for(10ms);
  }
  if (control.cancelled || (WIFEXITED(status) && WEXITSTATUS(status) == 0)) return {};
  return problem(ProblemKind::link, fmt::format("the emulated machine was not referenced: {}", said.text()));
}

}  // namespace

void reference_machine(TaskRunner& task, const std::string& workshop, std::vector<Axis> axes, Message& failed) {
  if (task.running()) return;
  const auto work = [workshop, axes = std::move(axes)](JobControl& control) {
    return referenced(workshop, axes, control);
  };
  task.start("referencing", work, [&failed](const Result<void>& done) {
    if (!done) failed.say(done.error());
  });
}

}  // namespace ecs::commissioning
