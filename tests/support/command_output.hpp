// What another program says.
#pragma once

#include <array>
#include <cstdio>
#include <string>

namespace ecs {

struct Output {
  std::string text;
  int status = -1;
};

inline Output output_of(const std::string& command) {
  Output output;
  FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return output;
  std::array<char, 512> part{};
  while (std::fgets(part.data(), part.size(), pipe) != nullptr) output.text += part.data();
  output.status = ::pclose(pipe);
  return output;
}

inline bool installed(const std::string& probe) { return output_of(probe).status == 0; }

}  // namespace ecs
