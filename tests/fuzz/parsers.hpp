// The parsers of texts and readers of files that are fuzzed; each source of fuzzers, of modules too, adds its own.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string_view>
#include <vector>

#include "base/result.hpp"
#include "tests/fuzz/fuzzed_bytes.hpp"

namespace ecs::fuzz {

inline constexpr const char* kFile = "fuzzed";

inline bool has_words(const Problem& problem, bool of_file) {
  return !problem.message.empty() && problem.line >= 0 && problem.column >= 0 && (!of_file || !problem.file.empty()) &&
         std::all_of(problem.also.begin(), problem.also.end(),
                     [&](const Problem& one) { return has_words(one, of_file); });
}

/// Whether something was read; what was not has its reason in words.
template <class Value>
bool was_read(const Result<Value>& result, bool of_file = true) {
  if (result) return true;
  check(has_words(result.error(), of_file) && !to_text(result.error()).empty());
  return false;
}

inline void check_finite(double value) { check(std::isfinite(value)); }
inline void check_finite(const std::optional<double>& value) { check(!value || std::isfinite(*value)); }
template <class Numbers>
void all_finite(const Numbers& numbers) {
  for (const auto& number : numbers) check_finite(number);
}

/// Each by the name of its function without parse_ (tests/base/fuzzed_parsers_test.cpp).
struct Parser {
  std::string_view id;
  void (*run)(std::string_view text);
};
inline std::vector<Parser>& parsers() {
  static std::vector<Parser> all;
  return all;
}
struct AddedParsers {
  AddedParsers(std::initializer_list<Parser> more) { parsers().insert(parsers().end(), more); }
  AddedParsers(std::string_view id, void (*run)(std::string_view text)) : AddedParsers{Parser{id, run}} {}
};

/// Of files behind one byte that chooses options (import_fuzz.cpp). False: the id is none of its own.
using Reader = bool (*)(std::string_view id, std::uint8_t choice, std::string_view bytes);
inline std::vector<Reader>& readers() {
  static std::vector<Reader> all;
  return all;
}
struct AddedReader {
  explicit AddedReader(Reader more) { readers().push_back(more); }
};

}  // namespace ecs::fuzz
