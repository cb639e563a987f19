// How the tests read files: along X, or by numbered columns.
#pragma once

#include <string>

#include <doctest/doctest.h>

#include "laser/import/columns.hpp"
#include "laser/import/import.hpp"

namespace ecs::laser {

inline ImportOptions along_x() {
  ImportOptions options;
  options.axis = Axis::X;
  return options;
}

inline ImportOptions by_columns(const std::string& columns, int skip = 0) {
  ImportOptions options;
  auto mapping = column_mapping(columns);
  REQUIRE_MESSAGE(mapping.has_value(), (mapping ? "" : to_text(mapping.error())));
  options.mapping = *mapping;
  options.mapping->skip_lines = skip;
  return options;
}

}  // namespace ecs::laser
