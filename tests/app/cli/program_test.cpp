// A clone that was moved, and signals at the end of the work.
#include "app/cli/program.hpp"

#include <csignal>

#include <sys/wait.h>
#include <unistd.h>

#include "base/process.hpp"
#include "tests/support/command_output.hpp"
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

}  // namespace
}  // namespace ecs::app
