// Files of a test, in a folder of their own.
#pragma once

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <unistd.h>

#include "base/file.hpp"

namespace ecs {

/// A folder of its own that goes away with the test.
class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "ecs-test-XXXXXX").string();
    path = ::mkdtemp(name.data());
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() { disc::remove_all(path); }
  [[nodiscard]] std::string operator/(const std::string& name) const { return (path / name).string(); }
  /// Writes a file, and the folders above it. @return its path
  std::string with(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((path / name).parent_path());
    std::ofstream(path / name) << text;
    return *this / name;
  }
  std::filesystem::path path;
};

inline std::string content_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// A folder that also holds the state and the configuration of `ecs`.
struct StateFolder : Folder {
  StateFolder() {
    ::setenv("ECS_STATE_DIR", (path / "state").c_str(), 1);
    ::setenv("XDG_CONFIG_HOME", (path / "config").c_str(), 1);
  }
  ~StateFolder() {
    ::unsetenv("ECS_STATE_DIR");
    ::unsetenv("XDG_CONFIG_HOME");
  }
};

}  // namespace ecs
