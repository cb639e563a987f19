// Every file below a folder is read, or refused with a reason a person understands.
#pragma once

#include <filesystem>

#include "laser/import/import.hpp"
#include "tests/laser/support/import_options.hpp"
#include "tests/support/test.hpp"

namespace ecs::laser {

/// What is to become of a file: read with this many readings (or records), or refused with these words.
struct Expected {
  const char* file;  ///< below the folder; a folder stands for all files in it not named on their own
  std::string_view format;
  std::size_t count = 0;  ///< 0: not counted
  const char* words = "";
};

inline const Expected* expected_of(const std::vector<Expected>& corpus, const std::string& name) {
  const Expected* folder = nullptr;
  for (const Expected& expected : corpus) {
    if (name == expected.file) return &expected;
    if (name.starts_with(std::string(expected.file) + "/")) folder = &expected;
  }
  return folder;
}

/// @return how many were read and how many refused
inline std::pair<int, int> check_corpus(const std::filesystem::path& root, const std::vector<Expected>& corpus) {
  int read = 0, refused = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) {
    if (!entry.is_regular_file() || entry.path().filename() == "SOURCE.md" || entry.path().filename() == "README.md")
      continue;
    const std::string name = std::filesystem::relative(entry.path(), root).generic_string();
    if (name.starts_with("made-up/")) continue;  // no real files
    CAPTURE(name);
    const Expected* const expected = expected_of(corpus, name);
    REQUIRE(expected != nullptr);
    const auto imported = read_any(entry.path(), along_x());
    if (!expected->format.empty()) {
      REQUIRE_MESSAGE(imported.has_value(), to_text(imported.error()));
      CHECK(imported->format->id == expected->format);
      const std::size_t count =
          imported->environment.rows.empty() ? imported->set.readings.size() : imported->environment.rows.size();
      CHECK(count > 0);
      if (expected->count > 0) CHECK(count == expected->count);
      ++read;
    } else {
      REQUIRE_FALSE(imported.has_value());
      CHECK_MESSAGE(contains(imported.error().message, expected->words), to_text(imported.error()));
      CHECK(imported.error().file == entry.path().string());
      ++refused;
    }
  }
  return {read, refused};
}

}  // namespace ecs::laser
