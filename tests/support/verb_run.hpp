// Runs a command line of `ecs` inside a test, and keeps what it says.
#pragma once

#include <filesystem>
#include <sstream>

#include <nlohmann/json.hpp>

#include "app/verbs/registry.hpp"
#include "tests/support/folder.hpp"
#include "tests/support/test.hpp"

namespace ecs::app {

struct Ran {
  int code = 0;
  std::string out;
  std::string messages;
  [[nodiscard]] nlohmann::json json() const { return nlohmann::json::parse(out); }
  [[nodiscard]] std::string all() const { return out + messages; }
};

inline Ran ran(const std::vector<std::string>& words) {
  std::ostringstream out, messages;
  const int code = run_program(words, out, messages);
  return {code, out.str(), messages.str()};
}

}  // namespace ecs::app
