// Reading of TOML tables that collects every problem with its place. Include it in .cpp files only: it is heavy.
// Does not live here: which keys a file has (the readers of each library).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <toml++/toml.h>

#include "base/result.hpp"

namespace ecs {

/// The whole text as a table, or the place where it stops being TOML. Deeper nesting than any of our files has is
/// refused before the library meets it: it takes one call, and the program's stack, for every part of a dotted key.
[[nodiscard]] Result<toml::table> parse_toml(std::string_view text, const std::string& file);

/// One TOML file being read; problems are collected and reported together.
class TomlReader {
 public:
  explicit TomlReader(std::string file) : file_(std::move(file)) {}

  [[nodiscard]] Result<toml::table> parsed(std::string_view text) const { return parse_toml(text, file_); }

  void complain(const toml::node& at, std::string message);
  void complain(int line, std::string message);
  /// The same with a format string and its arguments (fmt). @param at  a node or a line
  template <class Place, class First, class... Rest>
  void complain(const Place& at, fmt::format_string<First, Rest...> form, First&& first, Rest&&... rest) {
    complain(at, fmt::format(form, std::forward<First>(first), std::forward<Rest>(rest)...));
  }
  /// Adds a problem found in another file.
  void add(Problem problem) { problems_.push_back(std::move(problem)); }

  /// Complains about every key of `table` that is none of `known`.
  void only(const toml::table& table, const std::vector<std::string>& known, std::string_view what);

  /// The value under `key`; nothing where it is absent (complains where it has another type).
  [[nodiscard]] std::optional<double> number(const toml::table& table, std::string_view key);
  [[nodiscard]] std::optional<std::string> word(const toml::table& table, std::string_view key);
  [[nodiscard]] const toml::table* child(const toml::table& table, std::string_view key);
  /// The tables of `[[key]]`, in file order; none where the key is absent.
  [[nodiscard]] std::vector<const toml::table*> children(const toml::table& table, std::string_view key);

  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] bool clean() const { return problems_.empty(); }
  /// @pre !clean()
  [[nodiscard]] Problem all() { return folded(std::move(problems_)); }

 private:
  std::string file_;
  std::vector<Problem> problems_;
};

}  // namespace ecs
