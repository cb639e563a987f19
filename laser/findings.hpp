// Collects what is wrong with a file so that every bad line is reported at once.
// Does not live here: what a reader expects (each reader knows its own format).
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/result.hpp"

namespace ecs::laser {

/// The faults of one file, in the order found. The first `kMostShown` are kept word for word, the rest are counted.
class Findings {
 public:
  static constexpr std::size_t kMostShown = 20;

  explicit Findings(std::string file) : file_(std::move(file)) {}

  /// @param line, column  1-based; 0 = the fault has no such place
  void add(int line, int column, std::string message);
  /// The same with a format string and its arguments (fmt).
  template <class First, class... Rest>
  void add(int line, int column, fmt::format_string<First, Rest...> form, First&& first, Rest&&... rest) {
    add(line, column, fmt::format(form, std::forward<First>(first), std::forward<Rest>(rest)...));
  }

  [[nodiscard]] bool empty() const { return count_ == 0; }
  [[nodiscard]] std::size_t count() const { return count_; }

  /// One problem that holds them all; a last entry says how many more there are.
  /// @pre !empty()
  [[nodiscard]] Problem as_problem() const;

 private:
  std::string file_;
  std::vector<Problem> shown_;
  std::size_t count_ = 0;
};

/// `"text"`, or `nothing` for an empty text; long texts are cut and control characters replaced, so that a message
/// stays one line.
[[nodiscard]] std::string in_quotes(std::string_view text);

/// Column, from 1, at which `word` begins; 0 where it is no part of the line.
[[nodiscard]] inline int column_of(std::string_view line, std::string_view word) {
  const bool inside =
      !std::less<>()(word.data(), line.data()) && !std::less<>()(line.data() + line.size(), word.data());
  return inside ? static_cast<int>(word.data() - line.data()) + 1 : 0;
}

}  // namespace ecs::laser
