// The bundled emulator as a process: started with the words of its command line, found and ended among the children of
// the test.
#pragma once

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace ecs {

/// Of the emulators that tests start; what tests run finds it in its environment.
inline const std::string kArmCode = "271828";
inline const int kArmCodeGiven = ::setenv("ECS_ARM_CODE", "271828", 1);

inline const std::string kEmulator = std::string(ECS_BUILD_FOLDER) + "/ecs_emulator/ecs-emulator";

/// Starts a program; its output goes to the file. @return its process
inline pid_t started(std::vector<std::string> words, const std::string& output = "/dev/null") {
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  posix_spawn_file_actions_t files;
  ::posix_spawn_file_actions_init(&files);
  ::posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, output.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  pid_t child = -1;
  ::posix_spawn(&child, pointers.front(), &files, nullptr, pointers.data(), environ);
  ::posix_spawn_file_actions_destroy(&files);
  return child;
}

inline void end_process(pid_t child, int signal) {
  if (child <= 0) return;
  ::kill(child, signal);
  ::waitpid(child, nullptr, 0);
}

/// The emulators that this process started.
inline std::vector<pid_t> emulator_children() {
  std::vector<pid_t> found;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    std::ifstream children(task.path() / "children");
    for (pid_t child = 0; children >> child;) {
      std::string name;
      std::getline(std::ifstream("/proc/" + std::to_string(child) + "/comm") >> std::ws, name);
      if (name == "ecs-emulator") found.push_back(child);
    }
  }
  return found;
}

/// kill -9. @return how many
inline int kill_emulators() {
  const std::vector<pid_t> all = emulator_children();
  for (const pid_t child : all) ::kill(child, SIGKILL);
  return static_cast<int>(all.size());
}

}  // namespace ecs
