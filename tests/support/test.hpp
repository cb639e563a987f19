// What every test may use: doctest, cases that cannot run here, and the question whether a text contains another.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include <doctest/doctest.h>

/// Ends the case where something it needs is not there: CTest shows the entry as skipped, with the reason.
#define SKIP_UNLESS(condition, reason)                     \
  do {                                                     \
    if (!(condition)) {                                    \
      ecs::test::note_skipped(__FILE__, __LINE__, reason); \
      return;                                              \
    }                                                      \
  } while (false)

namespace ecs {

inline bool contains(const std::string& text, std::string_view part) { return text.find(part) != std::string::npos; }
inline std::size_t count_of(std::string_view text, char sign) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), sign));
}

namespace test {

/// The running case cannot run here (support/main.cpp).
void note_skipped(const char* file, int line, const std::string& reason);

}  // namespace test
}  // namespace ecs
