// A clone that was moved, signals at the end of the work, and output without control characters.
#include "app/cli/program.hpp"

#include <csignal>
#include <sstream>

#include <sys/wait.h>
#include <unistd.h>

#include "app/cli/console.hpp"
#include "base/process.hpp"
#include "tests/support/command_output.hpp"
#include "tests/support/test.hpp"
#include "tests/support/verb_run.hpp"

namespace ecs::app {
namespace {

TEST_CASE("a clone that was moved after it was built finds its own sample machine and emulator") {
  const Folder clone;
  const std::filesystem::path built(ECS_BUILD_FOLDER), build = std::filesystem::path(clone / "build/release");
  std::filesystem::create_directories(build / "app");
  std::filesystem::create_directories(build / "ecs_emulator");
  std::filesystem::create_directories(clone / "samples");
  std::filesystem::copy_file(built / "app/ecs", build / "app/ecs");
  std::filesystem::create_symlink(built / "ecs_emulator/ecs-emulator", build / "ecs_emulator/ecs-emulator");
  std::filesystem::copy("samples/mill", clone / "samples/mill");
  const Output said = output_of((build / "app/ecs").string() + " utility status");
  CHECK(said.status == 0);
  CHECK_MESSAGE(contains(said.text, clone / "samples/mill/machine.toml"), said.text);
}

using cli::Nothing;

/// Exit code of a program whose verb ends well after SIGINT has come.
int exit_code_after_signal(bool finished) {
  const pid_t child = ::fork();
  if (child == 0) {
    catch_signals();
    ::raise(SIGINT);
    const Action done = finished
                            ? action(
                                  "work", "ends its work", "ecs work",
                                  +[](VerbContext&, const Nothing&) -> Result<Outcome> {
                                    return Outcome{"done\n", "{}", kDone, true};
                                  })
                            : action(
                                  "work", "looks on", "ecs work", +[](VerbContext&, const Nothing&) -> Result<Outcome> {
                                    return Outcome{"seen\n", "{}", kDone, false};
                                  });
    std::ostringstream out, messages;
    Registry registry;
    registry.actions = {&done};
    ::_exit(run_command_line(registry, {"work"}, out, messages));
  }
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  REQUIRE(WIFEXITED(status));
  return WEXITSTATUS(status);
}

TEST_CASE(
    "a signal that came when everything was done does not make the exit code, one that cut something short does") {
  CHECK(exit_code_after_signal(true) == 0);
  CHECK(exit_code_after_signal(false) == 128 + SIGINT);
}

TEST_CASE("results, notes, warnings and problems are printed without control characters") {
  std::ostringstream out, messages;
  Console console(out, messages);
  console.answer("name \x1B]0;owned\x07", "");
  console.print("\x1B[31m");
  console.note("\x1B[1m");
  console.warn("\xFF");
  console.show({ProblemKind::link, "\x9B", "file\x1B", 1, 2, {}});
  CHECK((out.str() + messages.str()).find_first_of("\x1B\x07\xFF\x9B") == std::string::npos);
}

TEST_CASE("a line of a message with a name of megabytes in it is cut, and its length is told") {
  std::ostringstream out, messages;
  Console console(out, messages);
  console.show({ProblemKind::refused, "machine " + std::string(3'000'000, 'N') + "\nsecond line", {}, 0, 0, {}});
  CHECK(messages.str().size() < 5'000);
  CHECK(contains(messages.str(), "(cut: 3000008 bytes)\nsecond line\n"));
}

}  // namespace
}  // namespace ecs::app
