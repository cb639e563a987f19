// How the tests read files: along X, or by numbered columns.
#pragma once

#include "laser/import/columns.hpp"
#include "laser/import/import.hpp"
#include "tests/support/test.hpp"

namespace ecs::laser {

inline ImportOptions along_x() {
  ImportOptions options;
  options.axis = Axis::X;
  return options;
}

inline ImportOptions by_columns(const std::string& columns, int skip = 0) {
  ImportOptions options;
  auto mapping = must(column_mapping(columns));
  options.mapping = mapping;
  options.mapping->skip_lines = skip;
  return options;
}

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  REQUIRE(contains(text, from));
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

}  // namespace ecs::laser
