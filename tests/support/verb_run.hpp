// Runs a command line of `ecs` inside a test, and keeps what it says.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <unistd.h>

#include "app/cli/program.hpp"

namespace ecs::app {

struct Ran {
  int code = 0;
  std::string out;
  std::string messages;
  [[nodiscard]] nlohmann::json json() const { return nlohmann::json::parse(out); }
};

inline Ran ran(const std::vector<std::string>& words) {
  std::ostringstream out, messages;
  const int code = run_program(words, out, messages);
  return {code, out.str(), messages.str()};
}

/// A folder of its own that goes away with the test.
class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "ecs-test-XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() {
    std::error_code error;
    std::filesystem::remove_all(path_, error);
  }
  [[nodiscard]] std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  [[nodiscard]] std::string with(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((path_ / name).parent_path());
    std::ofstream(path_ / name) << text;
    return *this / name;
  }

 private:
  std::filesystem::path path_;
};

inline std::string content_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// A file of ../shared/data, or of $ECS_SHARED_DATA; empty if it is not there.
inline std::string shared_data(const std::string& name) {
  const char* given = std::getenv("ECS_SHARED_DATA");
  const std::filesystem::path file = std::filesystem::path(given != nullptr ? given : "../shared/data") / name;
  return std::filesystem::exists(file) ? file.string() : std::string();
}

}  // namespace ecs::app
