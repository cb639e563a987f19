// What every test may use: doctest, cases that cannot run here, what a call must give, and what a text or a list must
// hold.
#pragma once

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include "base/result.hpp"

/// Ends the case where something it needs is not there: CTest shows the entry as skipped, with the reason.
#define SKIP_UNLESS(condition, reason)                     \
  do {                                                     \
    if (!(condition)) {                                    \
      ecs::test::note_skipped(__FILE__, __LINE__, reason); \
      return;                                              \
    }                                                      \
  } while (false)

namespace ecs {

using doctest::Approx;

inline bool contains(std::string_view text, std::string_view part) { return text.find(part) != std::string_view::npos; }
inline bool contains(std::string_view text, char sign) { return text.find(sign) != std::string_view::npos; }
inline std::size_t count_of(std::string_view text, char sign) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), sign));
}

// The last two parameters are the place of the call, which a failure names; clang 14 has no std::source_location.

/// What a Result or an optional holds; where it holds nothing the case ends, with the words of the problem.
template <class Given>
typename Given::value_type must(Given given, std::string_view file = __builtin_FILE(), int line = __builtin_LINE()) {
  INFO(file, ":", line);
  if constexpr (requires { to_text(given.error()); }) {
    REQUIRE_MESSAGE(given.has_value(), (given ? std::string() : to_text(given.error())));
  } else {
    REQUIRE(given.has_value());
  }
  if constexpr (!std::is_void_v<typename Given::value_type>) return *std::move(given);
}
/// The problem of a Result that must be one.
template <class Given>
typename Given::error_type must_fail(const Given& given, std::string_view file = __builtin_FILE(),
                                     int line = __builtin_LINE()) {
  INFO(file, ":", line);
  REQUIRE_FALSE(given.has_value());
  return given.error();
}
/// What a list holds that must hold one thing.
template <class List>
const typename List::value_type& only(const List& list, std::string_view file = __builtin_FILE(),
                                      int line = __builtin_LINE()) {
  INFO(file, ":", line);
  REQUIRE(list.size() == 1);
  return list.front();
}

/// Each of the parts stands in the text.
inline void check_holds(std::string_view text, std::initializer_list<std::string_view> parts,
                        std::string_view file = __builtin_FILE(), int line = __builtin_LINE()) {
  INFO(file, ":", line);
  for (const std::string_view part : parts) CHECK_MESSAGE(contains(text, part), part, " in ", text);
}

namespace test {

/// The running case cannot run here (tests/support/main.cpp).
void note_skipped(const char* file, int line, const std::string& reason);

}  // namespace test
}  // namespace ecs
